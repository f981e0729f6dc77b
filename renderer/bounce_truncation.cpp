// SPDX-License-Identifier: MIT
#include "renderer/bounce_truncation.h"

#include "renderer/core/system/parallel.h"
#include "renderer/path/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace renderer {
namespace {

constexpr std::size_t kMaxPairs = 128;
constexpr int kCouples = 8;                            ///< of independent runs
constexpr int kSamples = 256;                          ///< per pair and run
constexpr std::uint64_t kTruncationItem = 1ULL << 41;  ///< for random numbers of its own

/// Over some pairs, the light of each order and all later ones, a row each.
struct Tails {
    /// Squared norms, a column for each couple of runs: the product of two independent estimates
    /// has no bias from their noise.
    Eigen::ArrayXXd norms;
    Eigen::ArrayXd light;  ///< sums over bins

    explicit Tails(int num_orders)
        : norms(Eigen::ArrayXXd::Zero(num_orders, kCouples)),
          light(Eigen::ArrayXd::Zero(num_orders)) {}
    Tails& operator+=(const Tails& other) {
        norms += other.norms;
        light += other.light;
        return *this;
    }
};

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

Tails tails_of_pair(const RenderTask& task,
                    const PathTracer& tracer,
                    const SensorPairs& sensor_pairs,
                    std::size_t pair) {
    const auto num_orders = static_cast<std::size_t>(task.settings.max_bounces);
    const auto bins = static_cast<std::size_t>(task.axes.time.num_bins);
    PassHistogram histogram({task.axes.time, {}}, task.settings.gate, task.settings.max_bounces);
    const auto trace_tails = [&](std::size_t run) {
        core::Rng rng(task.settings.seed, kTruncationItem + pair, run);
        tracer.trace(sensor_pairs, pair, kSamples, rng, histogram);
        return tails_of(histogram, num_orders, bins);
    };
    Tails tails(task.settings.max_bounces);
    for (int couple = 0; couple < kCouples; ++couple) {
        const auto run = 2 * static_cast<std::size_t>(couple);
        const std::vector<double> first = trace_tails(run);
        const std::vector<double> second = trace_tails(run + 1);
        for (std::size_t j = 0; j < first.size(); ++j) {
            const auto order = static_cast<Eigen::Index>(j / bins);
            tails.norms(order, couple) += first[j] * second[j];
            tails.light[order] += first[j] + second[j];
        }
    }
    return tails;
}

// The norm of the light from an order on, so many standard deviations above its estimate.
double norm_from(const Eigen::ArrayXXd& norms, int order, double deviations) {
    const auto of_couples = norms.row(order - 1);
    double sum = 0.0;
    double squares = 0.0;
    for (const double norm : of_couples) {
        sum += norm;
        squares += norm * norm;
    }
    const double mean = sum / kCouples;
    const double variance = std::max(0.0, squares / kCouples - mean * mean) / (kCouples - 1);
    return std::sqrt(std::max(0.0, mean + deviations * std::sqrt(variance)));
}

}  // namespace

BounceTruncation find_bounce_truncation(const RenderTask& task, double allowed) {
    RenderSettings measuring = task.settings;
    measuring.by_order = true;
    const PathTracer tracer(task.scene, measuring);
    const SensorPairs sensor_pairs(task.scene, task.scan);
    const std::size_t num_pairs = std::min(kMaxPairs, task.scan.num_pairs());
    const Tails none(task.settings.max_bounces);
    const Tails tails = core::parallel_sum<Tails>(num_pairs, none, [&](std::size_t i) {
        const std::size_t pair = (2 * i + 1) * task.scan.num_pairs() / (2 * num_pairs);
        return tails_of_pair(task, tracer, sensor_pairs, pair);
    });
    BounceTruncation result{task.settings.max_bounces};
    const double all = norm_from(tails.norms, 1, 0.0);
    if (!(all > 0.0)) return result;
    for (; result.last > 3; --result.last) {
        const double tail = norm_from(tails.norms, result.last, 2.0) / all;
        if (tail > allowed) break;
        result.left_out = tail;
        result.share = tails.light[result.last - 1] / tails.light[0];
    }
    return result;
}

}  // namespace renderer
