// SPDX-License-Identifier: MIT
#include "renderer/core/triangle_histogram.h"

#include "renderer/core/triangle_splines.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace core {
namespace {

constexpr double kThird = 1.0 / 3.0;
constexpr double kSixth = 1.0 / 6.0;
// The mean of bent positions lies below that of linear ones by this times the sum of the bends.
constexpr double kSag = 1.0 / 24.0;

// By values: with std::max, compilers choose between addresses instead.
double larger_of(double a, double b) {
    return a < b ? b : a;
}

// Triangles side by side, a vector unit's worth, with corners sorted by position along the axis;
// positions in any unit.
//
// Let p0 <= p1 <= p2 and K0, K1, K2 be positions and weights. The level set p = e cuts the edge 0-2
// at the fraction b = (e-p0)/(p2-p0) and, for e < p1, the edge 0-1 at a = (e-p0)/(p1-p0). The part
// below e is the triangle (corner 0, those two cuts), a share a*b of the area, and the mean of a
// linear weight over a triangle is the mean of its corner values:
//
//     C(e) = a b [K0 + x/3],   x = a (K1-K0) + b (K2-K0),        e <= p1
//
// and the same seen from corner 2 for e >= p1, subtracted from the mean (K0+K1+K2)/3. All factors
// are ratios in [0, 1]: nothing cancels, however small the triangle is.
//
// Where positions bend away from linear ones by q, C(e) changes to first order by minus the
// integral of K q over the cut. Per unit of e the cut is dC/de = 2 a / (p2-p0) of the area for
// K = 1, its mean weight K0 + x/2, and with q = -(c2 l0 l1 + c1 l0 l2 + c0 l1 l2)/2, its mean over
// the segment between the two cuts is
//
//     q = -[c2 a (3-2a-b) + c1 b (3-2b-a) + c0 a b]/12.
//
// p are the linear positions with the true mean, shifted by -(c0+c1+c2)/24, and q the rest. Where
// a triangle bends more than it rises, this is too much of a correction, and 1/(p2-p0) is held at
// 1/c.
class SortedTriangles {
 public:
    static constexpr std::size_t kSize = 8;
    static_assert(TriangleLanes::kSize % kSize == 0);

    // Lanes [begin, begin + kSize) after sort_corners().
    SortedTriangles(const TriangleLanes& lanes, std::size_t begin) {
        for (std::size_t i = 0; i < kSize; ++i) {
            p0_[i] = lanes.opl_m[0][begin + i];
            p1_[i] = lanes.opl_m[1][begin + i];
            p2_[i] = lanes.opl_m[2][begin + i];
            k0_[i] = lanes.weight[0][begin + i];
            k1_[i] = lanes.weight[1][begin + i];
            k2_[i] = lanes.weight[2][begin + i];
            const double c0 = lanes.bend_m[0][begin + i];
            const double c1 = lanes.bend_m[1][begin + i];
            const double c2 = lanes.bend_m[2][begin + i];
            mean_[i] = (k0_[i] + k1_[i] + k2_[i]) * kThird;
            per_01_[i] = 1.0 / (p1_[i] - p0_[i]);
            per_02_[i] = 1.0 / (p2_[i] - p0_[i]);
            per_12_[i] = 1.0 / (p2_[i] - p1_[i]);
            const double most = larger_of(c0, larger_of(c1, larger_of(c2, 1e-300)));
            const double held = most * per_02_[i] > 1.0 ? 1.0 / most : per_02_[i];
            c0_[i] = c0 * kSixth * held;
            c1_[i] = c1 * kSixth * held;
            c2_[i] = c2 * kSixth * held;
        }
    }

    double least(std::size_t i) const { return p0_[i]; }
    double most(std::size_t i) const { return p2_[i]; }
    double mean(std::size_t i) const { return mean_[i]; }

