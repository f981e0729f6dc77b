// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/reconstruct_trials.h"

#include "apps/bench/scene.h"
#include "apps/shapes/shapes.h"
#include "nlos/detector/detector.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/process.h"

#include <cmath>
#include <cstdint>

namespace apps {
namespace {

using core::Vec3;

constexpr int kPointsPerAxis = 32;
constexpr core::TimeAxis kAxis{0.0, 0.008, 256};
constexpr double kBackgroundFraction = 0.02;  // of the brightest bin

renderer::SceneGeometry random_surface(int number) {
    core::Rng rng(0, static_cast<std::uint64_t>(number), 0);
    const auto between = [&](double low, double high) {
        return low + (high - low) * rng.uniform();
    };
    const double half_width = between(0.12, 0.35);
    const double half_height = between(0.12, 0.35);
    const Vec3 center(between(half_width - 0.45, 0.45 - half_width),
                      between(half_height - 0.45, 0.45 - half_height),
                      between(0.5, 0.9));
    const double steepest = std::tan(core::kPi * 25.0 / 180.0);
    const double slope = steepest * rng.uniform();
    const double direction = 2.0 * core::kPi * rng.uniform();
    const bool is_flat = number % 2 == 0;
    const double bend = is_flat ? 0.0 : between(-0.2, 0.2) * half_width;
    const double waves = between(0.5, 1.0) * core::kPi;
    renderer::SceneGeometry geometry;
    renderer::Object& object = geometry.objects.emplace_back();
    object.material.albedo = 0.8;
    object.mesh = make_grid_mesh(is_flat ? 1 : 12, [&](double u, double v) {
        const double x = half_width * u;
        const double y = half_height * v;
        const double tilt = slope * (std::cos(direction) * x + std::sin(direction) * y);
        const double wave = bend * std::cos(waves * u) * std::cos(waves * v);
        return Vec3(center + Vec3(x, y, tilt + wave));
    });
    return geometry;
}

}  // namespace

RandomCapture make_random_capture(int number) {
    renderer::SceneDescription description;
    description.scan.sensing_points = {kPointsPerAxis, kPointsPerAxis};
    const core::Scan scan = renderer::make_scan(description);
    renderer::Scene scene(random_surface(number), scan, renderer::RelayWall{});
    core::Capture capture = renderer::render(scene, scan, kAxis, {}, {}).capture;
    return {std::move(scene), std::move(capture)};
}

core::Capture random_counts(const core::Capture& clean, double peak_counts, int seed) {
    nlos::DetectorSettings settings;
    settings.photons = photons_for_peak(clean, peak_counts);
    settings.ambient = kBackgroundFraction * peak_counts;
    settings.seed = static_cast<std::uint64_t>(seed);
    return nlos::detect(clean, settings);
}

void judge(bool is_asked, const std::string& text, bool is_met, core::Json& row) {
    if (!is_asked) return;
    const std::string before = row["target"];
    row["target"] = before + (before.empty() ? "" : ", ") + text;
    row["met"] = is_met && row["met"] != "no" ? "yes" : "no";
}

ReconstructRun run_reconstruction(const core::Capture& capture, const Overrides& overrides) {
    nlos::ReconstructSettings settings;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    core::reset_peak_rss();
    const auto before = static_cast<double>(core::peak_rss_bytes());
    const double start = core::cpu_seconds();
    ReconstructRun run{nlos::reconstruct(capture, settings, {}), 0.0, 0.0, 0.0};
    run.cpu_seconds = core::cpu_seconds() - start;
    run.peak_bytes = static_cast<double>(core::peak_rss_bytes());
    run.bytes = run.peak_bytes - before;
    return run;
}

}  // namespace apps
