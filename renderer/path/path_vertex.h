// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/film/time_gate.h"
#include "renderer/scene/scene.h"

namespace renderer {

/// An end of light paths: a point on the relay wall, a lit spot, or an isotropic point in space.
///
/// The factor towards a unit direction w is `strength` * max(0, normal . w) for a Lambertian wall
/// (strength albedo/pi) and `strength` for an isotropic end (1/(4 pi) for a source of 1 W, 1 for a
/// detector of fluence).
struct PathEndpoint {
    core::Vec3 position = core::Vec3::Zero();
    core::Vec3 normal = core::Vec3::UnitZ();
    double strength = 1.0 / core::kPi;
    bool isotropic = false;
    core::Vec3 velocity_m_per_s = core::Vec3::Zero();

    double factor(const core::Vec3& direction) const {
        if (isotropic) return strength;
        const double cosine = normal.dot(direction);
        return cosine > 0.0 ? strength * cosine : 0.0;
    }
};

/// The two ends of a pair's paths, and the length of the segments to laser and detector.
struct PathEndpoints {
    PathEndpoint sensor;
    PathEndpoint light;
    double device_segments_m = 0.0;
    bool coincide = false;  ///< confocal: both ends see the same
};

/// A vertex of a path that is being traced from the sensor towards the light.
struct PathVertex {
    SurfacePoint point;
    core::Vec3 normal = core::Vec3::UnitZ();
    core::Vec3 to_previous = core::Vec3::UnitZ();  ///< unit, towards the sensor side
    Bsdf bsdf;
    /// Throughput of the path up to here over the density of its vertices; includes the cosine at
    /// this vertex.
    double throughput = 0.0;
    OpticalPath optical_path;  ///< from the sensor point to here
    int order = 3;             ///< bounces of the path that goes from here straight to the light
};

/// A vertex at a point whose path is still to be described.
inline PathVertex vertex_at(const Scene& scene,
                            const SurfacePoint& point,
                            const core::Vec3& to_previous) {
    PathVertex vertex;
    vertex.point = point;
    vertex.normal = scene.facet(point.facet).normal;
    vertex.to_previous = to_previous;
    vertex.bsdf = scene.bsdf_at(point);
    return vertex;
}

}  // namespace renderer
