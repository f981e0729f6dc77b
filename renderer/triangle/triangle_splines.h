// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/triangle/normal_integrals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace renderer {

/// What smears a triangle's lengths: a Gaussian of standard deviation 1, or nothing.
enum class Smear { Gaussian, None };

/// Cubic splines on the three knots of a triangle: what fraction of it, weighted by a barycentric
/// coordinate, lies below a length, and how that fraction changes with the knots.
///
/// With Phi the cumulative response, l the barycentric coordinates and integrals over the triangle
/// {l_1 + l_2 <= 1} of area 1/2, Hermite and Genocchi's formula gives divided differences
///
///     fraction_j = Int l_j Phi(e - l.x) = -[x0,x1,x2,x_j] H3(e - .),   H3''' = Phi,
///     d fraction_j / d x_k = -(1 + (j == k)) [x0,x1,x2,x_j,x_k] H3(e - .),
///
/// the factor being how often a knot stands in the difference. Past the middle of the knots,
/// H3(u) = u^3/6 + H3(-u) is used from the other side, so that H3 never grows and little cancels.
///
/// T        double, or an automatic derivative
/// source   [deBoor1978]
template <class T>
class TriangleSplines {
 public:
    struct Values {
        std::array<T, 3> fraction;
        /// Of d fraction_j / d x_k without the factor: symmetric, pairs 00 01 02 11 12 22.
        std::array<T, 6> gradient;
    };

    /// knots   in units of the response's standard deviation; in bins for Smear::None
    TriangleSplines(const std::array<T, 3>& knots, Smear smear) : smear_(smear) {
        for (std::size_t i : {0, 1, 0}) {
            if (knots[order_[i + 1]] < knots[order_[i]]) std::swap(order_[i], order_[i + 1]);
        }
        for (std::size_t i = 0; i < 3; ++i) x_[i] = knots[order_[i]];
        if (smear_ == Smear::Gaussian) return;
        if (x_[1] - x_[0] < kMinGap) x_[0] = x_[1] - kMinGap;
        if (x_[2] - x_[1] < kMinGap) x_[2] = x_[1] + kMinGap;
    }

