// SPDX-License-Identifier: MIT
#include "renderer/smoothed_render.h"

#include "renderer/core/random.h"
#include "renderer/core/stopwatch.h"
#include "renderer/film/scan_smoothing.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace renderer {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();
constexpr int kFirstSamples = 128;  // per pair and half; fewer take hardly less time
// Of the number of samples between two looks at the error.
constexpr double kMinGrowth = 1.25;
constexpr double kMaxGrowth = 2.0;
// Of everything, at one time: halves, what passes return, and means and differences as they were
// and smoothed, two of each while the best are sought.
constexpr double kTransients = 10.0;

// One of two independent estimates.
struct Half {
    core::Transient mean;
    std::uint64_t samples = 0;  ///< per pair

    void add(const RenderResult& estimate) {
        samples += estimate.samples_per_pair;
        const float fraction =
            static_cast<float>(estimate.samples_per_pair) / static_cast<float>(samples);
        const std::span<const float> values = estimate.capture.transient.values();
        std::transform(values.begin(),
                       values.end(),
                       mean.values().begin(),
                       mean.values().begin(),
                       [&](float now, float before) { return before + fraction * (now - before); });
    }
};

// By how much the samples have to grow; at most 1 when the error is small enough.
double growth_needed(const SmoothedMean& smoothed,
                     double target,
                     const PrecomputedPart& precomputed) {
    const double allowed = allowed_noise(smoothed.squared_signal, target, precomputed);
    if (smoothed.squared_error <= allowed) return 1.0;
    const double bias = smoothed.squared_error - smoothed.squared_noise;
    return bias < allowed ? smoothed.squared_noise / (allowed - bias) : kUnlimited;
}

// Orders 1 and 2, which take next to no time.
RenderResult render_short_paths(const RenderTask& task) {
    const core::Progress silent;
    return render_passes({task.scene, task.scan, task.axes, task.settings, silent},
                         {nullptr, {}, kUnlimited});
}

class SmoothedRender {
 public:
    SmoothedRender(const RenderTask& task, const PassWork& work)
        : task_(task),
          sampling_{work.tracer, {}, kUnlimited, false},
          precomputed_(work.precomputed),
          result_(render_short_paths(task)) {
        for (Half& half : halves_) {
            half.mean = core::Transient(task.scan.num_pairs(), task.axes.time.num_bins);
        }
    }

    RenderResult run() {
        int samples = kFirstSamples;
        double begin = 0.0;
        double end = 0.1;  // of the work; how much there is shows later
        for (std::uint64_t round = 0;; ++round) {
            trace(round, samples, task_.progress.part(begin, end));
            SmoothedMean smoothed = smooth_mean(
                halves_[0].mean, halves_[1].mean, task_.scan.wall(), precomputed_.transient);
            const double needed =
                growth_needed(smoothed, *task_.settings.target_error, precomputed_);
            if (needed <= 1.0 || result_.interrupted) return finish(smoothed);
            const double growth = std::clamp(needed, kMinGrowth, kMaxGrowth);
            samples = static_cast<int>(
                std::ceil(static_cast<double>(halves_[0].samples) * (growth - 1.0)));
            begin = 1.0 / needed;
            end = std::min(0.99, growth / needed);
        }
    }

 private:
    // Adds samples per pair to both halves.
    void trace(std::uint64_t round, int samples, const core::Progress& progress) {
        for (std::uint64_t i = 0; i < halves_.size(); ++i) {
            const double half = 0.5 * static_cast<double>(i);
            const core::Progress part = progress.part(half, half + 0.5);
            RenderTask task{task_.scene, task_.scan, task_.axes, task_.settings, part};
            task.settings.target_error.reset();
            task.settings.samples = samples;
            // Streams of their own, which no other seed of a user's has.
            task.settings.seed =
                core::Rng::mix(core::Rng::mix(task_.settings.seed) + 2 * round + i + 1);
            const RenderResult estimate = render_passes(task, sampling_);
            halves_[i].add(estimate);
            result_.num_rays += estimate.num_rays;
            result_.interrupted = result_.interrupted || estimate.interrupted;
        }
    }

    RenderResult finish(const SmoothedMean& smoothed) {
        result_.capture.transient += smoothed.mean;
        if (!smoothed.widths.is_none()) result_.smoothing = smoothed.widths;
        result_.samples_per_pair = halves_[0].samples + halves_[1].samples;
        result_.estimated_error =
            relative_error({smoothed.squared_error, smoothed.squared_signal}, precomputed_);
        return std::move(result_);
    }

    const RenderTask& task_;
    PassWork sampling_;
    PrecomputedPart precomputed_;
    RenderResult result_;  ///< orders 1 and 2 until the end
    std::array<Half, 2> halves_;
};

}  // namespace

RenderResult render_smoothed(const RenderTask& task, const PassWork& work) {
    const core::Stopwatch watch;
    const double values =
        static_cast<double>(task.scan.num_pairs()) * static_cast<double>(task.axes.time.num_bins);
    require_memory(
        "render",
        fmt::format("{} pairs x {} bins", task.scan.num_pairs(), task.axes.time.num_bins),
        kTransients * sizeof(float) * values);
    RenderResult result = SmoothedRender(task, work).run();
    result.seconds = watch.seconds();
    return result;
}

}  // namespace renderer
