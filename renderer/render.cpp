// SPDX-License-Identifier: MIT
#include "renderer/render.h"

#include "renderer/ellipsoidal_render.h"
#include "renderer/pass_render.h"
#include "renderer/path/path_tracer.h"
#include "renderer/restir_render.h"
#include "renderer/sensor_render.h"
#include "renderer/smoothed_render.h"
#include "renderer/third_bounce/third_bounce.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

namespace renderer {
namespace {

// Whether any hidden surface that reflects is integrable, and whether any has a narrow lobe.
struct Surfaces {
    bool integrable = false;
    bool narrow_lobes = false;
};

Surfaces surfaces_of(const Scene& scene) {
    Surfaces surfaces;
    for (const Object& object : scene.objects()) {
        if (object.role == Role::RelayWall || !reflects(object.material)) continue;
        (is_integrable(object.material) ? surfaces.integrable : surfaces.narrow_lobes) = true;
    }
    return surfaces;
}

// The integrator knows wall points, wide lobes and no velocities; velocities need wall points that
// stand still.
void require_possible(const RenderTask& task) {
    if (task.settings.method == Estimator::ThirdBounce) {
        if (task.axes.velocity) {
            throw core::Error("render.method",
                              "found third_bounce with velocity_axis",
                              "must be auto, path, ellipsoidal or restir: it knows no velocities");
        }
        if (!task.scan.has_wall()) {
            throw core::Error("render.method",
                              "found third_bounce for a camera",
                              "must be auto or path: there are no wall points");
        }
        for (const Object& object : task.scene.objects()) {
            const Material& material = object.material;
            const bool adds = object.role != Role::RelayWall && reflects(material);
            if (!adds || is_integrable(material)) continue;
            throw core::Error("render.method",
                              fmt::format("found third_bounce for object {} ({})",
                                          object.name,
                                          core::enum_name(material.model)),
                              "must be auto or path for surfaces that it cannot integrate, such as "
                              "narrow glossy lobes");
        }
    }
    if (!task.axes.velocity || !task.scan.has_wall()) return;
    for (const Object& object : task.scene.objects()) {
        if (object.role != Role::RelayWall || object.velocity_m_per_s.norm() == 0.0) continue;
        throw core::Error("velocity_axis",
                          fmt::format("found a relay wall that moves ({})", object.name),
                          "must be left out, or the wall stand still: its points do");
    }
}

// Where paths give orders from 4 on alone, which vary slowly over wall points and bins, `auto`
// averages them over neighbours if an error allows it.
bool smooths(const RenderTask& task, std::optional<ThirdBounceScope> scope) {
    const RenderSettings& settings = task.settings;
    return settings.method == Estimator::Auto && settings.target_error && !settings.by_order &&
           !settings.variance && scope == ThirdBounceScope::NotIntegrable &&
           !surfaces_of(task.scene).narrow_lobes;
}

// scope   which third bounces paths compute, beside all higher orders; nothing: no paths
RenderResult trace_paths(const RenderTask& task,
                         std::optional<ThirdBounceScope> scope,
                         const PrecomputedPart& precomputed) {
    PassWork work{nullptr, precomputed};
    if (scope && (!task.scan.has_wall() || task.settings.max_bounces >= 3)) {
        work.tracer = std::make_shared<const PathTracer>(task.scene, task.settings, *scope);
    }
    RenderResult result =
        smooths(task, scope) ? render_smoothed(task, work) : render_passes(task, work);
    const int first = scope == ThirdBounceScope::NotIntegrable ? 4 : first_order(task.scan);
    if (scope && (!task.scan.has_wall() || task.settings.max_bounces >= first)) {
        result.sources.push_back({first, task.settings.max_bounces, Estimator::Path, "all"});
    }
    return result;
}

// `auto` need not compute orders that are far below the error asked for. What it leaves out counts
// as part of the error.
std::optional<LeftOutOrders> leave_out_orders(RenderTask& task) {
    constexpr double kShareOfTarget = 0.5;
    const bool may = task.settings.method == Estimator::Auto && task.settings.target_error &&
                     !task.settings.by_order && task.settings.max_bounces > 3;
    if (!may) return std::nullopt;
    task.progress.update(0.0, "trial runs for the orders of bounces");
    const BounceTruncation orders =
        find_bounce_truncation(task, kShareOfTarget * *task.settings.target_error);
    if (orders.last == task.settings.max_bounces) return std::nullopt;
    const LeftOutOrders left_out{orders.last + 1, task.settings.max_bounces, orders.left_out};
    task.settings.max_bounces = orders.last;
    return left_out;
}

// Third bounces by the integrator, what is left by paths. When both are needed, the integrator,
// which converges faster, gets half of the error that may be left or a quarter of the time; more of
// the error where averages over neighbours make paths cheap.
RenderResult integrate_and_trace(const RenderTask& task, double left_out) {
    constexpr double kShareOfTarget = 0.5;
    constexpr double kShareBesideAverages = 0.7;
    constexpr double kShareOfTime = 0.25;
    const Surfaces surfaces = surfaces_of(task.scene);
    std::optional<ThirdBounceScope> scope;
    if (task.settings.method != Estimator::ThirdBounce &&
        (surfaces.narrow_lobes || task.settings.max_bounces > 3)) {
        scope = ThirdBounceScope::NotIntegrable;
    }
    const bool is_all = !scope;
    RenderSettings integration = task.settings;
    if (const auto target = task.settings.target_error) {
        const double allowed = std::sqrt(std::max(0.0, std::pow(*target, 2) - left_out * left_out));
        const double share = smooths(task, scope) ? kShareBesideAverages : kShareOfTarget;
        integration.target_error = is_all ? allowed : share * allowed;
    }
    const auto seconds = task.settings.seconds;
    if (seconds && !is_all) integration.seconds = kShareOfTime * *seconds;
    const double done = is_all ? 1.0 : 0.1;
    const ThirdBounce third = integrate_third_bounce(
        task.scene, task.scan.wall(), task.axes.time, integration, task.progress.part(0.0, done));
    const core::Progress rest = task.progress.part(done, 1.0);
    RenderTask tracing{task.scene, task.scan, task.axes, task.settings, rest};
    if (seconds) {
        tracing.settings.seconds =
            std::max((1.0 - kShareOfTime) * *seconds, *seconds - third.seconds);
    }
    const PrecomputedPart precomputed{&third.transient, third.squared_error, left_out};
    RenderResult result = trace_paths(tracing, scope, precomputed);
    result.capture.transient += third.transient;
    if (task.settings.by_order) result.capture.by_order[2] += third.transient;
    result.element_tolerance = third.element_tolerance;
    if (!third.estimated_error) {
        result.estimated_error.reset();
    } else if (is_all) {
        result.estimated_error = std::hypot(*third.estimated_error, left_out);
    }
    std::vector<OrderSource> sources{{3, 3, Estimator::ThirdBounce, "all"}};
    if (surfaces.narrow_lobes) {
        sources[0].surfaces = "all but narrow glossy lobes and dielectrics";
        sources.push_back({3, 3, Estimator::Path, "narrow glossy lobes and dielectrics"});
    }
    result.sources.insert(result.sources.begin(), sources.begin(), sources.end());
    result.num_rays += third.num_rays;
    result.seconds += third.seconds;
    result.interrupted = result.interrupted || third.interrupted;
    return result;
}

}  // namespace

RenderResult render(const Scene& scene,
                    const core::Scan& scan,
                    const core::HistogramAxes& axes,
                    const RenderSettings& settings,
                    const core::Progress& progress) {
    if (const auto* zones = scan.as<core::SensorScan>()) {
        const auto render_points = [&](const Scene& part,
                                       const core::Scan& points,
                                       const RenderSettings& of_part,
                                       const core::Progress& of_points) {
            return render(part, points, axes, of_part, of_points);
        };
        return render_zones(scene, *zones, axes, settings, render_points, progress);
    }
    RenderTask task{scene, scan, axes, settings, progress};
    require_possible(task);
    if (settings.method == Estimator::Ellipsoidal) return render_ellipsoidal(task);
    if (settings.method == Estimator::Restir) return render_restir(task);
    const auto left_out = leave_out_orders(task);
    const double left_out_error = left_out ? left_out->error : 0.0;
    const bool integrates = settings.method != Estimator::Path && scan.has_wall() &&
                            !axes.velocity && settings.max_bounces >= 3 &&
                            settings.gate == GateShape::Box && surfaces_of(scene).integrable;
    RenderResult result =
        integrates ? integrate_and_trace(task, left_out_error)
                   : trace_paths(task, ThirdBounceScope::All, {nullptr, 0.0, left_out_error});
    result.left_out = left_out;
    return result;
}

}  // namespace renderer
