// SPDX-License-Identifier: MIT
#include "nlos/preparation/wiener_snr.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr double kSmallestSnr = 1e-3;

/// Weighted sums over bins.
struct Powers {
    double noise = 0.0;
    double total = 0.0;  ///< of signal and noise

    Powers& operator+=(const Powers& other) {
        noise += other.noise;
        total += other.total;
        return *this;
    }
};

}  // namespace

double wiener_snr(const core::WallScan& scan,
                  const core::TimeAxis& axis,
                  const core::Transient& counts,
                  const PreparationPlan& plan,
                  Falloff falloff) {
    const double power = falloff_power(falloff);
    const int merge = plan.merge_bins;
    const auto powers_of = [&](std::size_t pair) {
        const double segments_m = scan.device_segments_m(pair);
        const double ambient = plan.ambient_per_bin.empty() ? 0.0 : plan.ambient_per_bin[pair];
        const auto histogram = counts.histogram(pair);
        Powers powers;
        const core::BinRange observed = plan.prepared_range(pair);
        for (int bin = observed.begin; bin < observed.end; ++bin) {
            const double range = 0.5 * (axis.bin_begin_m((bin + 0.5) * merge) - segments_m);
            if (range <= 0.0) continue;
            double count = 0.0;
            for (int i = bin * merge; i < (bin + 1) * merge; ++i) {
                count += static_cast<double>(histogram[static_cast<std::size_t>(i)]);
            }
            const double signal = count - ambient * merge;
            const double weight = std::pow(range, 2.0 * power - 1.0);
            powers.noise += weight * std::max(0.0, count);
            powers.total += weight * signal * signal;
        }
        return powers;
    };
    const Powers powers = core::parallel_sum<Powers>(counts.num_pairs(), Powers{}, powers_of);
    const double signal = powers.total - powers.noise;
    if (!(signal > 0.0)) return kSmallestSnr;
    return std::max(kSmallestSnr, 1.0 / (1.0 / kNoiselessSnr + powers.noise / signal));
}

}  // namespace nlos
