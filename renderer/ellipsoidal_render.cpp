// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal_render.h"

#include "renderer/core/system/parallel.h"
#include "renderer/ellipsoidal/ellipsoidal_tracer.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace renderer {
namespace {

constexpr std::size_t kMeasuredPairs = 128;
constexpr int kMeasuringPasses = 16;                  ///< whose spread gives the standard deviation
constexpr int kMeasuringSamples = 32;                 ///< at most, and no fewer than one
constexpr double kMeasuringShare = 0.02;              ///< of the paths that were rendered
constexpr std::uint64_t kMeasuringItem = 1ULL << 40;  ///< for random numbers of its own

double sum_of(PassHistogram& histogram) {
    double sum = 0.0;
    histogram.drain([](std::size_t, std::span<const double>) {},
                    [&](std::size_t, std::span<const double> totals) {
                        sum += std::accumulate(totals.begin(), totals.end(), 0.0);
                    });
    return sum;
}

double kept_signal(const core::Capture& capture, const std::vector<std::size_t>& pairs) {
    double sum = 0.0;
    for (const std::size_t pair : pairs) {
        for (const float value : capture.transient.histogram(pair)) sum += double{value};
    }
    return sum;
}

// A few of a hundred paths that were rendered, so that what is said takes little time.
int measuring_samples(const RenderTask& task, const RenderResult& result) {
    const double rendered =
        static_cast<double>(result.samples_per_pair) * static_cast<double>(task.scan.num_pairs());
    const double samples =
        kMeasuringShare * rendered / static_cast<double>(kMeasuredPairs * kMeasuringPasses);
    return static_cast<int>(std::clamp(samples, 1.0, double{kMeasuringSamples}));
}

std::string drop_warning(const DroppedSignal& dropped,
                         double kept,
                         const std::vector<std::string>& objects) {
    const double all = dropped.lost + kept;
    if (!(all > 0.0)) return "exclude=drop: what it loses is not known, no signal was seen";
    return fmt::format("exclude=drop loses {:.3g} % +- {:.2g} % of the signal ({})",
                       100.0 * dropped.lost / all,
                       100.0 * dropped.sigma / all,
                       fmt::join(objects, ", "));
}

}  // namespace

DroppedSignal measure_dropped_signal(const RenderTask& task, std::size_t max_pairs, int samples) {
    DroppedSignal dropped;
    const std::size_t count = std::min(max_pairs, task.scan.num_pairs());
    for (std::size_t i = 0; i < count; ++i) {
        dropped.pairs.push_back((2 * i + 1) * task.scan.num_pairs() / (2 * count));
    }
    const EllipsoidalTracer tracer(
        task.scene, task.scan, task.axes.time, task.settings, ConnectionScope::Excluded);
    const SensorPairs sensor_pairs(task.scene, task.scan);
    using Moments = Eigen::Array2d;  // sum and sum of squares
    // One term per pass: its sum over the pairs.
    const Moments moments = core::parallel_sum<Moments>(
        static_cast<std::size_t>(kMeasuringPasses), Moments::Zero(), [&](std::size_t pass) {
            PassHistogram histogram({task.axes.time, {}},
                                    task.settings.gate,
                                    task.settings.by_order ? task.settings.max_bounces : 1);
            double sum = 0.0;
            for (const std::size_t pair : dropped.pairs) {
                core::Rng rng(task.settings.seed, kMeasuringItem + pair, pass);
                tracer.trace(sensor_pairs, pair, samples, rng, histogram);
                sum += sum_of(histogram);
            }
            return Moments(sum, sum * sum);
        });
    dropped.lost = moments[0] / kMeasuringPasses;
    const double variance = moments[1] / kMeasuringPasses - dropped.lost * dropped.lost;
    dropped.sigma = std::sqrt(std::max(0.0, variance) / (kMeasuringPasses - 1));
    return dropped;
}

bool can_be_lit(const ExcludedObjects& excluded, const Scene& scene, const core::Scan& scan) {
    constexpr double kFlat_m = 1e-6;
    if (!scan.has_wall()) return true;
    const core::WallPoints& lights = scan.wall().illumination;
    const auto is_before_a_light = [&](const core::Vec3& vertex) {
        for (std::size_t i = 0; i < lights.size(); ++i) {
            if (lights.normals[i].dot(vertex - lights.positions[i]) > kFlat_m) return true;
        }
        return false;
    };
    return std::ranges::any_of(scene.objects(), [&](const Object& object) {
        return std::ranges::find(excluded.names, object.name) != excluded.names.end() &&
               std::ranges::any_of(object.mesh.vertices, is_before_a_light);
    });
}

std::string surfaces_kept(const RenderSettings& settings, const ExcludedObjects& excluded) {
    const bool drops = settings.exclude == Exclusion::Drop && !excluded.names.empty();
    return drops ? "all but the excluded ones" : "all";
}

void warn_of_dropped_signal(const RenderTask& task, const RenderResult& result) {
    if (task.settings.exclude != Exclusion::Drop || result.excluded.names.empty()) return;
    if (!task.progress.warn || !can_be_lit(result.excluded, task.scene, task.scan)) return;
    const DroppedSignal dropped =
        measure_dropped_signal(task, kMeasuredPairs, measuring_samples(task, result));
    const double kept = kept_signal(result.capture, dropped.pairs);
    task.progress.warn(drop_warning(dropped, kept, result.excluded.names));
}

RenderResult render_ellipsoidal(const RenderTask& task) {
    return trace_connections(task, ThirdBounceScope::All, {}, render_passes);
}

RenderResult trace_connections(const RenderTask& task,
                               ThirdBounceScope scope,
                               const PrecomputedPart& precomputed,
                               RenderResult (*render)(const RenderTask&, const PassWork&)) {
    const bool drops = task.settings.exclude == Exclusion::Drop;
    const int first = scope == ThirdBounceScope::All ? first_order(task.scan) : 4;
    PassWork work{nullptr, precomputed};
    if (task.settings.max_bounces >= first_order(task.scan)) {
        work.tracer = std::make_shared<const EllipsoidalTracer>(
            task.scene,
            task.scan,
            task.axes.time,
            task.settings,
            drops ? ConnectionScope::Kept : ConnectionScope::All,
            scope);
    }
    work.is_even = scope == ThirdBounceScope::All && task.scan.has_wall();
    RenderResult result = render(task, work);
    if (work.tracer == nullptr) return result;
    result.excluded = ExcludedFacets::of(task.scene, task.axes.time, task.settings).objects;
    const std::string surfaces = surfaces_kept(task.settings, result.excluded);
    if (task.settings.max_bounces >= first) {
        result.sources.push_back(
            {first, task.settings.max_bounces, Estimator::Ellipsoidal, surfaces});
    }
    warn_of_dropped_signal(task, result);
    return result;
}

}  // namespace renderer
