// SPDX-License-Identifier: MIT
#include "renderer/bounce_truncation.h"

#include "renderer/core/parallel.h"
#include "renderer/path/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace renderer {
namespace {

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
