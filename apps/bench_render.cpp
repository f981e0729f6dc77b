// SPDX-License-Identifier: MIT
#include "apps/bench_render.h"

#include "apps/bench_scene.h"
#include "apps/power_law.h"
#include "nlos/compare.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

constexpr double kReferenceTarget = 0.002;
constexpr int kCheckSamples = 32768;  ///< of each of two halves
constexpr std::uint64_t kCheckSeed = 1'000'000;
constexpr int kFewestGateRuns = 3;  ///< for a standard deviation

// One setting of an estimator's effort.
struct Effort {
    std::string name;
    renderer::RenderSettings settings;
};

double relative_l2(const core::Capture& a, const core::Capture& b) {
    return nlos::compare_captures(a, b).rel_l2.value_or(0.0);
}

// The integrator far below every error to be measured. Path tracing shares no code with it beyond
// the rays; how far a long run of it lies from the reference bounds the reference's own error,
// together with that run's own noise (half the distance of its two independent halves).
core::Capture make_reference(const BenchScene& bench, RenderBench& result) {
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = kReferenceTarget;
    const core::Capture reference = bench.render(settings);

    settings.method = renderer::Estimator::Path;
    settings.samples = kCheckSamples;
    settings.seed = kCheckSeed;
    core::Capture check = bench.render(settings);
    ++settings.seed;
    const core::Capture other = bench.render(settings);
    result.check_noise = 0.5 * relative_l2(check, other);
    const auto sums = check.transient.values();
    std::transform(sums.begin(),
                   sums.end(),
                   other.transient.values().begin(),
                   sums.begin(),
                   [](float a, float b) { return 0.5F * (a + b); });
    result.check_distance = relative_l2(check, reference);
    result.reference = fmt::format("third_bounce to {}", kReferenceTarget);
    return reference;
}

BenchPoint measure(const BenchScene& bench,
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

void fit_line(BenchCurve& curve) {
    std::vector<double> seconds;
    std::vector<double> errors;
    for (const BenchPoint& point : curve.points) {
        seconds.push_back(point.cpu_seconds);
        errors.push_back(std::max(1e-12, point.rel_l2));
    }
    const PowerLaw law = fit_power_law(seconds, errors);
    curve.slope = law.exponent;
    curve.coefficient = law.coefficient;
}

// Runs one estimator at rising effort.
BenchCurve measure_curve(const BenchScene& bench,
                         const std::string& method,
                         const std::vector<Effort>& efforts,
                         const core::Capture& reference,
                         int repeats,
                         const core::Progress& progress) {
    BenchCurve curve;
    curve.method = method;
    for (std::size_t i = 0; i < efforts.size(); ++i) {
        if (progress.should_stop()) throw core::Failure("bench", "interrupted");
        progress.update(double(i) / double(efforts.size()), method);
        curve.points.push_back(measure(bench, efforts[i].settings, reference, repeats));
        curve.points.back().effort = efforts[i].name;
    }
    fit_line(curve);
    return curve;
}

std::vector<Effort> path_efforts(renderer::RenderSettings settings) {
    settings.method = renderer::Estimator::Path;
    std::vector<Effort> efforts;
    for (const int samples : {512, 4096, 32768, 131072}) {
        settings.samples = samples;
        efforts.push_back({fmt::format("samples={}", samples), settings});
    }
    return efforts;
}

std::vector<Effort> third_bounce_efforts(renderer::RenderSettings settings) {
    settings.method = renderer::Estimator::ThirdBounce;
    std::vector<Effort> efforts;
    for (const double target : {0.2, 0.1, 0.05, 0.02, 0.01}) {
        settings.target_error = target;
        efforts.push_back({fmt::format("target_error={}", target), settings});
    }
    return efforts;
}

std::vector<EqualError> equal_errors(const BenchCurve& third_bounce, const BenchCurve& path) {
    std::vector<EqualError> result;
    for (const double error : {0.05, 0.02, 0.01}) {
        EqualError equal{error, std::pow(error / path.coefficient, 1.0 / path.slope), 0.0, 0.0};
        for (const BenchPoint& point : third_bounce.points) {
            const bool cheaper =
                equal.third_bounce_seconds == 0.0 || point.cpu_seconds < equal.third_bounce_seconds;
            if (point.rel_l2 <= error && cheaper) equal.third_bounce_seconds = point.cpu_seconds;
        }
        if (equal.third_bounce_seconds == 0.0) continue;
        equal.ratio = equal.path_seconds / equal.third_bounce_seconds;
        result.push_back(equal);
    }
    return result;
}

void measure_curves(const RenderBenchSettings& settings,
                    const core::Progress& progress,
                    RenderBench& result) {
    const BenchScene bench(settings.scene);
    const core::Capture reference = make_reference(bench, result);
    const core::ThreadLimit one_thread(1);
    for (const auto& [method, efforts] :
         {std::pair{"third_bounce", third_bounce_efforts(bench.settings())},
          std::pair{"path", path_efforts(bench.settings())}}) {
        result.curves.push_back(
            measure_curve(bench, method, efforts, reference, settings.repeats, progress));
    }
    result.equal_error = equal_errors(result.curves[0], result.curves[1]);
}

}  // namespace

RenderBench bench_render(const RenderBenchSettings& settings, const core::Progress& progress) {
    RenderBench result;
    result.scene = settings.scene;
    result.repeats = settings.repeats;
    const int gate_runs = std::max(kFewestGateRuns, settings.repeats);
    if (settings.has("curves")) measure_curves(settings, progress, result);
    if (settings.has("gates")) {
        for (const std::string& path : {settings.scene, settings.camera_scene}) {
            result.gates.push_back(bench_gates(path, gate_runs, progress));
        }
    }
    if (settings.has("exclusion")) {
        for (const std::string& path : {settings.scene, settings.exclusion_scene}) {
            const auto part = bench_exclusion(path, gate_runs);
            result.exclusion.insert(result.exclusion.end(), part.begin(), part.end());
        }
    }
    if (settings.has("growth")) result.growth = bench_render_growth(progress);
    return result;
}

}  // namespace apps
