// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/shift/shift_side.h"

#include <optional>
#include <variant>

namespace renderer {

/// A shift has two unknowns and one condition, the change of the functional. The gauge is the
/// second condition, F2(xi, xi') = 0: along which curve the vertex moves.
///
/// To add one: a struct whose operator() gives F2 and its two gradients; add it to `AnyGauge` and
/// its name to restir_settings.h. A gauge is reversible when swapping the ends (and S f_s with f_t)
/// leaves F2 = 0 the same curve. All but FlowGauge are equations for the solver.
struct GaugeTerms {
    double residual = 0.0;  ///< F2
    core::Vec2 by_target;   ///< dF2/dxi'
    core::Vec2 by_source;   ///< dF2/dxi
};

/// An iterate of the solver: both ends with the functionals expanded there.
struct ShiftState {
    core::Vec2 xi;
    core::Vec2 xi_new;
    ChartExpansion at_source;  ///< source's functional at xi
    ChartExpansion at_target;  ///< target's functional at xi_new

    core::Vec2 step() const { return xi_new - xi; }
};

/// The gauges that the solver takes.
struct EquationGauge {
    /// Longest last step of the solver, as a fraction of the reach: the next one would be
    /// quadratically smaller, below rounding.
    static constexpr double kLastStep = 1e-6;
};

/// F2 = (R m).D with a fixed m; R^T = -R gives (R v).D = -v.(R D), so that a change H dxi of m
/// changes F2 by -(H R D).dxi.
inline GaugeTerms gauge_across(const core::Vec2& m, const core::Vec2& d) {
    const core::Vec2 across = turned(m);
    return {across.dot(d), across, -across};
}

/// m = mean of the gradients at both ends; trapezoidal rule (default).
struct AverageGauge : EquationGauge {
    template <class Problem>
    std::optional<GaugeTerms> operator()(const Problem&, const ShiftState& s) const {
        const core::Vec2 d = s.step();
        GaugeTerms terms = gauge_across(0.5 * (s.at_source.gradient + s.at_target.gradient), d);
        terms.by_target -= 0.5 * s.at_target.hessian_times(turned(d));
        terms.by_source -= 0.5 * s.at_source.hessian_times(turned(d));
        return terms;
    }
};

/// The average gauge with gradients of the surface instead of the coordinates: D parallel to
/// M^-1 g, M the chart's metric, which does not depend on how the surface is parameterized.
///
/// R M^-1 = M R/det M; with the factor sqrt(det M) lengths keep their size: F2 = (N g).D,
/// N = M R/sqrt(det M), averaged over the ends. Along coordinate k,
/// N_k = (M_k - tr(M^-1 M_k) M/2) R/sqrt(det M). On a plane's orthonormal chart N = R.
struct MetricAverageGauge : EquationGauge {
    template <class Problem>
    std::optional<GaugeTerms> operator()(const Problem&, const ShiftState& s) const {
        const core::Vec2 d = s.step();
        const core::Vec2 across = 0.5 * (across_of(s.at_source) + across_of(s.at_target));
        return GaugeTerms{across.dot(d),
                          across + 0.5 * bend_of(s.at_target, d),
                          -across + 0.5 * bend_of(s.at_source, d)};
    }

 private:
    static core::Vec2 across_of(const ChartExpansion& e) {
        return e.metric.m * turned(e.gradient) / e.metric.area_density;
    }
    // Gradient of (N g).d at fixed d.
    static core::Vec2 bend_of(const ChartExpansion& e, const core::Vec2& d) {
        const double inverse = 1.0 / e.metric.area_density;
        const Eigen::Matrix2d m_inverse = e.metric.m.inverse();
        core::Vec2 bend = -inverse * e.hessian_times(turned(e.metric.m * d));
        for (int k = 0; k < 2; ++k) {
            const Eigen::Matrix2d& m_k = e.metric.by[static_cast<std::size_t>(k)];
            const Eigen::Matrix2d n_k = m_k - 0.5 * (m_inverse * m_k).trace() * e.metric.m;
            bend[k] += inverse * (n_k * turned(e.gradient)).dot(d);
        }
        return bend;
    }
};

/// m = gradient at the start: explicit Euler, here to show that it is not reversible.
struct StartGauge : EquationGauge {
    template <class Problem>
    std::optional<GaugeTerms> operator()(const Problem&, const ShiftState& s) const {
        GaugeTerms terms = gauge_across(s.at_source.gradient, s.step());
        terms.by_source -= s.at_source.hessian_times(turned(s.step()));
        return terms;
    }
};

/// The vertex moves along the chart's first coordinate.
struct FixedGauge : EquationGauge {
    template <class Problem>
    std::optional<GaugeTerms> operator()(const Problem&, const ShiftState& s) const {
        // The factor gives F2 the size of the other gauges'.
        return gauge_across(s.at_source.gradient.norm() * core::Vec2::UnitX(), s.step());
    }
};

/// m = mean of both functionals' gradients half way; implicit midpoint rule.
struct MidpointGauge : EquationGauge {
    template <class Problem>
    std::optional<GaugeTerms> operator()(const Problem& problem, const ShiftState& s) const {
        const core::Vec2 middle = 0.5 * (s.xi + s.xi_new);
        const auto source = problem.source.at(middle);
        const auto target = problem.target.at(middle);
        if (!source || !target) return std::nullopt;
        const core::Vec2 d = s.step();
        GaugeTerms terms = gauge_across(0.5 * (source->gradient + target->gradient), d);
        // The middle moves by half of either end's movement.
        const core::Vec2 bend =
            0.25 * (source->hessian_times(turned(d)) + target->hessian_times(turned(d)));
        terms.by_target -= bend;
        terms.by_source -= bend;
        return terms;
    }
};

/// Velocity v of the gradient flow at q and its derivative by xi (row-wise: dv_i/dxi_j).
///
/// Along f_q = (1-q) f_s + q f_t, the flow dxi/dq = v = k g/|g|^2, g = grad f_q,
/// k = change - (f_t - f_s), keeps df_q/dq = (f_t - f_s) + g.v = change, so f_t(xi') - f_s(xi) =
/// change in the end. Seen from the other end (q -> 1-q, sides swapped, change negated) v is -v.
struct FlowVelocity {
    core::Vec2 v;
    double d11, d12, d21, d22;

