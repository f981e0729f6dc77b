// SPDX-License-Identifier: MIT
#include "renderer/pass_render.h"

#include "renderer/core/stopwatch.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/film/transient_accumulator.h"
#include "renderer/pass_plan.h"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace renderer {
namespace {

constexpr std::size_t kPairsPerBlock = 16;
// Passes run in rounds: all passes of a round for one pair, then for the next, so that the sums of
// a pair stay in the cache. Between rounds the caller may stop the render.
constexpr double kMaxSecondsPerRound = 0.1;
constexpr int kMaxPassesPerRound = 64;  // what passes share is kept for the round

// Number of passes of the next round when `done` of them took `elapsed_s`; results do not depend on
// it.
int next_round(const PassPlan& plan, const RenderSettings& settings, int done, double elapsed_s) {
    if (done == 0 || is_open_ended(settings)) return 1;
    const double fit = kMaxSecondsPerRound * done / elapsed_s;
    const int left = plan.num_passes - done;
    return static_cast<int>(
        std::clamp(fit, 1.0, static_cast<double>(std::min(left, kMaxPassesPerRound))));
}

int channel_count(const RenderSettings& settings) {
    return settings.by_order ? settings.max_bounces : 1;
}

double num_velocity_values(const core::HistogramAxes& axes) {
    return axes.velocity ? axes.velocity->num_values(axes.time.num_bins) : 0.0;
}

// Running sums per pair: one array per channel, the velocities, and the squares.
double sums_bytes_per_pair(const core::HistogramAxes& axes, const RenderSettings& settings) {
    const double squares = settings.variance ? 1.0 : 0.0;
    return ((channel_count(settings) + squares) * axes.time.num_bins +
            (1.0 + squares) * num_velocity_values(axes)) *
           sizeof(double);
}

std::size_t pairs_per_tile(const RenderTask& task, double max_sums_bytes) {
    if (is_open_ended(task.settings)) return task.scan.num_pairs();
    const double pairs = std::floor(max_sums_bytes / sums_bytes_per_pair(task.axes, task.settings));
    return static_cast<std::size_t>(
        std::clamp(pairs, 1.0, static_cast<double>(task.scan.num_pairs())));
}

void require_memory_for(const RenderTask& task, std::size_t tile_pairs) {
    // The capture's arrays, and the sums of one tile.
    const double kinds = task.settings.variance ? 2.0 : 1.0;
    const double values = (channel_count(task.settings) + kinds) * task.axes.time.num_bins +
                          kinds * num_velocity_values(task.axes);
    require_memory(
        "render",
        fmt::format("{} pairs x {} bins",
                    task.scan.num_pairs(),
                    task.axes.time.num_bins + num_velocity_values(task.axes)),
        values * sizeof(float) * static_cast<double>(task.scan.num_pairs()) +
            sums_bytes_per_pair(task.axes, task.settings) * static_cast<double>(tile_pairs));
}

// Pairs [begin, begin + count) of a scan.
struct Tile {
    std::size_t begin = 0;
    std::size_t count = 0;
};

// Renders one tile: rounds of passes until the plan, the clock or the caller ends them.
class TileRender {
 public:
    TileRender(const RenderTask& task,
               const PassWork& work,
               const SensorPairs& sensor_pairs,
               const Tile& tile)
        : task_(task),
          work_(work),
          sensor_pairs_(sensor_pairs),
          tile_(tile),
          plan_(samples() ? plan_passes(task.scan, task.settings, work.is_even) : PassPlan{0, 1}),
          rule_(task.settings, plan_.num_passes, work.precomputed),
          sums_(tile.count, task.axes, channel_count(task.settings), task.settings.variance) {}

    /// Adds rays, and whether the caller ended it, to `result`.
    void run(const core::Progress& progress, RenderResult& result);
    /// Adds histograms and samples to `result`, and squared norms to those of other tiles.
    void write(RenderResult& result, TransientAccumulator::SquaredNorms& norms) const;

