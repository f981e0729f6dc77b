// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"

#include <fmt/core.h>

#include <optional>

namespace core {

/// Bins of optical path length [m]: bin i covers [opl_start + i w, opl_start + (i+1) w).
struct TimeAxis {
    double opl_start_m = 0.0;
    double bin_width_m = 0.008;
    int num_bins = 512;

    double bin_width_ps() const { return 1e12 * bin_width_m / kSpeedOfLight; }
    double opl_end_m() const { return opl_start_m + num_bins * bin_width_m; }
    double bin_begin_m(double bin) const { return opl_start_m + bin * bin_width_m; }
    double bin_center_m(double bin) const { return opl_start_m + (bin + 0.5) * bin_width_m; }

    /// The bin that holds `opl_m`, or nothing when it lies outside the axis.
    std::optional<int> bin_of(double opl_m) const {
        const double position = (opl_m - opl_start_m) / bin_width_m;
        if (!(position >= 0.0) || !(position < num_bins)) return std::nullopt;
        return static_cast<int>(position);
    }
};

template <class Visitor>
void for_each_field(TimeAxis& axis, Visitor&& visit) {
    visit("opl_start_m",
          axis.opl_start_m,
          Ranged{"optical path length at the start of bin 0 [m]", {}});
    visit("bin_width_m", axis.bin_width_m, above(0, "width of a bin in optical path length [m]"));
    visit("num_bins", axis.num_bins, at_least(1, "number of bins; one bin is a time gate"));
}

/// Longer paths are nobody's: light takes three seconds.
inline constexpr double kLongestPath_m = 1e9;

/// Throws Error unless the axis has at least one bin of positive width and ends at lengths that
/// occur.
inline void validate(const TimeAxis& axis, const std::string& where) {
    check_ranges(axis, where);
    if (!(axis.opl_start_m >= -kLongestPath_m) || !(axis.opl_end_m() <= kLongestPath_m)) {
        throw Error(
            where,
            fmt::format("path lengths from {:.3g} to {:.3g} m", axis.opl_start_m, axis.opl_end_m()),
            "must lie within 1e9 m of 0");
    }
}

}  // namespace core
