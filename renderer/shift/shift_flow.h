// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/shift/shift_solver.h"

#include <cmath>
#include <optional>

namespace renderer {

inline constexpr int kMinFlowSteps = 4;
inline constexpr int kMaxFlowSteps = 512;
/// Doubling the steps divides the error by 16: what is left is a sixteenth of these.
inline constexpr double kFlowChange = 1e-10;  ///< fraction of the segments
inline constexpr double kFlowJacobianChange = 1e-8;
/// The inverse flow must return this close to its start, as a fraction of the shorter segment.
inline constexpr double kFlowReturnTolerance = 1e-7;

/// Where the gradient flow leads from xi, in `steps` steps of the classical Runge-Kutta rule.
///
/// The logarithm of the determinant grows by the divergence of the flow's velocity (Liouville); it
/// is integrated with the same rule, so both are of order 4 in the step. The path length is
/// right only to that order too.
template <class Problem>
std::optional<ShiftSolution> follow_flow(const Problem& problem,
                                         const core::Vec2& xi,
                                         const ChartExpansion& at_source,
                                         int steps,
                                         ShiftTrace& trace) {
    core::Vec2 here = xi;
    double log_determinant = 0.0;
    const double h = 1.0 / steps;
    for (int i = 0; i < steps; ++i) {
        core::Vec2 sum = core::Vec2::Zero();
        double divergence = 0.0;
        core::Vec2 offset = core::Vec2::Zero();
        for (int stage = 0; stage < 4; ++stage) {
            const double part = stage == 0 ? 0.0 : (stage == 3 ? 1.0 : 0.5);
            const double weight = stage == 0 || stage == 3 ? 1.0 / 6.0 : 1.0 / 3.0;
            const auto source = problem.source.at(here + part * h * offset);
            const auto target = problem.target.at(here + part * h * offset);
            if (!source || !target) return trace.reject(ShiftRejection::LeftChart);
            const FlowVelocity flow(*source, *target, h * (i + part), problem.change);
            offset = flow.v;
            sum += weight * flow.v;
            divergence += weight * flow.divergence();
        }
        ++trace.iterations;
        here += h * sum;
        log_determinant += h * divergence;
        if (!std::isfinite(here.x() + here.y() + log_determinant)) {
            return trace.reject(ShiftRejection::Degenerate);
        }
    }
    const auto target = problem.target.at(here);
    if (!target) return trace.reject(ShiftRejection::LeftChart);
    return ShiftSolution{
        here,
        std::exp(log_determinant) * target->metric.area_density / at_source.metric.area_density,
        *target};
}

/// Doubles the number of steps until neither the end nor the determinant moves any more and the
/// functional has changed as required; a flow through a stationary point never converges.
template <class Problem>
std::optional<ShiftSolution> follow_flow(const Problem& problem,
                                         const core::Vec2& xi,
                                         const ChartExpansion& at_source,
                                         ShiftTrace& trace) {
    // The flow crosses the level curves at right angles.
    if (!is_resolved(at_source, turned(at_source.gradient))) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    const double segments = at_source.segments_m;
    auto coarse = follow_flow(problem, xi, at_source, kMinFlowSteps, trace);
    for (int steps = 2 * kMinFlowSteps; coarse && steps <= kMaxFlowSteps; steps *= 2) {
        auto fine = follow_flow(problem, xi, at_source, steps, trace);
        if (!fine) return std::nullopt;
        const double moved = (fine->at_target.position - coarse->at_target.position).norm();
        const double residual = fine->at_target.value - at_source.value - problem.change;
        const double allowed =
            kShiftTolerance * std::min(1.0, segments) * fine->at_target.gradient_size;
        if (moved <= kFlowChange * segments && std::abs(residual) <= allowed &&
            std::abs(fine->jacobian - coarse->jacobian) <= kFlowJacobianChange * fine->jacobian) {
            if (is_resolved(fine->at_target, turned(fine->at_target.gradient))) {
                return fine;
            }
            return trace.reject(ShiftRejection::Degenerate);
        }
        coarse = fine;
    }
    return coarse ? trace.reject(ShiftRejection::NotConverged) : std::nullopt;
}

/// The flow as a gauge like the others.
template <class Problem>
std::optional<ShiftSolution> shift_on_charts(const FlowGauge&,
                                             const Problem& problem,
                                             const core::Vec2& xi,
                                             const ChartExpansion& at_source,
                                             ReverseCheck reverse_check,
                                             ShiftTrace& trace) {
    auto solution = follow_flow(problem, xi, at_source, trace);
    if (!solution || reverse_check == ReverseCheck::Off) return solution;
    const auto back = follow_flow(problem.inverse(), solution->xi, solution->at_target, trace);
    const double allowed = kFlowReturnTolerance * at_source.shorter_segment_m;
    if (!back || !((back->at_target.position - at_source.position).norm() <= allowed)) {
        return trace.reject(ShiftRejection::NotReversible);
    }
    return solution;
}

}  // namespace renderer
