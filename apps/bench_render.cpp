// SPDX-License-Identifier: MIT
#include "apps/bench_render.h"

#include "nlos/compare.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/render.h"
#include "renderer/scene_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

constexpr int kReferenceSamples = 16384;  ///< of each of its two halves
constexpr std::uint64_t kReferenceSeed = 1'000'000;

// A scene that can be rendered again and again with other settings.
class Workbench {
 public:
    explicit Workbench(const std::string& scene_path)
        : description_(renderer::read_scene_description(scene_path, {})),
          scan_(renderer::make_scan(description_)),
          scene_(renderer::load_scene(description_, scan_)) {}

    const renderer::RenderSettings& settings() const { return description_.render; }

    core::Capture render(const renderer::RenderSettings& settings) const {
        return renderer::render(scene_, scan_, description_.time_axis, settings, {}).capture;
    }

 private:
    renderer::SceneDescription description_;
    core::Scan scan_;
    renderer::Scene scene_;
};

double relative_l2(const core::Capture& a, const core::Capture& b) {
    return nlos::compare_captures(a, b).rel_l2.value_or(0.0);
}

// Two independent halves; their mean is the reference, half their distance its error.
core::Capture make_reference(const Workbench& bench, double& error) {
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::Path;
    settings.samples = kReferenceSamples;
    settings.seed = kReferenceSeed;
    core::Capture reference = bench.render(settings);
    ++settings.seed;
    const core::Capture other = bench.render(settings);
    error = 0.5 * relative_l2(reference, other);
    const auto sums = reference.transient.values();
    std::transform(sums.begin(),
                   sums.end(),
                   other.transient.values().begin(),
                   sums.begin(),
                   [](float a, float b) { return 0.5F * (a + b); });
    return reference;
}

BenchPoint measure(const Workbench& bench,
                   renderer::RenderSettings settings,
                   const core::Capture& reference,
                   int repeats) {
    BenchPoint point;
    std::vector<double> seconds;
    double squared = 0.0;
    for (int i = 0; i < repeats; ++i) {
        settings.seed = static_cast<std::uint64_t>(i);
        const double start = core::cpu_seconds();
        const core::Capture capture = bench.render(settings);
        seconds.push_back(core::cpu_seconds() - start);
        squared += std::pow(relative_l2(capture, reference), 2) / repeats;
    }
    std::sort(seconds.begin(), seconds.end());
    point.cpu_seconds = seconds[seconds.size() / 2];
    point.cpu_spread = seconds.back() - seconds.front();
    point.rel_l2 = std::sqrt(squared);
    return point;
}

// Least squares line through the logarithms.
void fit_line(BenchCurve& curve) {
    const double n = static_cast<double>(curve.points.size());
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (const BenchPoint& point : curve.points) {
        const double log_time = std::log(point.cpu_seconds);
        const double log_error = std::log(std::max(1e-12, point.rel_l2));
        x += log_time / n;
        y += log_error / n;
        xx += log_time * log_time / n;
        xy += log_time * log_error / n;
    }
    curve.slope = (xy - x * y) / (xx - x * x);
    curve.coefficient = std::exp(y - curve.slope * x);
}

BenchCurve path_curve(const Workbench& bench,
                      const core::Capture& reference,
                      int repeats,
                      const core::Progress& progress) {
    BenchCurve curve;
    curve.method = "path";
    const std::vector<int> efforts{128, 512, 2048, 8192};
    for (std::size_t i = 0; i < efforts.size(); ++i) {
        if (progress.should_stop()) throw core::Failure("bench", "interrupted");
        progress.update(double(i) / double(efforts.size()), "path");
        renderer::RenderSettings settings = bench.settings();
        settings.method = renderer::Estimator::Path;
        settings.samples = efforts[i];
        curve.points.push_back(measure(bench, settings, reference, repeats));
        curve.points.back().effort = fmt::format("samples={}", efforts[i]);
    }
    fit_line(curve);
    return curve;
}

}  // namespace

RenderBench bench_render(const std::string& scene_path,
                         int repeats,
                         const core::Progress& progress) {
    const Workbench bench(scene_path);
    RenderBench result;
    result.scene = scene_path;
    result.repeats = repeats;
    result.reference =
        fmt::format("path, mean of two runs of {} samples per pair", kReferenceSamples);
    const core::Capture reference = make_reference(bench, result.reference_error);
    const core::ThreadLimit one_thread(1);
    result.curves.push_back(path_curve(bench, reference, repeats, progress));
    return result;
}

}  // namespace apps