    /// Fractions below `edge` and, if wanted, their gradients, in the order of the given knots.
    void evaluate(double edge, bool with_gradients, Values& values) const {
        const double sign = edge + edge > x_[0] + x_[2] ? -1.0 : 1.0;
        const double base = sign < 0.0 ? 1.0 / 6.0 : 0.0;
        Differences d;
        if (is_close(x_[0], x_[2], edge)) {
            expand_all(edge, sign, with_gradients, d);
        } else {
            divide_all(edge, sign, with_gradients, d);
        }
        for (std::size_t j = 0; j < 3; ++j) values.fraction[order_[j]] = base - d.third[j];
        if (!with_gradients) return;
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = j; k < 3; ++k) {
                values.gradient[pair_index(order_[j], order_[k])] = -d.fourth[pair_index(j, k)];
            }
        }
    }

    static std::size_t pair_index(std::size_t j, std::size_t k) {
        const std::size_t low = std::min(j, k);
        const std::size_t high = std::max(j, k);
        return low == 0 ? high : low + high + 1;
    }

 private:
    // Knots nearer than this are expanded about their mean: the series of kTerms terms is then
    // exact to 1e-11, and division by a larger distance loses at most 1e-12. Without smear the
    // series ends after the cubic term, and is used wherever no knot lies beyond the edge.
    static constexpr double kClose = 0.25;
    static constexpr double kMinGap = 1e-6;
    static constexpr std::size_t kTerms = 9;
    static constexpr std::size_t kDerivatives = kTerms + 4;
    using Derivatives = std::array<T, kDerivatives>;

    struct Differences {
        std::array<T, 3> third;
        std::array<T, 6> fourth;
    };
    /// Of two knots a, b: [a,b], [a,a,b], [a,b,b], [a,a,a,b], [a,a,b,b], [a,b,b,b].
    struct PairDifferences {
        T ab, aab, abb, aaab, aabb, abbb;
    };
    /// f, f' and f''/2 at a knot.
    struct Knot {
        T f, f1, f2;
    };

    bool is_close(const T& low, const T& high, double edge) const {
        if (!(high - low < kClose)) return false;
        return smear_ == Smear::Gaussian || edge <= low || edge >= high;
    }

    // H3, H2 and H1 of u.
    void antiderivatives(const T& u, T& h3, T& h2, T& h1) const {
        using std::erfc;
        using std::exp;
        if (smear_ == Smear::None) {
            h1 = u > 0.0 ? u : T(0.0);
            h2 = 0.5 * h1 * u;
            h3 = h2 * u * (1.0 / 3.0);
            return;
        }
        if constexpr (std::is_same_v<T, double>) {
            const NormalIntegrals integrals = table_->at(u);
            h1 = integrals.h1;
            h2 = integrals.h2;
            h3 = integrals.h3;
            return;
        }
        const T density = (1.0 / std::sqrt(2.0 * core::kPi)) * exp(-0.5 * u * u);
        const T cumulative = 0.5 * erfc(-std::sqrt(0.5) * u);
        h1 = u * cumulative + density;
        h2 = 0.5 * (u * h1 + cumulative);
        h3 = (u * h2 + h1) * (1.0 / 3.0);
    }

    // f(x) = H3(sign (edge - x)).
    Knot at_knot(const T& x, double edge, double sign) const {
        Knot knot;
        antiderivatives(sign * (edge - x), knot.f, knot.f1, knot.f2);
        knot.f1 = -sign * knot.f1;
        knot.f2 = 0.5 * knot.f2;
        return knot;
    }

    // f^(k)(x) / k!
    Derivatives taylor(const T& x, double edge, double sign) const {
        using std::erfc;
        using std::exp;
        const T u = sign * (edge - x);
        Derivatives d;
        antiderivatives(u, d[0], d[1], d[2]);
        const bool is_smeared = smear_ == Smear::Gaussian;
        d[3] = is_smeared ? T(0.5 * erfc(-std::sqrt(0.5) * u)) : T(u > 0.0 ? 1.0 : 0.0);
        d[4] = is_smeared ? T((1.0 / std::sqrt(2.0 * core::kPi)) * exp(-0.5 * u * u)) : T(0.0);
        d[5] = -u * d[4];
        for (std::size_t k = 6; k < kDerivatives; ++k) {  // derivatives of the normal density
            d[k] = -u * d[k - 1] - static_cast<double>(k - 5) * d[k - 2];
        }
        double factor = 1.0;
        for (std::size_t k = 1; k < kDerivatives; ++k) {
            factor *= -sign / static_cast<double>(k);
            d[k] *= factor;
        }
        return d;
    }

    // Complete homogeneous symmetric polynomials h_k of offsets.
    using Polynomials = std::array<T, kTerms>;

    // Those of one offset more.
    static Polynomials joined(Polynomials h, const T& offset) {
        for (std::size_t k = 1; k < kTerms; ++k) h[k] += offset * h[k - 1];
        return h;
    }

    // [X] f = sum over k of f^(N+k)(m)/(N+k)! h_k(X - m), |X| = N + 1.
    template <std::size_t N>
    static T sum_of(const Derivatives& d, const Polynomials& h) {
        T sum = d[N];
        for (std::size_t k = 1; k < kTerms; ++k) sum += d[N + k] * h[k];
        return sum;
    }

    void expand_all(double edge, double sign, bool with_gradients, Differences& d) const {
        const T mean = (x_[0] + x_[1] + x_[2]) * (1.0 / 3.0);
        const Derivatives f = taylor(mean, edge, sign);
        Polynomials h;
        h.fill(T(0.0));
        h[0] = T(1.0);
        for (const T& x : x_) h = joined(h, x - mean);
        for (std::size_t j = 0; j < 3; ++j) {
            const Polynomials with_j = joined(h, x_[j] - mean);
            d.third[j] = sum_of<3>(f, with_j);
            if (!with_gradients) continue;
            for (std::size_t k = j; k < 3; ++k) {
                d.fourth[pair_index(j, k)] = sum_of<4>(f, joined(with_j, x_[k] - mean));
            }
        }
    }

    // About the middle, knots lie at -o and o: h_k is o^k times a whole number, which changes its
    // sign with k where the knots change sides.
    PairDifferences expand_pair(const T& a, const T& b, double edge, double sign) const {
        const T o = 0.5 * (b - a);
        const Derivatives f = taylor(0.5 * (a + b), edge, sign);
        PairDifferences d;
        d.ab = d.aabb = T(0.0);
        T even3 = T(0.0), odd3 = T(0.0), even4 = T(0.0), odd4 = T(0.0);
        T power = T(1.0);
        for (std::size_t k = 0; k < kTerms; ++k) {
            const auto count = static_cast<double>(k / 2 + 1);
            if (k % 2 == 0) {
                d.ab += power * f[1 + k];
                d.aabb += count * power * f[3 + k];
                even3 += count * power * f[2 + k];
                even4 += count * count * power * f[3 + k];
            } else {
                odd3 += count * power * f[2 + k];
                odd4 += count * (count + 1.0) * power * f[3 + k];
            }
            power *= o;
        }
        d.aab = even3 - odd3;
        d.abb = even3 + odd3;
        d.aaab = even4 - odd4;
        d.abbb = even4 + odd4;
        return d;
    }

    static PairDifferences divide_pair(const Knot& a,
                                       const Knot& b,
                                       const T& distance,
                                       bool with_gradients) {
        const T per = 1.0 / distance;
        PairDifferences d;
        d.ab = (b.f - a.f) * per;
        d.aab = (d.ab - a.f1) * per;
        d.abb = (b.f1 - d.ab) * per;
        if (!with_gradients) return d;
        d.aaab = (d.aab - a.f2) * per;
        d.aabb = (d.abb - d.aab) * per;
        d.abbb = (b.f2 - d.abb) * per;
        return d;
    }

    void divide_all(double edge, double sign, bool with_gradients, Differences& d) const {
        const std::array<Knot, 3> knots{
            at_knot(x_[0], edge, sign), at_knot(x_[1], edge, sign), at_knot(x_[2], edge, sign)};
        const auto pair = [&](std::size_t i) {
            if (is_close(x_[i], x_[i + 1], edge)) return expand_pair(x_[i], x_[i + 1], edge, sign);
            return divide_pair(knots[i], knots[i + 1], x_[i + 1] - x_[i], with_gradients);
        };
        const PairDifferences low = pair(0);   // of knots 0 and 1
        const PairDifferences high = pair(1);  // of knots 1 and 2
        const T per = 1.0 / (x_[2] - x_[0]);
        const T d012 = (high.ab - low.ab) * per;
        const T d0012 = (d012 - low.aab) * per;
        const T d0112 = (high.aab - low.abb) * per;
        const T d0122 = (high.abb - d012) * per;
        d.third = {d0012, d0112, d0122};
        if (!with_gradients) return;
        d.fourth = {(d0012 - low.aaab) * per,
                    (d0112 - low.aabb) * per,
                    (d0122 - d0012) * per,
                    (high.aaab - low.abbb) * per,
                    (high.aabb - d0112) * per,
                    (high.abbb - d0122) * per};
    }

    Smear smear_;
    const NormalIntegralTable* table_ = &NormalIntegralTable::instance();
    std::array<std::size_t, 3> order_{0, 1, 2};
    std::array<T, 3> x_;  ///< sorted
};

}  // namespace renderer