 private:
    using Subpaths = std::vector<std::unique_ptr<const LightSubpaths>>;

    bool samples() const { return work_.tracer != nullptr; }
    double trace_round(const core::Progress& progress, RenderResult& result);
    void lengthen_passes(double fraction);
    Subpaths trace_subpaths(int first, int count) const;
    std::uint64_t run_passes(int first, int count);
    std::uint64_t run_pass(std::size_t pair,
                           int pass,
                           const LightSubpaths* subpaths,
                           PassHistogram& histogram) const;

    const RenderTask& task_;
    const PassWork& work_;
    const SensorPairs& sensor_pairs_;
    Tile tile_;
    PassPlan plan_;
    StoppingRule rule_;
    HistogramSums sums_;
    core::Stopwatch watch_;
    int first_ = 0;  ///< passes before it were shorter, and tell how long others should be
    int done_ = 0;   ///< passes since
    double paths_ = 0.0;
};

void TileRender::run(const core::Progress& progress, RenderResult& result) {
    while (true) {
        const double fraction = trace_round(progress, result);
        if (fraction >= 1.0) return;
        result.interrupted = progress.should_stop();
        if (result.interrupted) return;
        lengthen_passes(fraction);
    }
}

// Returns the fraction of the work that is done.
double TileRender::trace_round(const core::Progress& progress, RenderResult& result) {
    const int count = next_round(plan_, task_.settings, done_, watch_.seconds());
    result.num_rays += run_passes(first_ + done_, count);
    done_ += count;
    const double elapsed = watch_.seconds();
    const double fraction = samples() ? rule_.fraction_done(done_, elapsed, sums_.time) : 1.0;
    paths_ += static_cast<double>(tile_.count) * plan_.samples_per_pass * count;
    progress.update(fraction, fmt::format("{:.2f} M paths/s", paths_ / elapsed * 1e-6));
    return fraction;
}

void TileRender::lengthen_passes(double fraction) {
    if (!is_open_ended(task_.settings) || done_ != kPilotPasses) return;
    const auto longer = plan_longer_passes(
        task_.scan, task_.settings, work_.is_even, plan_.samples_per_pass, fraction);
    if (!longer) return;
    plan_ = *longer;
    rule_ = {task_.settings, plan_.num_passes, work_.precomputed};
    first_ += std::exchange(done_, 0);
    sums_.reset();
}

// Pairs have streams of random numbers up to num_pairs() - 1; what they share has the next one.
TileRender::Subpaths TileRender::trace_subpaths(int first, int count) const {
    Subpaths subpaths;
    for (int pass = first; samples() && pass < first + count; ++pass) {
        const core::Rng rng(
            task_.settings.seed, task_.scan.num_pairs(), static_cast<std::uint64_t>(pass));
        subpaths.push_back(
            work_.tracer->trace_subpaths(sensor_pairs_, plan_.samples_per_pass, rng));
    }
    return subpaths;
}

// Returns the number of rays.
std::uint64_t TileRender::run_pass(std::size_t pair,
                                   int pass,
                                   const LightSubpaths* subpaths,
                                   PassHistogram& histogram) const {
    std::uint64_t num_rays = 0;
    core::Rng rng(task_.settings.seed, pair, static_cast<std::uint64_t>(pass));
    if (samples()) {
        num_rays = work_.tracer->trace(
            sensor_pairs_, pair, plan_.samples_per_pass, rng, histogram, subpaths);
    }
    if (!sensor_pairs_.is_image() && work_.adds_short_paths) {
        add_short_paths(task_.scene, sensor_pairs_.ends(pair), task_.settings, histogram);
    }
    return num_rays;
}

// Likewise of passes [first, first + count).
std::uint64_t TileRender::run_passes(int first, int count) {
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::atomic<std::size_t> bad_pair{kNone};
    std::atomic<std::uint64_t> num_rays{0};
    const Subpaths subpaths = trace_subpaths(first, count);
    for (const auto& of_pass : subpaths) num_rays += of_pass != nullptr ? of_pass->num_rays() : 0;
    core::parallel_blocks(tile_.count, kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
        PassHistogram histogram(task_.axes, task_.settings.gate, channel_count(task_.settings));
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t pair = tile_.begin + i;
            for (int k = 0; k < count; ++k) {
                const LightSubpaths* const of_pass =
                    samples() ? subpaths[static_cast<std::size_t>(k)].get() : nullptr;
                num_rays += run_pass(pair, first + k, of_pass, histogram);
                sums_.add_pass(i, histogram);
            }
            if (histogram.num_non_finite() > 0) bad_pair = std::min(bad_pair.load(), pair);
            if (bad_pair != kNone) return;
        }
    });
    if (bad_pair == kNone) return num_rays;
    throw core::Failure(
        "render",
        fmt::format("a contribution is not finite (pair {}, passes {} to {}, seed {})",
                    bad_pair.load(),
                    first,
                    first + count - 1,
                    task_.settings.seed));
}

