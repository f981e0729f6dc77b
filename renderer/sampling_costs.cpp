// SPDX-License-Identifier: MIT
#include "renderer/sampling_costs.h"

#include "renderer/core/sampling.h"
#include "renderer/core/system/parallel.h"
#include "renderer/ellipsoidal/ellipsoidal_tracer.h"
#include "renderer/path/path_tracer.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <span>
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

/// Of batches of samples, summed over bins and pairs.
struct SampledLight {
    double variance = 0.0;  ///< of one batch
    double squared = 0.0;   ///< of the light, without what noise adds
    double seconds = 0.0;   ///< of one batch

    SampledLight& operator+=(const SampledLight& other) {
        variance += other.variance;
        squared += other.squared;
        seconds += other.seconds;
        return *this;
    }
};

using SubpathsOfBatches = std::array<std::unique_ptr<const LightSubpaths>, kBatches>;

SampledLight sample_pair(const RenderTask& task,
                         const Tracer& tracer,
                         const SensorPairs& sensor_pairs,
                         std::size_t pair,
                         int samples,
                         const SubpathsOfBatches& subpaths,
                         const SamplingRate& rate) {
    std::vector<double> sums(static_cast<std::size_t>(task.axes.time.num_bins));
    std::vector<double> squares(sums.size());
    std::uint64_t num_rays = 0;
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
        PassHistogram histogram({task.axes.time, {}}, task.settings.gate, /*num_channels=*/1);
        core::Rng rng(0, kItem + pair, batch);
        num_rays +=
            tracer.trace(sensor_pairs, pair, samples, rng, histogram, subpaths[batch].get());
        histogram.drain(
            [&](std::size_t begin, std::span<const double> values) {
                for (std::size_t i = 0; i < values.size(); ++i) {
                    sums[begin + i] += values[i];
                    squares[begin + i] += values[i] * values[i];
                }
            },
            [](std::size_t, std::span<const double>) {});
    }
    SampledLight light;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double mean = sums[i] / kBatches;
        const double variance = (squares[i] - kBatches * mean * mean) / (kBatches - 1);
        light.variance += variance;
        light.squared += mean * mean - variance / kBatches;
    }
    const double rays = static_cast<double>(num_rays) / kBatches;
    const double first_rays = std::min(rays, static_cast<double>(samples));
    light.seconds = samples * rate.per_sample_s + first_rays * rate.first_ray_s +
                    (rays - first_rays) * rate.other_ray_s;
    return light;
}

SampledLight sample_pairs(const RenderTask& task, const Tracer& tracer, const SamplingRate& rate) {
    const SensorPairs sensor_pairs(task.scene, task.scan);
    const std::size_t all = task.scan.num_pairs();
    const std::size_t count = std::min(kPairs, all);
    const int samples = kSamplesPerBatch * static_cast<int>(kPairs / count);
    SubpathsOfBatches subpaths;  // pixels share them
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
        subpaths[batch] =
            tracer.trace_subpaths(sensor_pairs, samples, core::Rng(0, kItem + all, batch));
    }
    std::vector<SampledLight> lights(count);
    core::parallel_for(count, [&](std::size_t i) {
        // Spread out of step with the rows of a grid.
        const double position = core::lattice_point(static_cast<int>(i), 1, core::Vec2::Zero()).y();
        const std::size_t pair =
            count == all ? i : static_cast<std::size_t>(position * static_cast<double>(all));
        lights[i] = sample_pair(task, tracer, sensor_pairs, pair, samples, subpaths, rate);
    });
    SampledLight sum;
    for (const SampledLight& light : lights) sum += light;
    sum.seconds *= static_cast<double>(all) / static_cast<double>(count);
    return sum;
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
