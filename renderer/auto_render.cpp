// SPDX-License-Identifier: MIT
#include "renderer/auto_render.h"

#include "renderer/bounce_truncation.h"
#include "renderer/ellipsoidal_render.h"
#include "renderer/estimators.h"
#include "renderer/path_render.h"
#include "renderer/sampling_costs.h"
#include "renderer/smoothed_render.h"
#include "renderer/third_bounce/third_bounce.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

// Of the time, where the integrator and paths share it: the former converges faster.
constexpr double kIntegratorsTime = 0.25;

/// How a render that integrates third bounces goes about it.
struct Plan {
    bool traces = false;      ///< paths, beside the integrator
    bool averages = false;    ///< what paths give over neighbours
    bool connects = false;    ///< paths by their length
    double left_out = 0.0;    ///< relative L2 over all of H of orders that are not computed
    double least_cost = 0.0;  ///< of those paths, see SamplingCosts
};

bool can_integrate(const RenderTask& task) {
    return task.scan.has_wall() && !task.axes.velocity && task.settings.max_bounces >= 3 &&
           task.settings.gate == GateShape::Box && surfaces_of(task.scene).integrable;
}

// Where paths give orders from 4 on alone, which vary slowly over wall points and bins, they are
// averaged if an error allows it.
bool may_average(const RenderSettings& settings, const Surfaces& surfaces) {
    return settings.target_error && !settings.by_order && !settings.variance &&
           !surfaces.narrow_lobes;
}

// Orders that are far below the error asked for need not be computed. What is left out counts as
// part of the error.
std::optional<core::LeftOutOrders> leave_out_orders(RenderTask& task) {
    constexpr double kFractionOfTarget = 0.5;
    RenderSettings& settings = task.settings;
    if (!settings.target_error || settings.by_order || settings.max_bounces <= 3) return {};
    task.progress.update(0.0, "trial runs for the orders of bounces");
    const BounceTruncation orders =
        find_bounce_truncation(task, kFractionOfTarget * *settings.target_error);
    if (orders.last == settings.max_bounces) return {};
    const core::LeftOutOrders left_out{
        orders.last + 1, settings.max_bounces, orders.left_out, orders.share};
    settings.max_bounces = orders.last;
    return left_out;
}

// Relative, of all that is computed, squared.
double squared_target(const RenderSettings& settings, const Plan& plan) {
    return std::max(0.0, std::pow(*settings.target_error, 2) - plan.left_out * plan.left_out);
}

// CPU time that trying to integrate third bounces is worth: a half of what sampling them, too,
// takes [s]. Then the choice costs at most that much more than the better of the two knew.
double worthwhile_work_s(const RenderTask& task, const Plan& plan, const SamplingCosts& alone) {
    constexpr double kHalf = 0.5;
    constexpr double kBesideIntegrator = 0.75;  // of the squared error
    const double allowed = squared_target(task.settings, plan);
    // What averages leave of it is not known yet, and often little.
    const bool is_known = !plan.averages && std::isfinite(plan.least_cost);
    const double beside = is_known ? plan.least_cost / kBesideIntegrator : 0.0;
    return std::max(0.0, kHalf * (alone.least() - beside) / allowed);
}

// Beside paths, the integrator gets half of the error that may be left or a quarter of the time;
// more of the error where averages over neighbours make paths cheap.
RenderSettings settings_of_integrator(RenderSettings settings, const Plan& plan) {
    constexpr double kErrorBesidePaths = 0.5;
    constexpr double kErrorBesideAverages = 0.7;
    if (auto& target = settings.target_error) {
        const double allowed = std::sqrt(squared_target(settings, plan));
        const double fraction = plan.averages ? kErrorBesideAverages : kErrorBesidePaths;
        target = plan.traces ? fraction * allowed : allowed;
    }
    if (settings.seconds && plan.traces) *settings.seconds *= kIntegratorsTime;
    return settings;
}

RenderSettings settings_of_paths(RenderSettings settings, double seconds_of_integrator) {
    if (auto& seconds = settings.seconds) {
        seconds = std::max((1.0 - kIntegratorsTime) * *seconds, *seconds - seconds_of_integrator);
    }
    return settings;
}