void TileRender::write(RenderResult& result, TransientAccumulator::SquaredNorms& norms) const {
    if (samples() && done_ > 1) {
        const auto of_tile = sums_.time.squared_norms(done_, work_.precomputed.transient);
        norms.noise += of_tile.noise;
        norms.signal += of_tile.signal;
        result.estimated_error = relative_error(norms, work_.precomputed);
    }
    sums_.write_to(result.capture, tile_.begin, done_);
    result.samples_per_pair =
        static_cast<std::uint64_t>(plan_.samples_per_pass) * static_cast<std::uint64_t>(done_);
}

}  // namespace

void require_memory(const std::string& where, const std::string& what, double bytes) {
    const auto available = static_cast<double>(core::available_memory_bytes());
    if (bytes <= available) return;
    throw core::Failure(
        where,
        fmt::format("{} need {:.1f} GB, {:.1f} GB are free", what, bytes * 1e-9, available * 1e-9));
}

core::Capture empty_capture(const core::Scan& scan,
                            const core::HistogramAxes& axes,
                            const RenderSettings& settings) {
    core::Capture capture;
    capture.scan = scan;
    capture.time_axis = axes.time;
    capture.transient = core::Transient(scan.num_pairs(), axes.time.num_bins);
    if (axes.velocity) {
        const int num_values = axes.velocity->num_values(axes.time.num_bins);
        capture.velocity = {
            *axes.velocity, core::Transient(scan.num_pairs(), num_values), std::nullopt};
    }
    for (int order = 1; settings.by_order && order <= settings.max_bounces; ++order) {
        capture.orders.push_back(order);
        capture.by_order.emplace_back(scan.num_pairs(), axes.time.num_bins);
    }
    return capture;
}

RenderResult render_passes(const RenderTask& task, const PassWork& work) {
    const core::Stopwatch watch;
    const std::size_t num_pairs = task.scan.num_pairs();
    const std::size_t tile_pairs = pairs_per_tile(task, work.max_sums_bytes);
    require_memory_for(task, tile_pairs);
    RenderResult result;
    result.capture = empty_capture(task.scan, task.axes, task.settings);
    const SensorPairs sensor_pairs(task.scene, task.scan);
    TransientAccumulator::SquaredNorms norms;
    for (std::size_t begin = 0; begin < num_pairs; begin += tile_pairs) {
        const Tile tile{begin, std::min(tile_pairs, num_pairs - begin)};
        core::Progress part = task.progress;
        part.report = [&](double fraction, const std::string& detail) {
            const double pairs =
                static_cast<double>(begin) + fraction * static_cast<double>(tile.count);
            task.progress.update(pairs / static_cast<double>(num_pairs), detail);
        };
        TileRender of_tile(task, work, sensor_pairs, tile);
        of_tile.run(part, result);
        of_tile.write(result, norms);
        if (result.interrupted && tile.count < num_pairs) {
            throw core::Failure("render", "interrupted before every part of the scan was traced");
        }
    }
    result.seconds = watch.seconds();
    return result;
}

}  // namespace renderer
