// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace core {

/// The largest double below 1.
inline constexpr double kBelowOne = 1.0 - 0x1.0p-53;

/// The i-th of `count` points of a lattice spread evenly over the unit square, each of them uniform
/// when `shift` is.
///
/// source   Fibonacci lattice; shifted at random [Cranley1976]
inline Vec2 lattice_point(int i, int count, const Vec2& shift) {
    constexpr double kGolden = 0.6180339887498949;  // (sqrt(5) - 1) / 2
    const double v = shift.y() + kGolden * i;
    return {(i + shift.x()) / count, v - std::floor(v)};
}

/// Warps of the unit square, each with its density (source [Osada2002] for the triangle; the others
/// follow from their cumulative distributions).

/// Barycentric coordinates (b1, b2) of a point uniform by area on a triangle; b0 = 1 - b1 - b2.
inline Vec2 sample_triangle(const Vec2& u) {
    // b0 has density 2 b0 on [0, 1]; given it, b1 / (1 - b0) is uniform.
    const double root = std::sqrt(u.x());
    return {root * (1.0 - u.y()), root * u.y()};
}

/// Unit vector about +z with density cos(theta)/pi.
Vec3 sample_cosine_hemisphere(const Vec2& u);
double pdf_cosine_hemisphere(const Vec3& direction);  ///< pdf_solid_angle [1/sr]

/// Unit vector uniform on the sphere, and its density pdf_solid_angle [1/sr].
Vec3 sample_sphere(const Vec2& u);
inline double pdf_sphere() {
    return 1.0 / (4.0 * kPi);
}

/// Picks indices with probabilities proportional to given weights, in index order along u.
class DiscreteDistribution {
 public:
    DiscreteDistribution() = default;
    /// weights   not negative, finite, with a positive sum (asserted)
    explicit DiscreteDistribution(std::span<const double> weights);

    std::size_t size() const { return cumulative_.size(); }
    double sum() const { return sum_; }

    /// The index whose interval of [0, 1) holds u. `remapped` becomes uniform in [0, 1) given the
    /// index.
    std::size_t sample(double u, double& remapped) const;
    /// The part [begin, end) of [0, 1) that belongs to an index.
    struct Interval {
        std::size_t index;
        double begin;
        double end;
        double inverse_width;

        /// Of a u in it, uniform in [0, 1).
        double remap(double u) const {
            return std::clamp((u - begin) * inverse_width, 0.0, kBelowOne);
        }
    };
    /// The interval that holds u, searched upwards from an index not beyond its own.
    Interval interval_from(std::size_t hint, double u) const;

 private:
    Interval interval_of(std::size_t index) const;

    std::vector<double> cumulative_;  ///< upper end of each index's interval, last is 1
    double sum_ = 0.0;
};

}  // namespace core