    // C(e). Everything is loaded before anything is selected, so that compilers need no branches;
    // what an infinite reciprocal spoils is not selected.
    double below(std::size_t i, double e) const {
        const double from_low = e - p0_[i];
        const double to_high = p2_[i] - e;
        const double low_k = k0_[i];
        const double high_k = k2_[i];
        const double per_low = per_01_[i];
        const double per_high = per_12_[i];
        const double c0 = c0_[i];
        const double c2 = c2_[i];
        const double mean = mean_[i];
        const bool low = e < p1_[i];
        const double reach = low ? from_low : to_high;
        const double near = low ? low_k : high_k;
        const double far = low ? high_k : low_k;
        const double a = reach * (low ? per_low : per_high);
        const double b = reach * per_02_[i];
        const double x = a * (k1_[i] - near) + b * (far - near);
        const double c_a = low ? c2 : c0;
        const double c_b = c1_[i];
        const double sum = c0 + c1_[i] + c2;
        // -2 q / (p2-p0)
        const double bent = a * c_a * (3.0 - 2.0 * a) + b * c_b * (3.0 - 2.0 * b) +
                            a * b * (sum - 2.0 * (c_a + c_b)) - 0.5 * sum;
        const double gained = bent * (near + 0.5 * x);
        const double part = a * (b * (near + x * kThird) + (low ? gained : -gained));
        const double at_least_0 = part > 0.0 ? part : 0.0;
        const double within = at_least_0 < mean ? at_least_0 : mean;
        const double inside = low ? within : mean - within;
        const double up_to_high = to_high > 0.0 ? inside : mean;
        return from_low > 0.0 ? up_to_high : 0.0;
    }

