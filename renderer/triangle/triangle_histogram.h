// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"

#include <array>
#include <span>
#include <vector>

namespace renderer {

/// A triangle over which path length and weight are linear: their values at its three corners.
///
/// The weight is what a unit of area adds to the histogram.
struct TriangleKnots {
    std::array<double, 3> opl_m{};
    std::array<double, 3> weight{};
};

/// Linear knots of a triangle on which length and weight are only nearly linear.
///
/// The corner values are shifted by the same amount so that their mean is the mean at the edges'
/// midpoints, which is the mean over the triangle up to third order. That removes the convexity
/// bias of the corners. Weights stay at or above 0: where a corner would fall below, the spread
/// about the mean shrinks until it does not.
///
/// at_corners    exact lengths [m] and weights at the corners
/// at_midpoints  the same at the midpoints of the three edges, in any order
TriangleKnots match_midpoints(const TriangleKnots& at_corners, const TriangleKnots& at_midpoints);

/// Mean over the triangle of weight * [length < opl_m]: the cumulative histogram per unit area.
double triangle_cumulative(const TriangleKnots& knots, double opl_m);

/// Triangles side by side, one per lane, for vectorised loops. Weights are linear, lengths
/// quadratic: with barycentric coordinates l,
///
///     opl = sum over corners of l_j opl_m[j] - sum over edges ij of bend_m[k] l_i l_j / 2,
///
/// k the corner opposite to the edge.
struct TriangleLanes {
    static constexpr std::size_t kSize = 64;
    using Lanes = std::array<double, kSize>;

    alignas(64) std::array<Lanes, 3> opl_m;   ///< at the corners
    alignas(64) std::array<Lanes, 3> bend_m;  ///< at least 0: 4 (two ends - twice the middle)
    alignas(64) std::array<Lanes, 3> weight;  ///< 0 at all corners: the lane adds nothing
    alignas(64) Lanes area_m2;
};

/// Adds the histograms of the first lanes: every bin receives area times the mean over the triangle
/// of weight * [length in bin], exactly without bend, else to first order in it. What lies outside
/// the axis is left out. Where a bin's edge falls into a triangle whose bend is not small against
/// what its lengths span, its quarters are added instead, down to 256ths. No weight is lost, and no
/// bin receives less than 0.
///
/// lanes       overwritten: corners are sorted by length, which become positions in bins
/// count       of lanes that are used; what the others hold is ignored
/// histogram   axis.num_bins values
/// source      the linear case s -> 0 of the divided-difference form in [deBoor1978]; derived in
///             triangle_histogram.cpp
void add_triangles(TriangleLanes& lanes,
                   std::size_t count,
                   const core::TimeAxis& axis,
                   std::span<double> histogram);

/// The bins that a triangle of unit area reaches, and their derivatives by its knots.
struct TriangleBins {
    /// Value; derivatives by the three lengths, by the three weights, and by the logarithm of the
    /// response's width.
    static constexpr std::size_t kSlots = 8;
    struct Bin {
        std::array<double, kSlots> slots;
    };

    int first_bin = 0;
    std::vector<Bin> bins;
};

/// Whether derivatives are wanted.
enum class Gradients { Without, With };

/// The histogram of a triangle without bend, as add_triangles() gives it, seen through a Gaussian
/// response, in closed form.
///
/// sigma_m   standard deviation of the response in path length [m]; 0: none
/// gradients without them only slot 0 of each bin is set
/// bins      overwritten; memory is kept from call to call
/// source    [deBoor1978]; derived in triangle_splines.h
void evaluate_triangle(const TriangleKnots& knots,
                       double sigma_m,
                       const core::TimeAxis& axis,
                       Gradients gradients,
                       TriangleBins& bins);

}  // namespace renderer
