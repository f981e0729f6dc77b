// SPDX-License-Identifier: MIT
#include "renderer/pass_render.h"

#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/core/stopwatch.h"
#include "renderer/film/transient_accumulator.h"
#include "renderer/pass_plan.h"
#include "renderer/path/path_tracer.h"

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

// Runs passes over the pairs of a tile until the plan, the clock or the caller ends them.
struct PassLoop {
    const RenderTask& task;
    const PassWork& work;
    SensorPairs sensor_pairs;
    TransientAccumulator::SquaredNorms norms{};  ///< of all tiles so far

    /// Adds the tile's histograms, samples and rays to `result`.
    void run(const Tile& tile, const core::Progress& progress, RenderResult& result);
    /// Of passes [first, first + count).
    using Subpaths = std::vector<std::unique_ptr<const LightSubpaths>>;
    Subpaths trace_subpaths(int first, int count, int samples) const;
    /// Returns the number of rays.
    std::uint64_t run_passes(
        const Tile& tile, int first, int count, int samples, HistogramSums& sums) const;
};

// Pairs have streams of random numbers up to num_pairs() - 1; what they share has the next one.
PassLoop::Subpaths PassLoop::trace_subpaths(int first, int count, int samples) const {
    Subpaths subpaths;
    for (int pass = first; work.tracer != nullptr && pass < first + count; ++pass) {
        const core::Rng rng(
            task.settings.seed, task.scan.num_pairs(), static_cast<std::uint64_t>(pass));
        subpaths.push_back(work.tracer->trace_subpaths(sensor_pairs, samples, rng));
    }
    return subpaths;
}

std::uint64_t PassLoop::run_passes(
    const Tile& tile, int first, int count, int samples, HistogramSums& sums) const {
    constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
    std::atomic<std::size_t> bad_pair{kNone};
    std::atomic<std::uint64_t> num_rays{0};
    const Subpaths subpaths = trace_subpaths(first, count, samples);
    for (const auto& of_pass : subpaths) num_rays += of_pass != nullptr ? of_pass->num_rays() : 0;
    core::parallel_blocks(tile.count, kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
        PassHistogram histogram(task.axes, task.settings.gate, channel_count(task.settings));
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t pair = tile.begin + i;
            for (int pass = first; pass < first + count; ++pass) {
                core::Rng rng(task.settings.seed, pair, static_cast<std::uint64_t>(pass));
                if (work.tracer != nullptr) {
                    const auto& of_pass = subpaths[static_cast<std::size_t>(pass - first)];
                    num_rays += work.tracer->trace(
                        sensor_pairs, pair, samples, rng, histogram, of_pass.get());
                }
                if (!sensor_pairs.is_image() && work.adds_short_paths) {
                    add_short_paths(task.scene, sensor_pairs.ends(pair), task.settings, histogram);
                }
                sums.add_pass(i, histogram);
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
                    task.settings.seed));
}

void PassLoop::run(const Tile& tile, const core::Progress& progress, RenderResult& result) {
    const core::Stopwatch watch;
    const bool samples = work.tracer != nullptr;
    PassPlan plan = samples ? plan_passes(task.scan, task.settings) : PassPlan{0, 1};
    HistogramSums sums(tile.count, task.axes, channel_count(task.settings), task.settings.variance);
    std::optional<StoppingRule> rule;
    int first = 0;  // passes before it were a pilot
    int pass = 0;
    double paths = 0.0;
    const auto share_after_round = [&] {
        if (pass == 0) rule.emplace(task.settings, plan.num_passes, work.precomputed);
        const int count = next_round(plan, task.settings, pass, watch.seconds());
        result.num_rays += run_passes(tile, first + pass, count, plan.samples_per_pass, sums);
        pass += count;
        const double elapsed = watch.seconds();
        const double share = samples ? rule->share_done(pass, elapsed, sums.time) : 1.0;
        paths += static_cast<double>(tile.count) * plan.samples_per_pass * count;
        progress.update(share, fmt::format("{:.2f} M paths/s", paths / elapsed * 1e-6));
        return share;
    };
    while (true) {
        const double share = share_after_round();
        if (share >= 1.0) break;
        result.interrupted = progress.should_stop();
        if (result.interrupted) break;
        if (!is_open_ended(task.settings) || first + pass != kPilotPasses) continue;
        const auto longer = plan_after_pilot(task.scan, task.settings, share);
        if (!longer) continue;
        plan = *longer;
        first = std::exchange(pass, 0);
        sums.reset();
    }
    if (samples && pass > 1) {
        const auto of_tile = sums.time.squared_norms(pass, work.precomputed.transient);
        norms.noise += of_tile.noise;
        norms.signal += of_tile.signal;
        result.estimated_error = relative_error(norms, work.precomputed);
    }
    sums.write_to(result.capture, tile.begin, pass);
    result.samples_per_pair =
        static_cast<std::uint64_t>(plan.samples_per_pass) * static_cast<std::uint64_t>(pass);
}

