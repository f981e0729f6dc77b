// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <optional>
#include <vector>

namespace nlos {

/// First light arrives where a histogram passes this fraction of its maximum.
inline constexpr double kFirstLightFraction = 0.3;

/// Path length, from and to the wall, at which a pair's first light arrives, between bins.
///
/// ambient   background per bin, not counted
/// fraction  of the histogram's maximum, in (0, 1), which first light passes
/// returns   nothing for a dark histogram, and where light was there when observation began late:
///           the first of it may have come before
std::optional<double> first_light_m(const core::Capture& capture,
                                    std::size_t pair,
                                    double ambient,
                                    double fraction = kFirstLightFraction);

/// The same of as many pairs as there are sensing points: for every point of a confocal and of a
/// single-laser scan, as the first laser point lights it in an exhaustive one.
///
/// ambient   background per bin of every pair
std::vector<std::optional<double>> first_light_m(const core::Capture& capture,
                                                 const std::vector<double>& ambient,
                                                 double fraction = kFirstLightFraction);

/// By what factor the bins of a confocal capture look too wide for its wall, from how first light
/// bends over the wall.
///
/// First light of a confocal point x comes from the nearest hidden point: its range is
/// r(x) = min |p - x|, so that r^2 - |x|^2 = min (|p|^2 - 2 p.x) bends downwards everywhere, and
/// r^2 bends upwards by 2 per metre squared at most, k = 1 in units of that. A point, an edge
/// across and a tip reach it; a plane has k = 0, a ball of radius R seen from d has at most 1 - R /
/// d. Bins given s times too wide give s^2 k, and so does a wall given s times too small.
///
/// Quadratics are fitted to r^2 in windows of a quarter of the wall's sides, every half window; k
/// is the larger bend. Windows whose residual exceeds a bin, or whose bend is uncertain by more
/// than 0.05, are left out: they see several surfaces, or noise. What nine in ten of the others
/// stay below is s^2, as far as edges and tips are in view. A window does without up to half its
/// points where these did not observe all bins.
struct BendOfFirstLight {
    double k = 0.0;            ///< s^2
    double uncertainty = 0.0;  ///< one standard deviation of k in its window
};

/// capture       confocal, points on an even planar grid
/// first_light   of every point, see first_light_m() [m]
/// returns       nothing for other captures, grids of fewer than 16 points a side, or when fewer
///               than half of all windows are of use
/// throws        nothing
std::optional<BendOfFirstLight> bend_of_first_light(
    const core::Capture& capture, const std::vector<std::optional<double>>& first_light);

}  // namespace nlos
