// SPDX-License-Identifier: MIT
#include "renderer/render.h"

#include "renderer/bounce_truncation.h"
#include "renderer/ellipsoidal_render.h"
#include "renderer/pass_render.h"
#include "renderer/path/sensor_pairs.h"
#include "renderer/restir_render.h"
#include "renderer/third_bounce/third_bounce.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

// Whether any hidden surface that reflects is integrable, and whether any is not.
struct Surfaces {
    bool integrable = false;
    bool others = false;
};

Surfaces surfaces_of(const Scene& scene) {
    Surfaces surfaces;
    for (const Object& object : scene.objects()) {
        if (object.role == Role::RelayWall || object.material.albedo == 0.0) continue;
        (is_integrable(object.material) ? surfaces.integrable : surfaces.others) = true;
    }
    return surfaces;
}

void require_integrable(const Surfaces& surfaces) {
    if (!surfaces.others) return;
    throw core::Error("render.method",
                      "found third_bounce for a scene with narrow glossy lobes",
                      "must be auto or path for such surfaces");
}

void require_wall(const core::Scan& scan) {
    if (!scan.camera) return;
    throw core::Error("render.method",
                      "found third_bounce for a camera",
                      "must be auto or path: there are no wall points");
}

// Velocities need paths with vertices, and wall points that stand still.
void require_velocities(const Scene& scene,
                        const core::Scan& scan,
                        const RenderSettings& settings) {
    if (settings.method == Estimator::ThirdBounce) {
        throw core::Error("render.method",
                          "found third_bounce with velocity_axis",
                          "must be auto, path, ellipsoidal or restir: it knows no velocities");
    }
    if (scan.camera) return;
    for (const Object& object : scene.objects()) {
        if (object.role != Role::RelayWall || object.velocity_m_per_s.norm() == 0.0) continue;
        throw core::Error("velocity_axis",
                          fmt::format("found a relay wall that moves ({})", object.name),
                          "must be left out, or the wall stand still: its points do");
    }
}

// Which part of the third bounce path tracing computes; it computes all higher orders.
enum class PathShare { Everything, NotIntegrable, Nothing };

// What is left for path tracing when third_bounce does its part. Nothing: no higher orders either.
PathShare share_of_paths(const RenderSettings& settings, const Surfaces& surfaces) {
    if (settings.method == Estimator::ThirdBounce) return PathShare::Nothing;
    return surfaces.others || settings.max_bounces > 3 ? PathShare::NotIntegrable
                                                       : PathShare::Nothing;
}

void add(const core::Transient& part, core::Transient& sum) {
    std::transform(part.values().begin(),
                   part.values().end(),
                   sum.values().begin(),
                   sum.values().begin(),
                   [](float a, float b) { return a + b; });
}

void list_path_orders(const core::Scan& scan,
                      const RenderSettings& settings,
                      PathShare share,
                      RenderResult& result) {
    if (scan.camera) {
        result.sources.push_back({first_order(scan), settings.max_bounces, Estimator::Path, "all"});
        return;
    }
    if (share == PathShare::Nothing || settings.max_bounces < 3) return;
    if (share == PathShare::Everything) {
        result.sources.push_back({3, settings.max_bounces, Estimator::Path, "all"});
        return;
    }
    if (settings.max_bounces > 3) {
        result.sources.push_back({4, settings.max_bounces, Estimator::Path, "all"});
    }
}

RenderResult trace_paths(const Scene& scene,
                         const core::Scan& scan,
                         const core::HistogramAxes& axes,
                         const RenderSettings& settings,
                         PathShare share,
                         const PrecomputedPart& precomputed,
                         const core::Progress& progress) {
    PassWork work{{}, precomputed};
    if (share != PathShare::Nothing && (scan.camera || settings.max_bounces >= 3)) {
        work.estimate =
            path_estimator(scene,
                           scan,
                           settings,
                           share == PathShare::NotIntegrable ? ThirdBounceScope::NotIntegrable
                                                             : ThirdBounceScope::All);
    }
    return render_passes(scene, scan, axes, settings, work, progress);
}

