// SPDX-License-Identifier: MIT
#include "renderer/estimators.h"

#include "renderer/auto_render.h"
#include "renderer/ellipsoidal_render.h"
#include "renderer/path_render.h"
#include "renderer/restir_render.h"

#include <fmt/core.h>

#include <array>

namespace renderer {
namespace {

// In the order of kEstimators.
constexpr std::array kMethods{
    EstimatorMethod{render_auto},
    EstimatorMethod{render_by_paths},
    EstimatorMethod{render_third_bounce},
    EstimatorMethod{render_ellipsoidal},
    EstimatorMethod{render_restir, make_restir_frame_renderer},
};
static_assert(kMethods.size() == kEstimators.size());

void require_trait(const RenderTask& task, bool EstimatorTraits::*trait, const std::string& with) {
    const EstimatorTraits& method = traits_of(task.settings.method);
    core::require(method.*trait,
                  "render.method",
                  fmt::format("{} {}", method.name, with),
                  estimators_that(trait));
}

void require_wall_at_rest(const Scene& scene) {
    for (const Object& object : scene.objects()) {
        if (object.role != Role::RelayWall || object.velocity_m_per_s.norm() == 0.0) continue;
        throw core::Error("velocity_axis",
                          fmt::format("found a relay wall that moves ({})", object.name),
                          "must be left out, or the wall stand still: its points do");
    }
}

}  // namespace

Surfaces surfaces_of(const Scene& scene) {
    Surfaces surfaces;
    for (const Object& object : scene.objects()) {
        if (object.role == Role::RelayWall || !reflects(object.material)) continue;
        (is_integrable(object.material) ? surfaces.integrable : surfaces.narrow_lobes) = true;
    }
    return surfaces;
}

const EstimatorMethod& method_of(Estimator estimator) {
    return kMethods[static_cast<std::size_t>(estimator)];
}

void require_possible(const RenderTask& task) {
    const bool is_of_sensor = task.scan.as<core::SensorScan>() != nullptr;
    if (is_of_sensor) require_trait(task, &EstimatorTraits::renders_sensors, "with a sensor");
    if (!task.scan.has_wall()) {
        require_trait(task, &EstimatorTraits::renders_images, "for a camera");
    }
    if (task.axes.velocity) {
        require_trait(task, &EstimatorTraits::renders_velocities, "with velocity_axis");
    }
    for (const Object& object : task.scene.objects()) {
        const Material& material = object.material;
        if (object.role == Role::RelayWall || !reflects(material) || is_integrable(material)) {
            continue;
        }
        require_trait(
            task,
            &EstimatorTraits::renders_all_surfaces,
            fmt::format("for object {} ({})", object.name, core::enum_name(material.model)));
    }
    if (!task.axes.velocity) return;
    if (is_of_sensor) {
        throw core::Error("velocity_axis", "found with a sensor", "must be left out");
    }
    if (task.scan.has_wall()) require_wall_at_rest(task.scene);
}

}  // namespace renderer
