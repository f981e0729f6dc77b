// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/shift/charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

namespace renderer {

/// R v, a quarter turn.
inline core::Vec2 turned(const core::Vec2& v) {
    return {-v.y(), v.x()};
}

inline double cross(const core::Vec2& a, const core::Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// The metric of a chart, M_ij = X_i.X_j, with its derivatives.
struct ChartMetric {
    double area_density = 0.0;  ///< sqrt(det M) = |X_1 x X_2|
    Eigen::Matrix2d m;
    std::array<Eigen::Matrix2d, 2> by{Eigen::Matrix2d::Zero(), Eigen::Matrix2d::Zero()};

    template <bool is_affine>
    static ChartMetric of(const ChartPoint& p) {
        ChartMetric metric;
        const double m12 = p.tangent1.dot(p.tangent2);
        metric.m << p.tangent1.squaredNorm(), m12, m12, p.tangent2.squaredNorm();
        metric.area_density = p.area_density;
        if constexpr (!is_affine) {
            const auto derivative = [&](const core::Vec3& second1, const core::Vec3& second2) {
                const double d12 = second1.dot(p.tangent2) + p.tangent1.dot(second2);
                Eigen::Matrix2d d;
                d << 2.0 * second1.dot(p.tangent1), d12, d12, 2.0 * second2.dot(p.tangent2);
                return d;
            };
            metric.by = {derivative(p.second11, p.second12), derivative(p.second12, p.second22)};
        }
        return metric;
    }
};

/// A path functional in a chart, to second order: f(xi) = factor * functional(X(xi)).
struct ChartExpansion {
    double value = 0.0;
    core::Vec2 gradient;  ///< df/dxi
    double h11 = 0.0;     ///< second derivatives of f
    double h12 = 0.0;
    double h22 = 0.0;
    double gradient_size = 0.0;  ///< what the gradient per metre of movement cannot exceed by much
    double segments_m = 0.0;     ///< length of the two segments
    double shorter_segment_m = 0.0;
    double rounding_m = 0.0;  ///< of the position
    core::Vec3 position;      ///< relative to the chart's origin
    ChartMetric metric;
    std::uint32_t facet = 0;

    core::Vec2 hessian_times(const core::Vec2& v) const {
        return {h11 * v.x() + h12 * v.y(), h12 * v.x() + h22 * v.y()};
    }

    /// |v| of a covector, as a length on the surface.
    double norm_of(const core::Vec2& v) const {
        // v^T M^-1 v = (R v)^T M (R v)/det M
        const core::Vec2 across = turned(v);
        return std::sqrt(across.dot(metric.m * across)) / metric.area_density;
    }

    /// How far the conditions f = const and the gauge's, with gradient `gauge`, stay well apart:
    /// the shorter segment, less where the gradient is small (close to zero near a tangent point)
    /// or where the two run alongside [m].
    double reach_m(const core::Vec2& gauge) const {
        return shorter_segment_m * std::abs(cross(gradient, gauge)) /
               (metric.area_density * gradient_size * norm_of(gauge));
    }
};

/// A chart with the functional that one end of a shift keeps: the source's, times the ratio of the
/// gate widths S, or the target's, times 1.
template <SurfaceChart Chart, class Functional>
struct ShiftSide {
    using ChartType = Chart;

    Chart chart;
    Functional functional;
    double factor = 1.0;

    std::optional<ChartExpansion> at(const core::Vec2& xi) const {
        const auto point = chart.at(xi);
        if (!point) return std::nullopt;
        return expand(*point);
    }

    ChartExpansion expand(const ChartPoint& point) const {
        const auto f = functional.expand(point.position, point.velocity);
        const core::Vec3 h1 = f.hessian_times(point.tangent1);
        ChartExpansion e;
        e.value = factor * f.value;
        e.gradient =
            factor * core::Vec2(f.gradient.dot(point.tangent1), f.gradient.dot(point.tangent2));
        e.h11 = h1.dot(point.tangent1);
        e.h12 = h1.dot(point.tangent2);
        e.h22 = f.hessian_times(point.tangent2).dot(point.tangent2);
        if constexpr (!Chart::kAffine) {
            // The chart's own curvature. The supplement's (13) leaves it out, which makes both
            // Newton steps and determinant wrong on the hemisphere.
            e.h11 += f.gradient.dot(point.second11);
            e.h12 += f.gradient.dot(point.second12);
            e.h22 += f.gradient.dot(point.second22);
        }
        e.h11 *= factor;
        e.h12 *= factor;
        e.h22 *= factor;
        e.metric = ChartMetric::of<Chart::kAffine>(point);
        e.gradient_size = factor * f.gradient_size;
        e.segments_m = 1.0 / f.inverse_a + 1.0 / f.inverse_y;
        e.shorter_segment_m = 1.0 / std::max(f.inverse_a, f.inverse_y);
        e.rounding_m = point.rounding_m;
        e.position = point.position;
        e.facet = point.facet;
        return e;
    }
};

/// The two sides of a shift and by how much their functionals shall differ:
/// f_target(xi') - f_source(xi) = change. Swapped sides with the negative change are its inverse.
template <class Source, class Target>
struct ShiftProblem {
    const Source& source;
    const Target& target;
    double change = 0.0;

    ShiftProblem<Target, Source> inverse() const { return {target, source, -change}; }
};

}  // namespace renderer
