// SPDX-License-Identifier: MIT
#include "apps/bench/render/render.h"

#include "apps/bench/lower_bounds.h"
#include "apps/bench/scene.h"
#include "apps/bench/statistics.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace apps {
namespace {

constexpr double kReferenceTarget = 0.002;
constexpr int kCheckSamples = 32768;  ///< of each of two halves
constexpr int kQuickCheckSamples = 4096;
constexpr std::uint64_t kCheckSeed = 1'000'000;
constexpr double kLongRun_s = 5.0;  ///< runs longer than this are not repeated

// One setting of an estimator's effort.
struct Effort {
    std::string name;
    renderer::RenderSettings settings;
};

// The integrator far below every error to be measured. Path tracing shares no code with it beyond
// the rays; how far a long run of it lies from the reference bounds the reference's own error,
// together with that run's own noise (half the distance of its two independent halves).
core::Capture make_reference(const BenchScene& bench, bool quick, core::Json& figures) {
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = kReferenceTarget;
    const core::Capture reference = bench.render(settings);

    settings.method = renderer::Estimator::Path;
    settings.target_error.reset();
    settings.samples = quick ? kQuickCheckSamples : kCheckSamples;
    settings.seed = kCheckSeed;
    core::Capture check = bench.render(settings);
    ++settings.seed;
    const core::Capture other = bench.render(settings);
    figures["check_noise"] = 0.5 * relative_l2(check, other);  // of a long run of path
    const auto sums = check.transient.values();
    std::transform(sums.begin(),
                   sums.end(),
                   other.transient.values().begin(),
                   sums.begin(),
                   [](float a, float b) { return 0.5F * (a + b); });
    figures["check_distance"] = relative_l2(check, reference);  // of that run
    figures["reference"] = fmt::format("third_bounce to {}", kReferenceTarget);
    return reference;
}

BenchPoint measure(const BenchScene& bench,
                   renderer::RenderSettings settings,
                   const core::Capture& reference,
                   int repeats) {
    std::vector<double> seconds;
    std::vector<double> errors;
    for (int i = 0; i < repeats && (i == 0 || seconds.back() < kLongRun_s); ++i) {
        settings.seed = static_cast<std::uint64_t>(i);
        const double start = core::cpu_seconds();
        const core::Capture capture = bench.render(settings);
        seconds.push_back(core::cpu_seconds() - start);
        errors.push_back(relative_l2(capture, reference));
    }
    std::sort(seconds.begin(), seconds.end());
    BenchPoint point;
    point.runs = static_cast<int>(seconds.size());
    point.cpu_seconds = seconds[seconds.size() / 2];
    point.cpu_spread = seconds.back() - seconds.front();
    const double squared = std::inner_product(errors.begin(), errors.end(), errors.begin(), 0.0);
    point.rel_l2 = std::sqrt(squared / static_cast<double>(errors.size()));
    const auto [least, largest] = std::minmax_element(errors.begin(), errors.end());
    point.rel_l2_spread = *largest - *least;
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
        progress.update(fraction_of(i, efforts.size()), method);
        curve.points.push_back(measure(bench, efforts[i].settings, reference, repeats));
        curve.points.back().effort = efforts[i].name;
        if (!renderer::traits_of(efforts[i].settings.method).is_deterministic) {
            curve.points.back().samples = efforts[i].settings.samples;
        }
    }
    fit_line(curve);
    return curve;
}

// Estimators that take samples, and how many.
std::vector<Effort> sampled_efforts(renderer::RenderSettings settings,
                                    renderer::Estimator method,
                                    const std::vector<int>& all_samples) {
    settings.method = method;
    std::vector<Effort> efforts;
    for (const int samples : all_samples) {
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

// The time a method takes to an error: that of the cheapest run below it when the method is
// deterministic. Others go on from their most accurate run with the inverse root of time: their few
// runs begin before that law holds.
double seconds_to(const BenchCurve& curve, double error) {
    const BenchPoint& last = curve.points.back();
    if (last.samples > 0) {
        return last.cpu_seconds * std::pow(last.rel_l2 / error, 2);
    }
    double seconds = 0.0;
    for (const BenchPoint& point : curve.points) {
        const bool cheaper = seconds == 0.0 || point.cpu_seconds < seconds;
        if (point.rel_l2 <= error && cheaper) seconds = point.cpu_seconds;
    }
    return seconds;
}

// Every estimator against `path`, which is continued along its fitted line.
core::Json equal_errors(const std::vector<BenchCurve>& curves, const BenchCurve& path) {
    core::Json rows = core::Json::array();
    for (const BenchCurve& curve : curves) {
        if (curve.method == path.method) continue;
        for (const double error : {0.05, 0.02, 0.01}) {
            const double seconds = seconds_to(curve, error);
            if (seconds == 0.0) continue;
            const double path_seconds = std::pow(error / path.coefficient, 1.0 / path.slope);
            const double path_error = path.coefficient * std::pow(seconds, path.slope);
            rows.push_back({{"method", curve.method},
                            {"at_rel_l2", error},
                            {"cpu_seconds", seconds},
                            {"path_seconds", path_seconds},
                            {"time_ratio", path_seconds / seconds},  // at this error
                            {"error_ratio", path_error / error}});   // at the method's time
        }
    }
    return rows;
}

void mark_front(std::vector<BenchCurve>& curves) {
    for (BenchCurve& curve : curves) {
        for (BenchPoint& point : curve.points) {
            point.is_on_front = std::ranges::none_of(curves, [&](const BenchCurve& other) {
                return std::ranges::any_of(other.points, [&](const BenchPoint& better) {
                    return better.cpu_seconds < point.cpu_seconds && better.rel_l2 < point.rel_l2;
                });
            });
        }
    }
}

}  // namespace

std::vector<BenchCurve> measure_curves(const RenderBenchSettings& settings,
                                       const core::Progress& progress,
                                       core::Json& figures) {
    using renderer::Estimator;
    const BenchScene bench(settings.scene);
    const core::Capture reference = make_reference(bench, settings.quick, figures);
    const core::ThreadLimit one_thread(1);
    const renderer::RenderSettings& base = bench.settings();
    const auto sampled = [&](Estimator method, std::vector<int> samples) {
        if (settings.quick) samples.pop_back();
        return sampled_efforts(base, method, samples);
    };
    const std::vector<std::vector<Effort>> methods{
        sampled(Estimator::Path, {512, 4096, 32768, 131072}),
        sampled(Estimator::Ellipsoidal, {256, 2048, 16384}),
        sampled(Estimator::Restir, {32, 256, 2048}),
        third_bounce_efforts(base)};
    std::vector<BenchCurve> curves;
    for (const std::vector<Effort>& efforts : methods) {
        curves.push_back(
            measure_curve(bench,
                          std::string(core::enum_name(efforts.front().settings.method)),
                          efforts,
                          reference,
                          settings.repeats,
                          progress));
    }
    mark_front(curves);
    figures["ray_limit_seconds"] = static_cast<double>(reference.transient.num_pairs()) *
                                   shadow_ray_seconds(bench.scene(), bench.scan().wall());
    figures["curves"] = core::write_value(curves);
    figures["equal_error"] = equal_errors(curves, curves.front());
    return curves;
}

}  // namespace apps
