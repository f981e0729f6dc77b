// SPDX-License-Identifier: MIT
#include "renderer/core/triangle_histogram.h"

#include "renderer/core/triangle_splines.h"

#include <algorithm>
#include <cmath>

namespace core {
namespace {

constexpr double kThird = 1.0 / 3.0;

// Corners sorted by position along the axis; positions in any unit.
//
// Let p0 <= p1 <= p2 and K0, K1, K2 be positions and weights. The level set p = e cuts the edge 0-2
// at the fraction b = (e-p0)/(p2-p0) and, for e < p1, the edge 0-1 at a = (e-p0)/(p1-p0). The part
// below e is the triangle (corner 0, those two cuts), a share a*b of the area, and the mean of a
// linear weight over a triangle is the mean of its corner values:
//
//     C(e) = a b [K0 + (a (K1-K0) + b (K2-K0))/3],        e <= p1
//
// and the same seen from corner 2 for e >= p1, subtracted from the mean (K0+K1+K2)/3. All factors
// are ratios in [0, 1]: nothing cancels, however small the triangle is.
struct SortedTriangle {
    double p0, p1, p2;
    double k0, k1, k2;

    double mean() const { return (k0 + k1 + k2) * kThird; }
};

class Cumulative {
 public:
    explicit Cumulative(const SortedTriangle& triangle)
        : t_(triangle),
          per_01_(1.0 / (t_.p1 - t_.p0)),
          per_02_(1.0 / (t_.p2 - t_.p0)),
          per_12_(1.0 / (t_.p2 - t_.p1)) {}

    // For p0 < e < p2.
    double below(double e) const {
        if (e < t_.p1) {
            const double a = (e - t_.p0) * per_01_;
            const double b = (e - t_.p0) * per_02_;
            return a * b * (t_.k0 + (a * (t_.k1 - t_.k0) + b * (t_.k2 - t_.k0)) * kThird);
        }
        const double a = (t_.p2 - e) * per_12_;
        const double b = (t_.p2 - e) * per_02_;
        return t_.mean() - a * b * (t_.k2 + (a * (t_.k1 - t_.k2) + b * (t_.k0 - t_.k2)) * kThird);
    }

