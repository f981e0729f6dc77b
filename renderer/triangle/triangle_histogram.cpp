// SPDX-License-Identifier: MIT
#include "renderer/triangle/triangle_histogram.h"

#include "renderer/triangle/sorted_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace renderer {
namespace {

using core::load;
using core::Simd;
using core::SimdMask;
using core::TimeAxis;

constexpr std::size_t kSimdWidth = Simd::size();
static_assert(TriangleLanes::kSize % kSimdWidth == 0);

constexpr double kSixth = 1.0 / 6.0;
// The mean of bent positions lies below that of linear ones by this times the sum of the bends.
constexpr double kSag = 1.0 / 24.0;

struct Corner {
    Simd p, k, c;
};

[[gnu::always_inline]] inline void order(Corner& a, Corner& b) {
    const Corner first = a;
    const SimdMask swap = b.p < first.p;
    a = {select(swap, b.p, first.p), select(swap, b.k, first.k), select(swap, b.c, first.c)};
    b = {select(swap, first.p, b.p), select(swap, first.k, b.k), select(swap, first.c, b.c)};
}

// Turns lengths into positions in bins, shifts them to the mean of the bent ones, and sorts corners
// by them.
void sort_corners(TriangleLanes& lanes, std::size_t count, double start_m, double bins_per_m) {
    for (std::size_t begin = 0; begin < count; begin += kSimdWidth) {
        std::array<Corner, 3> corners;
        for (std::size_t j = 0; j < 3; ++j) {
            corners[j] = {load(lanes.opl_m[j], begin),
                          load(lanes.weight[j], begin),
                          load(lanes.bend_m[j], begin) * bins_per_m};
        }
        const Simd sag = (corners[0].c + corners[1].c + corners[2].c) * kSag;
        for (Corner& corner : corners) corner.p = (corner.p - start_m) * bins_per_m - sag;
        order(corners[0], corners[1]);
        order(corners[1], corners[2]);
        order(corners[0], corners[1]);
        for (std::size_t j = 0; j < 3; ++j) {
            store(corners[j].p, lanes.opl_m[j], begin);
            store(corners[j].k, lanes.weight[j], begin);
            store(corners[j].c, lanes.bend_m[j], begin);
        }
    }
}

// Adds a SIMD group of triangles, whose corners lie at positions in bins, bin by bin.
[[gnu::always_inline]] inline void add_together(const SortedTriangles& triangles,
                                                std::span<double> histogram) {
    const auto num_bins = static_cast<double>(histogram.size());
    const double low = triangles.lowest(num_bins);
    const double high = triangles.highest(-1.0);
    const double first = std::floor(std::max(low, 0.0));
    const double last = std::floor(std::min(high, num_bins - 1.0));
    Simd below = low < first ? triangles.below(first) : Simd(0.0);
    const auto add = [&](double bin, const Simd& next) {
        const Simd rising = max(below, next);
        histogram[static_cast<std::size_t>(bin)] += sum_of(rising - below);
        below = rising;
    };
    for (double bin = first; bin < last; bin += 1.0) add(bin, triangles.below(bin + 1.0));
    if (first <= last) add(last, high < num_bins ? triangles.whole() : triangles.below(num_bins));
}

// Triangles that together span more bins than kFewBins, and more than kMaxScatter times as many as
// the longest one, are added one by one.
constexpr double kFewBins = 16.0;
constexpr double kMaxScatter = 4.0;

void add_sorted(const SortedTriangles& triangles, std::span<double> histogram) {
    const auto num_bins = static_cast<double>(histogram.size());
    const double reached = triangles.highest(-1.0) - triangles.lowest(num_bins);
    if (reached > kFewBins && reached > kMaxScatter * triangles.longest()) {
        for (std::size_t i = 0; i < kSimdWidth; ++i) add_together(triangles.only(i), histogram);
        return;
    }
    add_together(triangles, histogram);
}

// Triangles that bend more than this times what they rise are split where a bin's edge falls into
// them, ...
constexpr double kMaxBend = 0.5;
// ... unless they bend by a negligible part of a bin ...
constexpr double kNegligibleBend = 1e-3;
// ... or have been split this often.
constexpr int kMaxSplits = 4;

// Which of the sorted triangles are to be split.
std::uint64_t bent_lanes(const TriangleLanes& lanes, std::size_t count, double num_bins) {
    std::uint64_t bits = 0;
    for (std::size_t begin = 0; begin < count; begin += kSimdWidth) {
        const Simd low = load(lanes.opl_m[0], begin);
        const Simd high = load(lanes.opl_m[2], begin);
        const Simd most = max(max(load(lanes.bend_m[0], begin), load(lanes.bend_m[1], begin)),
                              load(lanes.bend_m[2], begin));
        // Bent positions lie at most a sixth of this below the linear ones through the corners,
        // from which those here are shifted down by at most an eighth of it.
        const auto bin_of = [num_bins](const Simd& p) {
            return floor(min(max(p, -1.0), num_bins));
        };
        const Simd weight = load(lanes.weight[0], begin) + load(lanes.weight[1], begin) +
                            load(lanes.weight[2], begin);
        const SimdMask is_split = (0.0 < weight) &
                                  (max(kNegligibleBend, kMaxBend * (high - low)) < most) &
                                  (bin_of(low - most * kSixth) < bin_of(high + most * 0.125));
        bits |= is_split.bits() << begin;
    }
    return bits;
}

// Numbers for the corners of the four quarters of a triangle, twice: lane 4t + part.
struct QuarterCorner {
    alignas(
        64) std::array<std::array<double, kSimdWidth>, 3> of_corner;  ///< barycentric coordinates
    alignas(64) std::array<std::array<double, kSimdWidth>, 3> of_bend;
};

// Corner j of the part that keeps corner `part` lies there or in the middle of the edge opposite to
// the third corner; the fourth part joins the middles.
constexpr std::array<QuarterCorner, 3> quarter_corners() {
    std::array<QuarterCorner, 3> corners{};
    for (std::size_t lane = 0; lane < kSimdWidth; ++lane) {
        const std::size_t part = lane % 4;
        for (std::size_t j = 0; j < 3; ++j) {
            if (part == j) {
                corners[j].of_corner[j][lane] = 1.0;
                continue;
            }
            const std::size_t opposite = part == 3 ? j : 3 - part - j;
            corners[j].of_corner[(opposite + 1) % 3][lane] = 0.5;
            corners[j].of_corner[(opposite + 2) % 3][lane] = 0.5;
            corners[j].of_bend[opposite][lane] = -0.125;
        }
    }
    return corners;
}

constexpr std::array<QuarterCorner, 3> kQuarterCorners = quarter_corners();

// 1 in the lanes of the second triangle.
alignas(64) constexpr std::array<double, kSimdWidth> kSecond{0, 0, 0, 0, 1, 1, 1, 1};

// Sets the SIMD group of `parts` at `begin` to the quarters of two sorted triangles.
void quarter(const TriangleLanes& lanes,
             std::size_t first,
             std::size_t second,
             TriangleLanes& parts,
             std::size_t begin) {
    const SimdMask is_first = load(kSecond, 0) < 0.5;
    const auto both = [&](const TriangleLanes::Lanes& values) {
        return select(is_first, values[first], values[second]);
    };
    std::array<Simd, 3> p, k, c;
    for (std::size_t j = 0; j < 3; ++j) {
        p[j] = both(lanes.opl_m[j]);
        k[j] = both(lanes.weight[j]);
        c[j] = both(lanes.bend_m[j]);
    }
    const Simd sag = (c[0] + c[1] + c[2]) * kSag;
    for (std::size_t j = 0; j < 3; ++j) {
        const QuarterCorner& corner = kQuarterCorners[j];
        Simd position = sag;
        Simd weight = 0.0;
        for (std::size_t m = 0; m < 3; ++m) {
            const Simd fraction = load(corner.of_corner[m], 0);
            position += fraction * p[m] + load(corner.of_bend[m], 0) * c[m];
            weight += fraction * k[m];
        }
        store(position, parts.opl_m[j], begin);
        store(weight, parts.weight[j], begin);
        store(0.25 * c[j], parts.bend_m[j], begin);
    }
    store(0.25 * both(lanes.area_m2), parts.area_m2, begin);
}

// Returns the index of the lowest set bit and clears it.
std::size_t take_lowest(std::uint64_t& bits) {
    const auto lowest = static_cast<std::size_t>(std::countr_zero(bits));
    bits &= bits - 1;
    return lowest;
}

// Adds triangles whose lengths start at start_m; those that bend too much as their quarters.
void add_lanes(TriangleLanes& lanes,
               std::size_t count,
               double start_m,
               double bins_per_m,
               int num_splits,
               std::span<double> histogram) {
    for (; count % kSimdWidth != 0; ++count) {
        lanes.area_m2[count] = 0.0;
        for (auto* values : {&lanes.opl_m, &lanes.bend_m, &lanes.weight}) {
            for (TriangleLanes::Lanes& of_corner : *values) of_corner[count] = 0.0;
        }
    }
    sort_corners(lanes, count, start_m, bins_per_m);
    std::uint64_t bent = num_splits == kMaxSplits
                             ? 0
                             : bent_lanes(lanes, count, static_cast<double>(histogram.size()));
    while (bent != 0) {
        TriangleLanes parts;
        std::size_t num_parts = 0;
        while (bent != 0 && num_parts < TriangleLanes::kSize) {
            const std::size_t first = take_lowest(bent);
            const std::size_t second = bent != 0 ? take_lowest(bent) : first;
            quarter(lanes, first, second, parts, num_parts);
            num_parts += first == second ? 4 : kSimdWidth;
            for (TriangleLanes::Lanes& weight : lanes.weight) {
                weight[first] = 0.0;
                weight[second] = 0.0;
            }
        }
        add_lanes(parts, num_parts, 0.0, 1.0, num_splits + 1, histogram);
    }
    for (std::size_t begin = 0; begin < count; begin += kSimdWidth) {
        add_sorted(SortedTriangles(lanes, begin), histogram);
    }
}

}  // namespace

double triangle_cumulative(const TriangleKnots& knots, double opl_m) {
    TriangleLanes lanes;
    lanes.area_m2[0] = 1.0;
    for (std::size_t j = 0; j < 3; ++j) {
        lanes.opl_m[j][0] = knots.opl_m[j];
        lanes.bend_m[j][0] = 0.0;
        lanes.weight[j][0] = knots.weight[j];
    }
    sort_corners(lanes, 1, 0.0, 1.0);
    return SortedTriangles(lanes, 0).below(opl_m)[0];
}

void add_triangles(TriangleLanes& lanes,
                   std::size_t count,
                   const TimeAxis& axis,
                   std::span<double> histogram) {
    add_lanes(lanes, count, axis.opl_start_m, 1.0 / axis.bin_width_m, 0, histogram);
}

}  // namespace renderer
