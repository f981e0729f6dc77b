// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/simd.h"
#include "renderer/triangle/triangle_histogram.h"

#include <array>

namespace renderer {

/// Triangles side by side with corners sorted by position along the axis; positions in any unit.
///
/// Let p0 <= p1 <= p2 and K0, K1, K2 be positions and weights. The level set p = e cuts the edge
/// 0-2 at the fraction b = (e-p0)/(p2-p0) and, for e < p1, the edge 0-1 at a = (e-p0)/(p1-p0). The
/// part below e is the triangle (corner 0, those two cuts), a fraction a*b of the area, and the
/// mean of a linear weight over a triangle is the mean of its corner values:
///
///     C(e) = a b [K0 + x/3],   x = a (K1-K0) + b (K2-K0),        e <= p1
///
/// and the same seen from corner 2 for e >= p1, subtracted from the mean (K0+K1+K2)/3.
///
/// Where positions bend away from linear ones by q, C(e) changes to first order by minus the
/// integral of K q over the cut. Per unit of e the cut is dC/de = 2 a / (p2-p0) of the area for
/// K = 1, its mean weight K0 + x/2, and with q = -(c2 l0 l1 + c1 l0 l2 + c0 l1 l2)/2, its mean over
/// the segment between the two cuts is
///
///     q = -[c2 a (3-2a-b) + c1 b (3-2b-a) + c0 a b]/12.
///
/// p are the linear positions with the true mean, shifted by -(c0+c1+c2)/24, and q the rest. Where
/// a triangle bends more than it rises, this is too much of a correction, and 1/(p2-p0) is held at
/// 1/c.
///
/// With the ratio r = b/a = (p1-p0)/(p2-p0), all this is a polynomial of a, which lies in [0, 1]
/// like r: nothing cancels, however small the triangle is.
class SortedTriangles {
    // Keeps reciprocals finite; in bins.
    static constexpr double kMinRise = 1e-100;

 public:
    // The SIMD group of lanes that starts at `begin`, after sort_corners().
    [[gnu::always_inline]] SortedTriangles(const TriangleLanes& lanes, std::size_t begin)
        : p0_(core::load(lanes.opl_m[0], begin)),
          p1_(core::load(lanes.opl_m[1], begin)),
          p2_(core::load(lanes.opl_m[2], begin)) {
        const core::Simd area = core::load(lanes.area_m2, begin);
        const core::Simd k0 = area * core::load(lanes.weight[0], begin);
        const core::Simd k1 = area * core::load(lanes.weight[1], begin);
        const core::Simd k2 = area * core::load(lanes.weight[2], begin);
        const core::Simd c0 = core::load(lanes.bend_m[0], begin);
        const core::Simd c1 = core::load(lanes.bend_m[1], begin);
        const core::Simd c2 = core::load(lanes.bend_m[2], begin);
        whole_ = (k0 + k1 + k2) * (1.0 / 3.0);
        const core::Simd rise = max(p2_ - p0_, kMinRise);
        const core::Simd per_02 = 1.0 / rise;
        const core::Simd held = (1.0 / 6.0) / max(max(rise, c0), max(c1, c2));
        const OfCorners bends{c0 * held, c1 * held, c2 * held};
        low_ = Side(p1_ - p0_, per_02, {k0, k1, k2}, bends, 1.0);
        high_ = Side(p2_ - p1_, per_02, {k2, k1, k0}, {bends[2], bends[1], bends[0]}, -1.0);
    }

    // Where the first of the triangles that weigh anything begins and the last one ends, if not
    // beyond the given limits.
    [[gnu::always_inline]] double lowest(double limit) const {
        return reduce_min(select(whole_ != 0.0, p0_, limit));
    }
    [[gnu::always_inline]] double highest(double limit) const {
        return reduce_max(select(whole_ != 0.0, p2_, limit));
    }
    /// What the longest one spans.
    [[gnu::always_inline]] double longest() const {
        return reduce_max(select(whole_ != 0.0, p2_ - p0_, 0.0));
    }

    /// C(e) times the area once all of a triangle lies below e.
    const core::Simd& whole() const { return whole_; }

    /// The same, with lane i alone.
    SortedTriangles only(std::size_t i) const {
        SortedTriangles one = *this;
        alignas(64) std::array<double, core::Simd::size()> whole{};
        whole[i] = whole_[i];
        one.whole_ = core::load(whole, 0);
        return one;
    }

    // C(e) times the area.
    [[gnu::always_inline]] core::Simd below(double e) const {
        const core::SimdMask low = e < p1_;
        const core::Simd reach = max(select(low, e - p0_, p2_ - e), 0.0);
        const core::Simd a = reach * select(low, low_.per, high_.per);
        core::Simd part = select(low, low_.factor[3], high_.factor[3]);
        for (std::size_t k = 3; k-- > 0;) {
            part = part * a + select(low, low_.factor[k], high_.factor[k]);
        }
        const core::Simd within = min(max(part * a, 0.0), whole_);
        return select(low, within, whole_ - within);
    }

 private:
    using OfCorners = std::array<core::Simd, 3>;

    // C(e), or what it lacks to all, as a polynomial of a without a constant term.
    struct Side {
        core::Simd per;  ///< a per distance from the corner
        std::array<core::Simd, 4> factor;

        Side() = default;
        // k      weights of the corner that a counts from, of the middle one and of the other one
        // c      bends opposite to them
        // sign   +1 where the part below e is described, -1 for the part above
        [[gnu::always_inline]] Side(const core::Simd& rise,
                                    const core::Simd& per_02,
                                    const OfCorners& k,
                                    const OfCorners& c,
                                    double sign)
            : per(1.0 / max(rise, kMinRise)) {
            const core::Simd ratio = rise * per_02;
            const core::Simd gradient = (k[1] - k[0]) + ratio * (k[2] - k[0]);  // x / a
            // -2 q / (p2-p0), by powers of a
            const core::Simd sum = c[0] + c[1] + c[2];
            const core::Simd q0 = -0.5 * sign * sum;
            const core::Simd q1 = 3.0 * sign * (c[2] + ratio * c[1]);
            const core::Simd q2 =
                sign * (ratio * (sum - 2.0 * (c[2] + c[1]) - 2.0 * ratio * c[1]) - 2.0 * c[2]);
            factor[0] = q0 * k[0];
            factor[1] = ratio * k[0] + q1 * k[0] + 0.5 * q0 * gradient;
            factor[2] = (1.0 / 3.0) * ratio * gradient + q2 * k[0] + 0.5 * q1 * gradient;
            factor[3] = 0.5 * q2 * gradient;
        }
    };

    core::Simd p0_, p1_, p2_, whole_;
    Side low_, high_;
};

}  // namespace renderer