 private:
    using Lanes = std::array<double, kSize>;
    alignas(64) Lanes p0_, p1_, p2_, k0_, k1_, k2_, mean_, per_01_, per_02_, per_12_;
    alignas(64) Lanes c0_, c1_, c2_;  // bends / 6 (p2-p0)
};

struct Corner {
    double p, k, c;
};

// By values and without branches: neither is the likely order.
void order(Corner& a, Corner& b) {
    const Corner first = a;
    const bool swap = b.p < first.p;
    a = {swap ? b.p : first.p, swap ? b.k : first.k, swap ? b.c : first.c};
    b = {swap ? first.p : b.p, swap ? first.k : b.k, swap ? first.c : b.c};
}

// Turns lengths into positions in bins, shifts them to the mean of the bent ones, and sorts corners
// by them. One loop that loads and stores each corner once: in place and pair by pair, compilers
// store with masks, which some processors do slowly.
void sort_corners(TriangleLanes& lanes, std::size_t count, double start_m, double bins_per_m) {
    for (std::size_t i = 0; i < count; ++i) {
        Corner a{lanes.opl_m[0][i], lanes.weight[0][i], lanes.bend_m[0][i] * bins_per_m};
        Corner b{lanes.opl_m[1][i], lanes.weight[1][i], lanes.bend_m[1][i] * bins_per_m};
        Corner c{lanes.opl_m[2][i], lanes.weight[2][i], lanes.bend_m[2][i] * bins_per_m};
        const double sag = (a.c + b.c + c.c) * kSag;
        a.p = (a.p - start_m) * bins_per_m - sag;
        b.p = (b.p - start_m) * bins_per_m - sag;
        c.p = (c.p - start_m) * bins_per_m - sag;
        order(a, b);
        order(b, c);
        order(a, b);
        lanes.opl_m[0][i] = a.p;
        lanes.opl_m[1][i] = b.p;
        lanes.opl_m[2][i] = c.p;
        lanes.weight[0][i] = a.k;
        lanes.weight[1][i] = b.k;
        lanes.weight[2][i] = c.k;
        lanes.bend_m[0][i] = a.c;
        lanes.bend_m[1][i] = b.c;
        lanes.bend_m[2][i] = c.c;
    }
}

// A triangle in all lanes of the first unit.
TriangleLanes repeated(const TriangleKnots& knots) {
    TriangleLanes lanes;
    for (std::size_t j = 0; j < 3; ++j) {
        std::fill_n(lanes.opl_m[j].begin(), SortedTriangles::kSize, knots.opl_m[j]);
        std::fill_n(lanes.bend_m[j].begin(), SortedTriangles::kSize, 0.0);
        std::fill_n(lanes.weight[j].begin(), SortedTriangles::kSize, knots.weight[j]);
    }
    return lanes;
}

// Adds the first `count` of the triangles, whose corners lie at positions in bins.
void add_sorted(const SortedTriangles& triangles,
                const double* area_m2,
                std::size_t count,
                std::span<double> histogram) {
    constexpr std::size_t kSize = SortedTriangles::kSize;
    const auto num_bins = static_cast<double>(histogram.size());
    alignas(64) std::array<double, kSize> edge;
    alignas(64) std::array<double, kSize> below{};
    alignas(64) std::array<double, kSize> whole;
    alignas(64) std::array<double, kSize> added;
    alignas(64) std::array<double, kSize> reached;
    alignas(64) std::array<double, kSize> outside;
    for (std::size_t i = 0; i < kSize; ++i) {
        const double low = triangles.least(i);
        const double high = triangles.most(i);
        const double begin = std::floor(low > 0.0 ? low : 0.0);
        const double last = std::floor(high < num_bins ? high : num_bins - 1.0);
        edge[i] = begin;
        whole[i] = triangles.mean(i);
        // Below 1 where nothing lies on the axis.
        const double bins = last - begin + 1.0;
        reached[i] = triangles.mean(i) == 0.0 ? 0.0 : bins;
        outside[i] = larger_of(-low, high - num_bins);
    }
    double most = 0.0;
    double most_outside = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        most = std::max(most, reached[i]);
        most_outside = std::max(most_outside, outside[i]);
    }
    if (most_outside > 0.0) {
        for (std::size_t i = 0; i < kSize; ++i) {
            below[i] = triangles.below(i, 0.0);
            whole[i] = triangles.below(i, num_bins);
        }
    }
    for (double bin = 0.0; bin < most; bin += 1.0) {
        const bool is_last = bin + 1.0 == most;
        for (std::size_t i = 0; i < kSize; ++i) {
            const double next = is_last ? whole[i] : triangles.below(i, edge[i] + 1.0);
            const double rising = larger_of(below[i], next);
            added[i] = rising - below[i];
            below[i] = rising;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (!(bin < reached[i])) continue;  // nor where a number is none
            histogram[static_cast<std::size_t>(edge[i])] += area_m2[i] * added[i];
        }
        for (double& e : edge) e += 1.0;
    }
}

// Triangles that bend more than this times what they rise are split where a bin's edge falls into
// them, ...
constexpr double kMostBend = 0.5;
// ... unless they bend by a negligible part of a bin ...
constexpr double kNegligibleBend = 1e-3;
// ... or have been split this often.
constexpr int kMostSplits = 4;

// Which of the sorted triangles are to be split.
std::uint64_t bent_lanes(const TriangleLanes& lanes, std::size_t count, double num_bins) {
    alignas(64) TriangleLanes::Lanes is_bent;
    for (std::size_t i = 0; i < count; ++i) {
        const double low = lanes.opl_m[0][i];
        const double high = lanes.opl_m[2][i];
        const double most =
            larger_of(lanes.bend_m[0][i], larger_of(lanes.bend_m[1][i], lanes.bend_m[2][i]));
        // Bent positions lie at most a sixth of this below the linear ones through the corners,
        // from which those here are shifted down by at most an eighth of it.
        const auto bin_of = [num_bins](double p) {
            const double from_start = larger_of(p, -1.0);
            return std::floor(from_start < num_bins ? from_start : num_bins);
        };
        const double weight = lanes.weight[0][i] + lanes.weight[1][i] + lanes.weight[2][i];
        const double crossed = bin_of(high + most / 8.0) - bin_of(low - most / 6.0);
        const double threshold = larger_of(kNegligibleBend, kMostBend * (high - low));
        is_bent[i] = weight > 0.0 && most > threshold ? crossed : 0.0;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < count; ++i) bits |= std::uint64_t{is_bent[i] > 0.0} << i;
    return bits;
}

