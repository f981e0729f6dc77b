// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/shift/shift_counts.h"
#include "renderer/shift/shift_gauges.h"
#include "renderer/shift/shift_side.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

namespace renderer {

/// Both residuals end below this [m], and below this fraction of the segments where they are
/// shorter.
inline constexpr double kShiftTolerance = 1e-9;

/// Determinants below this fraction of what the gradients' sizes allow count as zero.
inline constexpr double kTinyDeterminant = 1e-6;
/// Segments shorter than this fraction of both count as zero.
inline constexpr double kShortestSegment = 1e-6;
/// With steepness s = reach/segment, coordinates right to e give a solution right to e/s, and from
/// it a determinant right to e/s over the reach, e/(segment s^2). What is left of the segment must
/// exceed this many roundings.
inline constexpr double kFeltRoundings = 1e8;
/// The reverse solve must come back to within this fraction of the shorter segment: ten times what
/// rounding leaves of ends that count as resolved. Far from the foci many facets fit into that, so
/// it must be the same facet, too.
inline constexpr double kReturnTolerance = 1e-7;
inline constexpr int kMaxIterations = 10;
inline constexpr int kMaxHalvings = 4;

/// A solved shift in chart coordinates.
struct ShiftSolution {
    core::Vec2 xi;
    double jacobian = 0.0;  ///< of areas on the surface, dA'/dA
    ChartExpansion at_target;
};

/// Whether an end is far enough from its foci and from tangent points for a meaningful shift.
inline bool is_resolved(const ChartExpansion& e, const core::Vec2& gauge) {
    const double reach = e.reach_m(gauge);
    return e.shorter_segment_m > kShortestSegment * e.segments_m &&
           reach * reach > kFeltRoundings * e.rounding_m * e.shorter_segment_m;
}

/// The solution that a state has reached, unless it is degenerate or folded.
///
/// With F = 0 on both sides of a change, dxi'/dxi = -(dF/dxi')^-1 dF/dxi; its determinant is the
/// ratio of the determinants, positive at the identity.
inline std::optional<ShiftSolution> solution_at(const ShiftState& state,
                                                const GaugeTerms& terms,
                                                ShiftTrace& trace) {
    const double by_target = cross(state.at_target.gradient, terms.by_target);
    const double by_source = cross(state.at_source.gradient, -terms.by_source);
    const auto is_tiny = [](double determinant, const ChartExpansion& e) {
        return !(std::abs(determinant) > kTinyDeterminant * e.gradient_size * e.gradient_size *
                                             e.metric.area_density * e.segments_m /
                                             e.shorter_segment_m);
    };
    if (is_tiny(by_target, state.at_target) || is_tiny(by_source, state.at_source) ||
        !is_resolved(state.at_target, terms.by_target) ||
        !is_resolved(state.at_source, terms.by_source)) {
        return trace.reject(ShiftRejection::Degenerate);
    }
    const double ratio = by_source / by_target;
    if (!(ratio > 0.0)) return trace.reject(ShiftRejection::Folded);
    return ShiftSolution{
        state.xi_new,
        ratio * state.at_target.metric.area_density / state.at_source.metric.area_density,
        state.at_target};
}

/// Newton's method with line search on F1 = f_t(xi') - f_s(xi) - change and the gauge's F2.
///
/// at_source   source's functional at xi
/// start       target's functional at xi, where the search begins
/// returns     the solution; nullopt with the reason in `trace`
template <class Gauge, class Problem>
std::optional<ShiftSolution> newton_shift(const Gauge& gauge,
                                          const Problem& problem,
                                          const core::Vec2& xi,
                                          const ChartExpansion& at_source,
                                          const ChartExpansion& start,
                                          ShiftTrace& trace) {
    ShiftState state{xi, xi, at_source, start};
    const auto first_terms = gauge(problem, state);
    if (!first_terms) return trace.reject(ShiftRejection::LeftChart);
    GaugeTerms terms = *first_terms;
    const double segments = at_source.segments_m;
    const double goal = at_source.value + problem.change;
    double last_step = std::numeric_limits<double>::infinity();
    for (int iteration = 0;; ++iteration) {
        const double f1 = state.at_target.value - goal;
        const double tolerance =
            kShiftTolerance * std::min(1.0, segments) * state.at_target.gradient_size;
        const bool is_small = std::abs(f1) <= tolerance && std::abs(terms.residual) <= tolerance;
        if (is_small && last_step <= Gauge::kLastStep * state.at_target.reach_m(terms.by_target))
            break;
        if (f1 == 0.0 && terms.residual == 0.0) break;
        if (iteration == kMaxIterations) return trace.reject(ShiftRejection::NotConverged);
        ++trace.iterations;

        const core::Vec2& gradient = state.at_target.gradient;
        const double inverse = 1.0 / cross(gradient, terms.by_target);
        const core::Vec2 step =
            -inverse * core::Vec2(terms.by_target.y() * f1 - gradient.y() * terms.residual,
                                  gradient.x() * terms.residual - terms.by_target.x() * f1);
        if (!std::isfinite(step.x() + step.y())) return trace.reject(ShiftRejection::Degenerate);

        const double merit = f1 * f1 + terms.residual * terms.residual;
        double fraction = 1.0;
        bool is_better = false;
        for (int halving = 0; halving <= kMaxHalvings && !is_better; ++halving, fraction *= 0.5) {
            ShiftState next = state;
            next.xi_new = state.xi_new + fraction * step;
            const auto target = problem.target.at(next.xi_new);
            if (!target) continue;
            next.at_target = *target;
            const auto next_terms = gauge(problem, next);
            if (!next_terms) continue;
            const double next_f1 = target->value - goal;
            const double next_merit =
                next_f1 * next_f1 + next_terms->residual * next_terms->residual;
            // Once both residuals are small, the merit is dominated by rounding: take the full
            // step.
            if (!(next_merit < merit || is_small)) continue;
            // A halved step says nothing about the next one.
            last_step = halving == 0 ? (target->position - state.at_target.position).norm()
                                     : std::numeric_limits<double>::infinity();
            state = next;
            terms = *next_terms;
            is_better = true;
        }
        if (!is_better) return trace.reject(ShiftRejection::NotConverged);
    }
    return solution_at(state, terms, trace);
}

/// The equations can have a second root, on another branch of the curve. On the right branch all
/// four directional derivatives along the step, of both functionals at both ends, have the same
/// sign.
inline bool is_on_first_branch(const core::Vec2& step,
                               const ChartExpansion& source_at_start,
                               const ChartExpansion& target_at_start,
                               const ChartExpansion& source_at_end,
                               const ChartExpansion& target_at_end) {
    const std::array gradients{step.dot(source_at_start.gradient),
                               step.dot(target_at_start.gradient),
                               step.dot(source_at_end.gradient),
                               step.dot(target_at_end.gradient)};
    const auto [least, most] = std::minmax_element(gradients.begin(), gradients.end());
    return *least >= 0.0 || *most <= 0.0;
}

/// Solves a shift, checks the branch and, with `reverse_check`, solves the reverse shift: only what
/// returns to its start belongs to a one-to-one map.
///
/// at_source   source's functional at xi
/// returns     the solution; nullopt with the reason in `trace`
template <class Gauge, class Problem>
std::optional<ShiftSolution> shift_on_charts(const Gauge& gauge,
                                             const Problem& problem,
                                             const core::Vec2& xi,
                                             const ChartExpansion& at_source,
                                             ReverseCheck reverse_check,
                                             ShiftTrace& trace) {
    const auto start = problem.target.at(xi);
    if (!start) return trace.reject(ShiftRejection::LeftChart);
    auto solution = newton_shift(gauge, problem, xi, at_source, *start, trace);
    if (!solution) return std::nullopt;
    const core::Vec2 step = solution->xi - xi;
    using TargetChart = typename std::remove_cvref_t<decltype(problem.target)>::ChartType;
    if (TargetChart::kPeriodic && std::abs(step.y()) > 0.5) {
        return trace.reject(ShiftRejection::LeftChart);
    }
    const auto source_at_end = problem.source.at(solution->xi);
    if (!source_at_end) return trace.reject(ShiftRejection::LeftChart);
    if (!is_on_first_branch(step, at_source, *start, *source_at_end, solution->at_target)) {
        return trace.reject(ShiftRejection::SecondRoot);
    }
    if (reverse_check == ReverseCheck::Off) return solution;

    const auto back = newton_shift(
        gauge, problem.inverse(), solution->xi, solution->at_target, *source_at_end, trace);
    const double allowed = kReturnTolerance * at_source.shorter_segment_m;
    if (!back || back->at_target.facet != at_source.facet ||
        !((back->at_target.position - at_source.position).norm() <= allowed)) {
        return trace.reject(ShiftRejection::NotReversible);
    }
    return solution;
}

}  // namespace renderer
