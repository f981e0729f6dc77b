// SPDX-License-Identifier: MIT
#include "nlos/compare.h"
#include "nlos/compare_image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

void check_same_shape(const core::Transient& found, const core::Transient& wanted) {
    if (found.num_pairs() == wanted.num_pairs() && found.num_bins() == wanted.num_bins()) return;
    throw core::Error("compare: H",
                      fmt::format("found {} pairs x {} bins against {} x {}",
                                  found.num_pairs(),
                                  found.num_bins(),
                                  wanted.num_pairs(),
                                  wanted.num_bins()),
                      "both captures must have the same shape");
}

void check_same_unit(core::TransientUnit found, core::TransientUnit wanted) {
    if (found == wanted) return;
    throw core::Error(
        "compare: unit",
        fmt::format("found {} against {}", core::enum_name(found), core::enum_name(wanted)),
        "both captures must have the same unit");
}

/// Throws when a bin lies more than a hundredth of its width beside its counterpart.
void check_same_bins(const core::TimeAxis& found, const core::TimeAxis& wanted) {
    const double start_gap_m = std::abs(found.opl_start_m - wanted.opl_start_m);
    const double end_gap_m = std::abs(found.opl_end_m() - wanted.opl_end_m());
    if (std::max(start_gap_m, end_gap_m) <= 0.01 * wanted.bin_width_m) return;
    throw core::Error("compare: time axis",
                      fmt::format("found {} m to {} m against {} m to {} m",
                                  found.opl_start_m,
                                  found.opl_end_m(),
                                  wanted.opl_start_m,
                                  wanted.opl_end_m()),
                      "both captures must have the same bins");
}

}  // namespace

Metrics compare_captures(const core::Capture& result, const core::Capture& reference) {
    check_same_shape(result.transient, reference.transient);
    check_same_unit(result.unit, reference.unit);
    check_same_bins(result.time_axis, reference.time_axis);
    Metrics metrics;
    metrics.rel_mse = relative_mse(result.transient.values(), reference.transient.values());
    if (metrics.rel_mse) metrics.rel_l2 = std::sqrt(*metrics.rel_mse);
    return metrics;
}

}  // namespace nlos