    FlowVelocity(const ChartExpansion& source,
                 const ChartExpansion& target,
                 double q,
                 double change) {
        const core::Vec2 g = (1.0 - q) * source.gradient + q * target.gradient;
        const double h11 = (1.0 - q) * source.h11 + q * target.h11;
        const double h12 = (1.0 - q) * source.h12 + q * target.h12;
        const double h22 = (1.0 - q) * source.h22 + q * target.h22;
        const double k = change - (target.value - source.value);
        const core::Vec2 dk = source.gradient - target.gradient;
        const double inverse = 1.0 / g.squaredNorm();
        v = (k * inverse) * g;
        // d(k g/|g|^2) = g dk/|g|^2 + k (H/|g|^2 - 2 g (H g)/|g|^4)
        const core::Vec2 row(inverse * (dk.x() - 2.0 * k * inverse * (h11 * g.x() + h12 * g.y())),
                             inverse * (dk.y() - 2.0 * k * inverse * (h12 * g.x() + h22 * g.y())));
        d11 = g.x() * row.x() + k * inverse * h11;
        d12 = g.x() * row.y() + k * inverse * h12;
        d21 = g.y() * row.x() + k * inverse * h12;
        d22 = g.y() * row.y() + k * inverse * h22;
    }

    double divergence() const { return d11 + d22; }
    /// The transposed derivative times x.
    core::Vec2 pulled_back(const core::Vec2& x) const {
        return {d11 * x.x() + d21 * x.y(), d12 * x.x() + d22 * x.y()};
    }
};

/// D parallel to w = v(0, xi) + 4 v(1/2, xi_m) + v(1, xi'), xi_m = (xi+xi')/2 + (v_0 - v_1)/8: the
/// three-stage Lobatto rule for the flow, symmetric and of order 4.
///
/// It needs no third derivatives: v holds first ones. Four further evaluations per iteration.
struct SymmetricGauge {
    // v changes over the length of D, which may be far below the reach.
    static constexpr double kLastStep = 1e-9;

    template <class Problem>
    std::optional<GaugeTerms> operator()(const Problem& problem, const ShiftState& s) const {
        const auto target_at_start = problem.target.at(s.xi);
        const auto source_at_end = problem.source.at(s.xi_new);
        if (!target_at_start || !source_at_end) return std::nullopt;
        const double change = problem.change;
        if (change == target_at_start->value - s.at_source.value) {
            // Nothing to move: every v is 0, and the limit of w is along the gradients' mean.
            return AverageGauge{}(problem, s);
        }
        const FlowVelocity v0(s.at_source, *target_at_start, 0.0, change);
        const FlowVelocity v1(*source_at_end, s.at_target, 1.0, change);
        const core::Vec2 middle = 0.5 * (s.xi + s.xi_new) + 0.125 * (v0.v - v1.v);
        const auto source = problem.source.at(middle);
        const auto target = problem.target.at(middle);
        if (!source || !target) return std::nullopt;
        const FlowVelocity vm(*source, *target, 0.5, change);

        const core::Vec2 d = s.step();
        const core::Vec2 w = v0.v + 4.0 * vm.v + v1.v;
        const double w_norm = w.norm();
        if (!(w_norm > 0.0)) return std::nullopt;
        // A factor in front of F2 changes neither its solutions nor the ratio of determinants
        // there; this one gives F2 the size of the other gauges'.
        const double weight = s.at_target.gradient.norm() / w_norm;
        const core::Vec2 back = turned(d);
        const core::Vec2 through_middle = 4.0 * vm.pulled_back(back);
        GaugeTerms terms = gauge_across(w, d);
        terms.by_target -=
            v1.pulled_back(back) + 0.5 * through_middle - 0.125 * v1.pulled_back(through_middle);
        terms.by_source -=
            v0.pulled_back(back) + 0.5 * through_middle + 0.125 * v0.pulled_back(through_middle);
        return GaugeTerms{
            weight * terms.residual, weight * terms.by_target, weight * terms.by_source};
    }
};

/// The gradient flow itself, followed in small steps (shift_flow.h).
struct FlowGauge {};

using AnyGauge = std::variant<AverageGauge,
                              MetricAverageGauge,
                              StartGauge,
                              FixedGauge,
                              MidpointGauge,
                              SymmetricGauge,
                              FlowGauge>;

}  // namespace renderer