// `auto` needs not compute orders that are far below the error asked for. What it leaves out goes
// into the error.
double leave_out_orders(const Scene& scene,
                        const core::Scan& scan,
                        const core::HistogramAxes& axes,
                        RenderSettings& settings,
                        std::vector<std::string>& warnings) {
    constexpr double kShareOfTarget = 0.5;
    const bool may = settings.method == Estimator::Auto && settings.target_error &&
                     !settings.by_order && settings.max_bounces > 3;
    if (!may) return 0.0;
    const BounceTruncation orders = find_bounce_truncation(
        scene, scan, axes, settings, kShareOfTarget * *settings.target_error);
    if (orders.last == settings.max_bounces) return 0.0;
    warnings.push_back(fmt::format("orders {} to {} are left out: below {:.2g} of H (relative L2)",
                                   orders.last + 1,
                                   settings.max_bounces,
                                   orders.left_out));
    settings.max_bounces = orders.last;
    return orders.left_out;
}

// Third bounces by the integrator, what is left by paths. When both are needed, the integrator,
// which converges faster, gets half of the error or a quarter of the time.
RenderResult integrate_and_trace(const Scene& scene,
                                 const core::Scan& scan,
                                 const core::HistogramAxes& axes,
                                 const RenderSettings& settings,
                                 double left_out,
                                 const core::Progress& progress) {
    constexpr double kShareOfTarget = 0.5;
    constexpr double kShareOfTime = 0.25;
    const Surfaces surfaces = surfaces_of(scene);
    const PathShare share = share_of_paths(settings, surfaces);
    const bool is_all = share == PathShare::Nothing;
    RenderSettings integration = settings;
    RenderSettings tracing = settings;
    if (settings.target_error) {
        const double allowed =
            std::sqrt(std::max(0.0, std::pow(*settings.target_error, 2) - left_out * left_out));
        integration.target_error = is_all ? allowed : kShareOfTarget * *settings.target_error;
    }
    if (settings.seconds && !is_all) integration.seconds = kShareOfTime * *settings.seconds;
    const double done = is_all ? 1.0 : 0.1;
    const ThirdBounce third =
        integrate_third_bounce(scene, scan, axes.time, integration, progress.part(0.0, done));
    if (settings.seconds) {
        tracing.seconds =
            std::max((1.0 - kShareOfTime) * *settings.seconds, *settings.seconds - third.seconds);
    }
    const PrecomputedPart precomputed{&third.transient, third.squared_error, left_out};
    RenderResult result =
        trace_paths(scene, scan, axes, tracing, share, precomputed, progress.part(done, 1.0));
    add(third.transient, result.capture.transient);
    if (settings.by_order) add(third.transient, result.capture.by_order[2]);
    if (is_all) result.estimated_error = std::hypot(third.estimated_error, left_out);
    OrderSource integrated{3, 3, Estimator::ThirdBounce, "all"};
    if (surfaces.others) integrated.surfaces = "all but narrow glossy lobes";
    result.sources.push_back(integrated);
    if (surfaces.others) {
        result.sources.push_back({3, 3, Estimator::Path, "narrow glossy lobes"});
    }
    list_path_orders(scan, settings, share, result);
    result.num_rays += third.num_rays;
    result.seconds += third.seconds;
    result.interrupted = result.interrupted || third.interrupted;
    return result;
}

}  // namespace

RenderResult render(const Scene& scene,
                    const core::Scan& scan,
                    const core::HistogramAxes& axes,
                    const RenderSettings& asked,
                    const core::Progress& progress) {
    if (axes.velocity) require_velocities(scene, scan, asked);
    if (asked.method == Estimator::Ellipsoidal) {
        return render_ellipsoidal(scene, scan, axes, asked, progress);
    }
    if (asked.method == Estimator::Restir) {
        return render_restir({std::shared_ptr<const Scene>(), &scene}, scan, axes, asked, progress);
    }
    const Surfaces surfaces = surfaces_of(scene);
    if (asked.method == Estimator::ThirdBounce) {
        require_wall(scan);
        require_integrable(surfaces);
    }
    RenderSettings settings = asked;
    std::vector<std::string> warnings;
    const double left_out = leave_out_orders(scene, scan, axes, settings, warnings);
    const bool integrates = settings.method != Estimator::Path && !scan.camera && !axes.velocity &&
                            settings.max_bounces >= 3 && settings.gate == GateShape::Box &&
                            surfaces.integrable;
    RenderResult result;
    if (integrates) {
        result = integrate_and_trace(scene, scan, axes, settings, left_out, progress);
    } else {
        result = trace_paths(
            scene, scan, axes, settings, PathShare::Everything, {nullptr, 0.0, left_out}, progress);
        list_path_orders(scan, settings, PathShare::Everything, result);
    }
    result.warnings.insert(result.warnings.end(), warnings.begin(), warnings.end());
    return result;
}

}  // namespace renderer
