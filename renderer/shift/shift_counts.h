// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string_view>

namespace renderer {

/// Whether a shift is also solved in reverse.
enum class ReverseCheck { On, Off };

/// Why a shift has no result. Occlusion of the new segments is not checked by the shift.
enum class ShiftRejection {
    BelowMinimum,   ///< no point of the surface's plane, or of space, has a path this short
    Degenerate,     ///< a determinant is zero: near the tangent point or the foci's segment
    Folded,         ///< the map reverses orientation
    NotConverged,   ///< of Newton's method, or by the residuals of a closed form
    LeftChart,      ///< outside the chart, or the ray hit nothing
    LeftSurface,    ///< the point of the plane lies on no facet of the surface
    SecondRoot,     ///< another branch of the curve
    NotReversible,  ///< the reverse shift ends elsewhere
    OtherRoute,     ///< the adaptive chart takes another route in reverse
    JacobianBound,  ///< the Jacobian is too large or too small
};

inline constexpr std::array<std::string_view, 10> kShiftRejectionNames{"below_minimum",
                                                                       "degenerate",
                                                                       "folded",
                                                                       "not_converged",
                                                                       "left_chart",
                                                                       "left_surface",
                                                                       "second_root",
                                                                       "not_reversible",
                                                                       "other_route",
                                                                       "jacobian_bound"};

/// What happened in one shift.
struct ShiftTrace {
    ShiftRejection rejection = ShiftRejection::NotConverged;  ///< when there is no result
    int iterations = 0;                                       ///< Newton steps, reverse included

    std::nullopt_t reject(ShiftRejection reason) {
        rejection = reason;
        return std::nullopt;
    }
};

/// Sums over many shifts.
struct ShiftCounts {
    std::uint64_t accepted = 0;
    std::array<std::uint64_t, kShiftRejectionNames.size()> rejected{};
    std::uint64_t iterations = 0;
    std::uint64_t by_ray = 0;  ///< accepted on the hemisphere

    std::uint64_t tried() const {
        return std::accumulate(rejected.begin(), rejected.end(), accepted);
    }
    /// 0 when none was tried.
    double accepted_fraction() const {
        const std::uint64_t all = tried();
        return all > 0 ? static_cast<double>(accepted) / static_cast<double>(all) : 0.0;
    }
    std::uint64_t count_of(ShiftRejection reason) const {
        return rejected[static_cast<std::size_t>(reason)];
    }
    ShiftCounts& operator+=(const ShiftCounts& other) {
        accepted += other.accepted;
        for (std::size_t i = 0; i < rejected.size(); ++i) rejected[i] += other.rejected[i];
        iterations += other.iterations;
        by_ray += other.by_ray;
        return *this;
    }
};

}  // namespace renderer