// Sets lanes [begin, begin + 4) of `parts` to the quarters of a sorted triangle.
void quarter(const TriangleLanes& lanes, std::size_t i, TriangleLanes& parts, std::size_t begin) {
    const auto& c = lanes.bend_m;
    const double sag = (c[0][i] + c[1][i] + c[2][i]) * kSag;
    std::array<double, 3> p, k, middle_p, middle_k;
    for (std::size_t j = 0; j < 3; ++j) {
        p[j] = lanes.opl_m[j][i] + sag;
        k[j] = lanes.weight[j][i];
    }
    for (std::size_t j = 0; j < 3; ++j) {  // of the edge opposite to corner j
        middle_p[j] = 0.5 * (p[(j + 1) % 3] + p[(j + 2) % 3]) - c[j][i] / 8.0;
        middle_k[j] = 0.5 * (k[(j + 1) % 3] + k[(j + 2) % 3]);
    }
    for (std::size_t part = 0; part < 4; ++part) {
        for (std::size_t j = 0; j < 3; ++j) {
            // Corner j of the part that keeps corner `part` lies there or opposite to the third
            // corner; the fourth part joins the middles.
            const std::size_t opposite = part == 3 ? j : 3 - part - j;
            const bool is_corner = part == j;
            parts.opl_m[j][begin + part] = is_corner ? p[j] : middle_p[opposite];
            parts.weight[j][begin + part] = is_corner ? k[j] : middle_k[opposite];
            parts.bend_m[j][begin + part] = 0.25 * c[j][i];
        }
    }
}

// Adds triangles whose lengths start at start_m; those that bend too much as their quarters.
void add_lanes(TriangleLanes& lanes,
               std::span<const double> area_m2,
               double start_m,
               double bins_per_m,
               int num_splits,
               std::span<double> histogram) {
    const std::size_t count = area_m2.size();
    sort_corners(lanes, count, start_m, bins_per_m);
    std::uint64_t bent = num_splits == kMostSplits
                             ? 0
                             : bent_lanes(lanes, count, static_cast<double>(histogram.size()));
    while (bent != 0) {
        TriangleLanes parts;
        TriangleLanes::Lanes part_area_m2;
        std::size_t num_parts = 0;
        for (; bent != 0 && num_parts < TriangleLanes::kSize; bent &= bent - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(bent));
            quarter(lanes, i, parts, num_parts);
            std::fill_n(part_area_m2.begin() + static_cast<std::ptrdiff_t>(num_parts),
                        4,
                        0.25 * area_m2[i]);
            num_parts += 4;
            for (TriangleLanes::Lanes& weight : lanes.weight) weight[i] = 0.0;
        }
        add_lanes(parts, {part_area_m2.data(), num_parts}, 0.0, 1.0, num_splits + 1, histogram);
    }
    for (std::size_t begin = 0; begin < count; begin += SortedTriangles::kSize) {
        add_sorted(SortedTriangles(lanes, begin),
                   area_m2.data() + begin,
                   std::min(count - begin, SortedTriangles::kSize),
                   histogram);
    }
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
    TriangleLanes lanes = repeated(knots);
    sort_corners(lanes, SortedTriangles::kSize, 0.0, 1.0);
    return SortedTriangles(lanes, 0).below(0, opl_m);
}

void add_triangles(TriangleLanes& lanes,
                   std::span<const double> area_m2,
                   const TimeAxis& axis,
                   std::span<double> histogram) {
    add_lanes(lanes, area_m2, axis.opl_start_m, 1.0 / axis.bin_width_m, 0, histogram);
}

void add_triangle(const TriangleKnots& knots,
                  double area_m2,
                  const TimeAxis& axis,
                  std::span<double> histogram) {
    TriangleLanes lanes = repeated(knots);
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
