// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "apps/scene_truth.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "renderer/render.h"

#include <fmt/format.h>

#include <cmath>

namespace apps {
namespace {

constexpr int kWallSide = 64;    // wall points along an axis
constexpr int kSpotMargin = 16;  // points around them whose light a spot brings in
constexpr double kWallPitch = 0.9 / kWallSide;
constexpr core::TimeAxis kRangeAxis{0.0, 0.0096, 256};
constexpr core::BinRange kRangeGate{100, 220};
constexpr double kFwhm_ps = 794.0;
constexpr double kAmbientCounts = 0.05;  // counts per bin

renderer::SceneGeometry letter() {
    const auto stroke = [](double left, double right, double bottom, double top) {
        renderer::Object object;
        for (const double y : {bottom, top}) {
            for (const double x : {left, right}) object.mesh.vertices.emplace_back(x, y, 0.6);
        }
        object.mesh.triangles = {{0, 2, 1}, {1, 2, 3}};
        return object;
    };
    renderer::SceneGeometry geometry;
    geometry.objects = {stroke(-0.14, -0.10, -0.14, 0.14),
                        stroke(0.10, 0.14, -0.14, 0.14),
                        stroke(-0.10, 0.10, -0.02, 0.02)};
    return geometry;
}

renderer::SceneDescription wall_of(int side) {
    renderer::SceneDescription description;
    description.relay_wall.size_m = {side * kWallPitch, side * kWallPitch};
    description.scan.pattern = core::ScanPattern::Confocal;
    description.scan.sensing_points = {side, side};
    return description;
}

core::Capture render_letter(int side) {
    const renderer::SceneDescription description = wall_of(side);
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene = renderer::make_scene(letter(), description, scan);
    return renderer::render(scene, scan, kRangeAxis, {}, {}).capture;
}

/// Histograms of the inner points, each the mean over a normal spot around it.
core::Capture with_spot(const core::Capture& all, double fwhm_m) {
    core::Capture capture = all;
    capture.scan = renderer::make_scan(wall_of(kWallSide));
    capture.transient = core::Transient(capture.scan.num_pairs(), kRangeAxis.num_bins);
    const double sigma = fwhm_m / std::sqrt(8.0 * std::log(2.0)) / kWallPitch;
    std::vector<float> weights;
    float sum = 0.0F;
    for (int i = -kSpotMargin; i <= kSpotMargin; ++i) {
        weights.push_back(
            static_cast<float>(i == 0 ? 1.0 : std::exp(-0.5 * std::pow(i / sigma, 2))));
        sum += weights.back();
    }
    for (float& weight : weights) weight /= sum;
    core::parallel_for(capture.scan.num_pairs(), [&](std::size_t pair) {
        const auto to = capture.transient.histogram(pair);
        for (std::size_t i = 0; i < weights.size(); ++i) {
            for (std::size_t j = 0; j < weights.size(); ++j) {
                const float weight = weights[i] * weights[j];
                if (weight < 1e-7F) continue;
                const auto from = all.transient.histogram(
                    (pair / kWallSide + i) * (kWallSide + 2 * kSpotMargin) + pair % kWallSide + j);
                for (std::size_t bin = 0; bin < to.size(); ++bin) to[bin] += weight * from[bin];
            }
        }
    });
    return capture;
}

core::Capture detected(const core::Capture& clean, double photons) {
    nlos::DetectorSettings detector;
    detector.photons_per_point = photons;
    detector.response.jitter_fwhm_ps = kFwhm_ps;
    detector.ambient = kAmbientCounts;
    core::Capture capture = nlos::detect(clean, detector);
    core::restrict_observed(capture,
                            std::vector<core::BinRange>(capture.scan.num_pairs(), kRangeGate));
    return capture;
}

core::Json score_of(const core::Capture& capture,
                    double photons,
                    double spot_m,
                    const std::string& method) {
    const nlos::Reconstruction result =
        run_reconstruction(capture,
                           {"method=" + method,
                            fmt::format("response.jitter_fwhm_ps={}", kFwhm_ps),
                            fmt::format("solver.spot_m={}", spot_m)})
            .result;
    const SceneTruth truth(wall_of(kWallSide), letter());
    const nlos::Metrics metrics = nlos::compare_to_truth(result, truth.surface(result.volume.axes));
    return {{"photons_per_point", photons},
            {"spot_m", spot_m},  // full width at half maximum on the wall
            {"method", method},
            // Overlap of the columns that were given a depth, and at the best threshold.
            {"mask_iou_stated", metrics.mask_iou_stated.value_or(0.0)},
            {"mask_iou_best", metrics.mask_iou_best.value_or(0.0)},
            {"depth_mae_m", core::write_value(metrics.depth_mae_m)},
            {"seconds", result.seconds}};
}

void declare_long_range_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_long_range);
    add_setting(command, "--photons", settings.photons, "Photons per wall point");
    add_setting(command, "--spots", settings.spots_m, "Widths of the spot on the wall [m]");
    add_setting(command, "--methods", settings.methods, "Reconstruction methods");
}

}  // namespace

BenchResult measure_long_range(const LongRangeBenchSettings& settings,
                               const core::Progress& progress) {
    core::Json scores = core::Json::array();
    const core::Capture all = render_letter(kWallSide + 2 * kSpotMargin);
    const std::size_t count =
        settings.spots_m.size() * settings.photons.size() * settings.methods.size();
    for (const double spot_m : settings.spots_m) {
        const core::Capture clean = with_spot(all, spot_m);
        for (const double photons : settings.photons) {
            const core::Capture capture = detected(clean, photons);
            for (const std::string& method : settings.methods) {
                progress.update(fraction_of(scores.size(), count), method);
                scores.push_back(score_of(capture, photons, spot_m, method));
            }
        }
    }
    return {{{"scores", scores}}};
}

extern const CommandRow kLongRangeBench{
    "long_range",
    "A letter under a spot and a response wider than its strokes, as from a kilometre away",
    "nlos bench long_range -o out/bench --photons 5000 --spots 0.08",
    declare_long_range_bench};

}  // namespace apps