 private:
    SortedTriangle t_;
    double per_01_, per_02_, per_12_;  // reciprocal lengths; infinite ones are never used
};

struct Corner {
    double p, k;
};

// By values and without branches: neither is the likely order.
void order(Corner& a, Corner& b) {
    const Corner first = a;
    const bool swap = b.p < first.p;
    a = {swap ? b.p : first.p, swap ? b.k : first.k};
    b = {swap ? first.p : b.p, swap ? first.k : b.k};
}

// One loop that loads and stores each corner once: in place and pair by pair, compilers store with
// masks, which some processors do slowly.
void sort_corners(TriangleLanes& lanes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
        Corner a{lanes.opl_m[0][i], lanes.weight[0][i]};
        Corner b{lanes.opl_m[1][i], lanes.weight[1][i]};
        Corner c{lanes.opl_m[2][i], lanes.weight[2][i]};
        order(a, b);
        order(b, c);
        order(a, b);
        lanes.opl_m[0][i] = a.p;
        lanes.opl_m[1][i] = b.p;
        lanes.opl_m[2][i] = c.p;
        lanes.weight[0][i] = a.k;
        lanes.weight[1][i] = b.k;
        lanes.weight[2][i] = c.k;
    }
}

SortedTriangle lane_of(const TriangleLanes& lanes, std::size_t i) {
    return {lanes.opl_m[0][i],
            lanes.opl_m[1][i],
            lanes.opl_m[2][i],
            lanes.weight[0][i],
            lanes.weight[1][i],
            lanes.weight[2][i]};
}

TriangleLanes one_lane(const TriangleKnots& knots) {
    TriangleLanes lanes;
    for (std::size_t j = 0; j < 3; ++j) {
        lanes.opl_m[j][0] = knots.opl_m[j];
        lanes.weight[j][0] = knots.weight[j];
    }
    return lanes;
}

// Corners at positions in bins.
void add_sorted(const SortedTriangle& triangle, double area_m2, std::span<double> histogram) {
    const auto num_bins = static_cast<double>(histogram.size());
    if (!(triangle.p2 >= 0.0) || !(triangle.p0 < num_bins)) return;

    const double mean = triangle.mean();
    const double last = std::floor(triangle.p2);
    if (triangle.p0 >= last) {
        if (last < num_bins) histogram[static_cast<std::size_t>(last)] += area_m2 * mean;
        return;
    }
    const Cumulative cumulative(triangle);
    double edge = std::max(0.0, std::floor(triangle.p0));
    double below = edge > triangle.p0 ? cumulative.below(edge) : 0.0;
    auto bin = static_cast<std::size_t>(edge);
    for (edge += 1.0; edge <= last && edge <= num_bins; edge += 1.0, ++bin) {
        const double next = edge < triangle.p2 ? cumulative.below(edge) : mean;
        histogram[bin] += area_m2 * (next - below);
        below = next;
    }
    if (last < num_bins) histogram[bin] += area_m2 * (mean - below);
}

double mean_of(const std::array<double, 3>& values) {
    return (values[0] + values[1] + values[2]) * kThird;
}

// The Gaussian response is cut off this many standard deviations away: beyond, it holds 1e-11.
constexpr double kReach = 6.8;

using Slots = std::array<double, TriangleBins::kSlots>;

// The cumulative histogram and its slopes from the splines, edge_m from the first knot; the mean
// over a triangle is twice the integral over the barycentric coordinates.
Slots cumulative_of(const TriangleSplines<double>::Values& values,
                    const TriangleKnots& knots,
                    double edge_m,
                    double per_m,
                    Slopes slopes) {
    Slots cumulative{};
    for (std::size_t j = 0; j < 3; ++j) {
        cumulative[0] += 2.0 * values.share[j] * knots.weight[j];
    }
    if (slopes == Slopes::Without) return cumulative;
    const auto& s = values.slope;
    const auto& k = knots.weight;
    cumulative[1] = 2.0 * per_m * (2.0 * s[0] * k[0] + s[1] * k[1] + s[2] * k[2]);
    cumulative[2] = 2.0 * per_m * (s[1] * k[0] + 2.0 * s[3] * k[1] + s[4] * k[2]);
    cumulative[3] = 2.0 * per_m * (s[2] * k[0] + s[4] * k[1] + 2.0 * s[5] * k[2]);
    for (std::size_t j = 0; j < 3; ++j) {
        cumulative[4 + j] = 2.0 * values.share[j];
        // Shares depend on (edge, knots) / sigma only, and on differences of these.
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

double triangle_cumulative(const TriangleKnots& knots, double opl_m) {
    TriangleLanes lanes = one_lane(knots);
    sort_corners(lanes, 1);
    const SortedTriangle triangle = lane_of(lanes, 0);
    if (opl_m <= triangle.p0) return 0.0;
    return opl_m < triangle.p2 ? Cumulative(triangle).below(opl_m) : triangle.mean();
}

void add_triangles(TriangleLanes& lanes,
                   std::span<const double> area_m2,
                   const TimeAxis& axis,
                   std::span<double> histogram) {
    const std::size_t count = area_m2.size();
    const double per_m = 1.0 / axis.bin_width_m;
    for (TriangleLanes::Lanes& lane : lanes.opl_m) {
        for (std::size_t i = 0; i < count; ++i) lane[i] = (lane[i] - axis.opl_start_m) * per_m;
    }
    sort_corners(lanes, count);
    for (std::size_t i = 0; i < count; ++i) {
        const SortedTriangle triangle = lane_of(lanes, i);
        if (triangle.mean() != 0.0) add_sorted(triangle, area_m2[i], histogram);
    }
}

void add_triangle(const TriangleKnots& knots,
                  double area_m2,
                  const TimeAxis& axis,
                  std::span<double> histogram) {
    TriangleLanes lanes = one_lane(knots);
    add_triangles(lanes, {&area_m2, 1}, axis, histogram);
}

void evaluate_triangle(const TriangleKnots& knots,
                       double sigma_m,
                       const TimeAxis& axis,
                       Slopes slopes,
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
        if (sigma_m == 0.0 && slopes == Slopes::Without) {
            return Slots{triangle_cumulative(knots, axis.bin_begin_m(edge))};
        }
        const double edge_m = axis.bin_begin_m(edge) - knots.opl_m[0];
        splines.evaluate(edge_m * per_m, slopes == Slopes::With, values);
        return cumulative_of(values, knots, edge_m, per_m, slopes);
    };
    Slots below = cumulative_at(bins.first_bin);
    for (int bin = bins.first_bin; bin <= last_bin; ++bin) {
        const Slots next = cumulative_at(bin + 1);
        TriangleBins::Bin& target = bins.bins.emplace_back();
        for (std::size_t i = 0; i < below.size(); ++i) target.slots[i] = next[i] - below[i];
        below = next;
    }
}

}  // namespace core
