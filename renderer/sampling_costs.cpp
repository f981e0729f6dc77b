// SPDX-License-Identifier: MIT
#include "renderer/sampling_costs.h"

#include "renderer/core/system/parallel.h"
#include "renderer/ellipsoidal/ellipsoidal_tracer.h"
#include "renderer/film/transient_accumulator.h"
#include "renderer/light_range.h"
#include "renderer/path/path_tracer.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

namespace renderer {
namespace {

constexpr std::size_t kPairs = 96;
constexpr int kBatches = 4;                  // whose spread gives the variance
constexpr int kSamplesPerBatch = 64;         // of a pair, more of few
constexpr std::uint64_t kItem = 1ULL << 43;  // for random numbers of its own

/// CPU time of a sample, its first ray and each other [s], less what the many samples of a render
/// gain by being spread evenly. First rays go in packets; others belong to longer walks. Fitted, to
/// a factor of two, to renders of scenes/letter, bars, corner, box and room, up to 3 to 5 bounces.
struct SamplingRate {
    double per_sample_s = 0.0;
    double first_ray_s = 0.0;
    double other_ray_s = 0.0;
};
constexpr SamplingRate kPaths{1e-8, 4.5e-8, 2e-7};
constexpr SamplingRate kConnections{2e-7, 1e-7, 3e-7};

/// Of batches of samples of all pairs.
struct SampledLight {
    double variance = 0.0;  ///< of one batch, summed over bins
    double squared = 0.0;   ///< of the light, without what noise adds
    double seconds = 0.0;   ///< of one batch
};

double seconds_of(double samples, double rays, const SamplingRate& rate) {
    const double first_rays = std::min(rays, samples);
    return samples * rate.per_sample_s + first_rays * rate.first_ray_s +
           (rays - first_rays) * rate.other_ray_s;
}

SampledLight sample_pairs(const RenderTask& task, const Tracer& tracer, const SamplingRate& rate) {
    const SensorPairs sensor_pairs(task.scene, task.scan);
    const std::size_t all = task.scan.num_pairs();
    const std::size_t count = std::min(kPairs, all);
    const int samples = kSamplesPerBatch * static_cast<int>(kPairs / count);
    std::array<std::unique_ptr<const LightSubpaths>, kBatches> subpaths;  // pixels share them
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
        subpaths[batch] =
            tracer.trace_subpaths(sensor_pairs, samples, core::Rng(0, kItem + all, batch));
    }
    TransientAccumulator batches(
        count, task.axes.time.num_bins, /*num_channels=*/1, /*variance=*/false);
    std::vector<double> seconds(count);
    core::parallel_for(count, [&](std::size_t i) {
        const std::size_t pair = spread_pair(i, kPairs, all);
        std::uint64_t num_rays = 0;
        for (std::size_t batch = 0; batch < kBatches; ++batch) {
            PassHistogram histogram({task.axes.time, {}}, task.settings.gate, /*num_channels=*/1);
            core::Rng rng(0, kItem + pair, batch);
            num_rays +=
                tracer.trace(sensor_pairs, pair, samples, rng, histogram, subpaths[batch].get());
            batches.add_pass(i, histogram);
        }
        seconds[i] = seconds_of(samples, static_cast<double>(num_rays) / kBatches, rate);
    });
    const auto norms = batches.squared_norms(kBatches, nullptr);
    const double per_pair_s =
        std::accumulate(seconds.begin(), seconds.end(), 0.0) / static_cast<double>(count);
    return {norms.noise * kBatches, norms.signal, per_pair_s * static_cast<double>(all)};
}

}  // namespace

SamplingCosts find_sampling_costs(const RenderTask& task, ThirdBounceScope scope) {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    RenderSettings settings = task.settings;
    settings.by_order = false;
    const SampledLight paths = sample_pairs(task, PathTracer(task.scene, settings, scope), kPaths);
    SampledLight connections{0.0, 0.0, kUnknown};
    if (!task.axes.velocity) {
        const EllipsoidalTracer tracer(
            task.scene, task.scan, task.axes.time, settings, ConnectionScope::All, scope);
        connections = sample_pairs(task, tracer, kConnections);
    }
    const auto relative = [](const SampledLight& light) {
        return light.squared > 0.0 ? light.variance / light.squared : kUnknown;
    };
    // The light as those know it who see it with less noise.
    const double squared =
        relative(connections) < relative(paths) ? connections.squared : paths.squared;
    const auto cost = [&](const SampledLight& light) {
        const bool sees_light = squared > 0.0 && (light.squared > 0.0 || light.variance > 0.0);
        return sees_light ? light.variance / squared * light.seconds : kUnknown;
    };
    return {cost(paths), cost(connections), !task.axes.velocity};
}

}  // namespace renderer