std::vector<OrderSource> sources_of_third_bounces(const Surfaces& surfaces, const Plan& plan) {
    if (!surfaces.narrow_lobes) return {{3, 3, Estimator::ThirdBounce, "all"}};
    return {{3, 3, Estimator::ThirdBounce, "all but narrow glossy lobes and dielectrics"},
            {3,
             3,
             plan.connects ? Estimator::Ellipsoidal : Estimator::Path,
             "narrow glossy lobes and dielectrics"}};
}

void add_third_bounces(const ThirdBounce& third, const Plan& plan, RenderResult& result) {
    result.capture.transient += third.transient;
    if (!result.capture.by_order.empty()) result.capture.by_order[2] += third.transient;
    result.element_tolerance = third.element_tolerance;
    if (!third.estimated_error) {
        result.estimated_error.reset();
    } else if (!plan.traces) {
        result.estimated_error = std::hypot(*third.estimated_error, plan.left_out);
    }
    result.num_rays += third.num_rays;
    result.seconds += third.seconds;
    result.interrupted = result.interrupted || third.interrupted;
}

// Nothing where sampling all bounces takes less work than `limits` allow.
std::optional<RenderResult> integrate_and_trace(const RenderTask& task,
                                                const Plan& plan,
                                                const CutLimits& limits = {}) {
    const double done = plan.traces ? 0.1 : 1.0;
    const ThirdBounce third = integrate_third_bounce(task.scene,
                                                     task.scan.wall(),
                                                     task.axes.time,
                                                     settings_of_integrator(task.settings, plan),
                                                     task.progress.part(0.0, done),
                                                     limits);
    if (third.is_too_much) return std::nullopt;
    const core::Progress progress = task.progress.part(done, 1.0);
    const RenderTask rest{task.scene,
                          task.scan,
                          task.axes,
                          settings_of_paths(task.settings, third.seconds),
                          progress};
    const PrecomputedPart precomputed{&third.transient, third.squared_error, plan.left_out};
    RenderResult result = plan.traces ? (plan.connects ? trace_connections : trace_paths)(
                                            rest,
                                            ThirdBounceScope::NotIntegrable,
                                            precomputed,
                                            plan.averages ? render_smoothed : render_passes)
                                      : render_passes(rest, {nullptr, precomputed});
    add_third_bounces(third, plan, result);
    const auto sources = sources_of_third_bounces(surfaces_of(task.scene), plan);
    result.sources.insert(result.sources.begin(), sources.begin(), sources.end());
    return result;
}

RenderResult sample(const RenderTask& task, const SamplingCosts& costs, double left_out) {
    return (costs.connects() ? trace_connections : trace_paths)(
        task, ThirdBounceScope::All, {nullptr, 0.0, left_out}, render_passes);
}

}  // namespace

RenderResult render_auto(const RenderTask& whole) {
    constexpr double kSoon_s = 0.1;  // less than trial runs take
    RenderTask task = whole;
    const bool integrates = can_integrate(task);
    const bool has_choice = (!integrates || task.settings.target_error) &&
                            task.settings.max_bounces >= first_order(task.scan);
    Plan plan;
    SamplingCosts alone;
    if (has_choice) alone = find_sampling_costs(task, ThirdBounceScope::All);
    if (has_choice && task.settings.target_error &&
        alone.least() < kSoon_s * squared_target(task.settings, plan)) {
        return sample(task, alone, 0.0);
    }
    const auto left_out = leave_out_orders(task);
    if (left_out) {
        plan.left_out = left_out->error;
        if (has_choice) alone = find_sampling_costs(task, ThirdBounceScope::All);
    }
    const Surfaces surfaces = surfaces_of(task.scene);
    plan.traces = surfaces.narrow_lobes || task.settings.max_bounces > 3;
    plan.averages = plan.traces && may_average(task.settings, surfaces);
    std::optional<RenderResult> result;
    if (integrates) {
        if (plan.traces) {
            const SamplingCosts beside = find_sampling_costs(task, ThirdBounceScope::NotIntegrable);
            plan.connects = beside.connects();
            plan.least_cost = beside.least();
        }
        CutLimits limits;
        if (has_choice) limits.work_s = worthwhile_work_s(task, plan, alone);
        result = integrate_and_trace(task, plan, limits);
    }
    if (!result) result = sample(task, alone, plan.left_out);
    result->left_out = left_out;
    return *std::move(result);
}

RenderResult render_third_bounce(const RenderTask& task) {
    return can_integrate(task) ? *integrate_and_trace(task, {}) : render_passes(task, {});
}

}  // namespace renderer
