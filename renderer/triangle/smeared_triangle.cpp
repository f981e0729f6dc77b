// SPDX-License-Identifier: MIT
// A single triangle: its knots, and its histogram through a Gaussian response.
#include "renderer/triangle/triangle_histogram.h"
#include "renderer/triangle/triangle_splines.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::TimeAxis;

double mean_of(const std::array<double, 3>& values) {
    return (values[0] + values[1] + values[2]) * (1.0 / 3.0);
}

// The Gaussian response is cut off this many standard deviations away: beyond, it holds 1e-11.
constexpr double kReach = 6.8;

using Slots = std::array<double, TriangleBins::kSlots>;

// The cumulative histogram and its gradients from the splines, edge_m from the first knot; the mean
// over a triangle is twice the integral over the barycentric coordinates.
Slots cumulative_of(const TriangleSplines<double>::Values& values,
                    const TriangleKnots& knots,
                    double edge_m,
                    double per_m,
                    Gradients gradients) {
    Slots cumulative{};
    for (std::size_t j = 0; j < 3; ++j) {
        cumulative[0] += 2.0 * values.fraction[j] * knots.weight[j];
    }
    if (gradients == Gradients::Without) return cumulative;
    const auto& s = values.gradient;
    const auto& k = knots.weight;
    cumulative[1] = 2.0 * per_m * (2.0 * s[0] * k[0] + s[1] * k[1] + s[2] * k[2]);
    cumulative[2] = 2.0 * per_m * (s[1] * k[0] + 2.0 * s[3] * k[1] + s[4] * k[2]);
    cumulative[3] = 2.0 * per_m * (s[2] * k[0] + s[4] * k[1] + 2.0 * s[5] * k[2]);
    for (std::size_t j = 0; j < 3; ++j) {
        cumulative[4 + j] = 2.0 * values.fraction[j];
        // Fractions depend on (edge, knots) / sigma only, and on differences of these.
        cumulative[7] += (edge_m - (knots.opl_m[j] - knots.opl_m[0])) * cumulative[1 + j];
    }
    return cumulative;
}

// What is reached once the whole triangle lies below the edge.
Slots whole_triangle(const TriangleKnots& knots) {
    return {mean_of(knots.weight), 0.0, 0.0, 0.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 0.0};
}

}  // namespace

TriangleKnots match_midpoints(const TriangleKnots& at_corners, const TriangleKnots& at_midpoints) {
    TriangleKnots knots = at_corners;
    const double shift = mean_of(at_midpoints.opl_m) - mean_of(at_corners.opl_m);
    for (double& opl : knots.opl_m) opl += shift;

    const double mean = mean_of(at_midpoints.weight);
    const double corner_mean = mean_of(at_corners.weight);
    const double lowest = *std::min_element(knots.weight.begin(), knots.weight.end()) - corner_mean;
    const double spread = lowest < -mean ? mean / -lowest : 1.0;
    for (double& weight : knots.weight) weight = mean + spread * (weight - corner_mean);
    return knots;
}

void evaluate_triangle(const TriangleKnots& knots,
                       double sigma_m,
                       const TimeAxis& axis,
                       Gradients gradients,
                       TriangleBins& bins) {
    const auto [least, most] = std::minmax_element(knots.opl_m.begin(), knots.opl_m.end());
    const double reach = kReach * sigma_m;
    const double begin = (*least - reach - axis.opl_start_m) / axis.bin_width_m;
    const double end = (*most + reach - axis.opl_start_m) / axis.bin_width_m;
    bins.bins.clear();
    bins.first_bin = 0;
    if (!(end > 0.0) || !(begin < axis.num_bins)) return;
    bins.first_bin = static_cast<int>(std::max(0.0, std::floor(begin)));
    const int last_bin = static_cast<int>(std::min(axis.num_bins - 1.0, std::floor(end)));

    const double per_m = 1.0 / (sigma_m > 0.0 ? sigma_m : axis.bin_width_m);
    const TriangleSplines<double> splines(
        {0.0, (knots.opl_m[1] - knots.opl_m[0]) * per_m, (knots.opl_m[2] - knots.opl_m[0]) * per_m},
        sigma_m > 0.0 ? Smear::Gaussian : Smear::None);
    TriangleSplines<double>::Values values;
    const auto cumulative_at = [&](int edge) {
        if (edge <= begin) return Slots{};
        if (edge >= end) return whole_triangle(knots);
        if (sigma_m == 0.0 && gradients == Gradients::Without) {
            return Slots{triangle_cumulative(knots, axis.bin_begin_m(edge))};
        }
        const double edge_m = axis.bin_begin_m(edge) - knots.opl_m[0];
        splines.evaluate(edge_m * per_m, gradients == Gradients::With, values);
        return cumulative_of(values, knots, edge_m, per_m, gradients);
    };
    Slots below = cumulative_at(bins.first_bin);
    for (int bin = bins.first_bin; bin <= last_bin; ++bin) {
        const Slots next = cumulative_at(bin + 1);
        TriangleBins::Bin& target = bins.bins.emplace_back();
        for (std::size_t i = 0; i < below.size(); ++i) target.slots[i] = next[i] - below[i];
        below = next;
    }
}

}  // namespace renderer