constexpr std::size_t kMaxPairs = 128;
constexpr std::size_t kRuns = 16;                      ///< independent, taken in couples
constexpr int kSamples = 256;                          ///< per pair and run
constexpr std::uint64_t kTruncationItem = 1ULL << 41;  ///< for random numbers of its own

// What a pair receives in each order and all later ones: [order - 1][bin].
std::vector<double> tails_of(PassHistogram& histogram, std::size_t num_orders, std::size_t bins) {
    std::vector<double> tails(num_orders * bins);
    histogram.drain(
        [&](std::size_t begin, std::span<const double> values) {
            std::copy(values.begin(), values.end(), tails.data() + begin);
        },
        [](std::size_t, std::span<const double>) {});
    for (std::size_t i = (num_orders - 1) * bins; i-- > 0;) tails[i] += tails[i + bins];
    return tails;
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
    PassLoop loop{task, work, SensorPairs(task.scene, task.scan)};
    for (std::size_t begin = 0; begin < num_pairs; begin += tile_pairs) {
        const Tile tile{begin, std::min(tile_pairs, num_pairs - begin)};
        core::Progress part = task.progress;
        part.report = [&](double share, const std::string& detail) {
            const double pairs =
                static_cast<double>(begin) + share * static_cast<double>(tile.count);
            task.progress.update(pairs / static_cast<double>(num_pairs), detail);
        };
        loop.run(tile, part, result);
        if (result.interrupted && tile.count < num_pairs) {
            throw core::Failure("render", "interrupted before every part of the scan was traced");
        }
    }
    result.seconds = watch.seconds();
    return result;
}

BounceTruncation find_bounce_truncation(const RenderTask& task, double allowed) {
    RenderSettings measuring = task.settings;
    measuring.by_order = true;
    const PathTracer tracer(task.scene, measuring);
    const SensorPairs sensor_pairs(task.scene, task.scan);
    constexpr std::size_t kCouples = kRuns / 2;
    const auto num_orders = static_cast<std::size_t>(task.settings.max_bounces);
    const auto bins = static_cast<std::size_t>(task.axes.time.num_bins);
    const std::size_t num_pairs = std::min(kMaxPairs, task.scan.num_pairs());
    // Squared norms of the tails over these pairs, [order - 1][couple of runs]. The product of two
    // independent estimates has no bias from their noise.
    using Norms = Eigen::ArrayXd;
    const Norms zero = Norms::Zero(static_cast<Eigen::Index>(num_orders * kCouples));
    const Norms norms = core::parallel_sum<Norms>(num_pairs, zero, [&](std::size_t i) {
        const std::size_t pair = (2 * i + 1) * task.scan.num_pairs() / (2 * num_pairs);
        Norms result = zero;
        PassHistogram histogram(
            {task.axes.time, {}}, task.settings.gate, task.settings.max_bounces);
        std::vector<double> first;
        for (std::size_t run = 0; run < kRuns; ++run) {
            core::Rng rng(task.settings.seed, kTruncationItem + pair, run);
            tracer.trace(sensor_pairs, pair, kSamples, rng, histogram);
            std::vector<double> tails = tails_of(histogram, num_orders, bins);
            if (run % 2 == 0) {
                first = std::move(tails);
                continue;
            }
            for (std::size_t j = 0; j < tails.size(); ++j) {
                const std::size_t norm = j / bins * kCouples + run / 2;
                result[static_cast<Eigen::Index>(norm)] += first[j] * tails[j];
            }
        }
        return result;
    });
    const auto norm_from = [&](std::size_t order, double deviations) {
        const double* const begin = norms.data() + (order - 1) * kCouples;
        double sum = 0.0;
        double squares = 0.0;
        for (std::size_t c = 0; c < kCouples; ++c) {
            sum += begin[c];
            squares += begin[c] * begin[c];
        }
        const double mean = sum / kCouples;
        const double variance = std::max(0.0, squares / kCouples - mean * mean) / (kCouples - 1);
        return std::sqrt(std::max(0.0, mean + deviations * std::sqrt(variance)));
    };
    BounceTruncation result{task.settings.max_bounces, 0.0};
    const double all = norm_from(1, 0.0);
    if (!(all > 0.0)) return result;
    for (; result.last > 3; --result.last) {
        const double tail = norm_from(static_cast<std::size_t>(result.last), 2.0) / all;
        if (tail > allowed) break;
        result.left_out = tail;
    }
    return result;
}

}  // namespace renderer
