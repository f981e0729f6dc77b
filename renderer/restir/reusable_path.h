// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/path/path_vertex.h"
#include "renderer/path/random_walk.h"
#include "renderer/settings/estimators.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>

namespace renderer {

/// The surface vertices of a path between its start and the light, beginning at the sensor.
///
/// The first one is the reconnection vertex: it moves when the path is reused; the others stay.
struct ReusablePath {
    static constexpr int kMaxVertices =
        traits_of(Estimator::Restir).max_bounces - 1;  // a camera's first is seen

    int num_vertices = 0;
    std::array<SurfacePoint, kMaxVertices> vertices;
    core::Vec2 pixel_u =
        core::Vec2::Zero();  ///< position within the pixel where an image's path starts

    const SurfacePoint& first() const { return vertices[0]; }
    const SurfacePoint& last() const { return at(num_vertices - 1); }
    const SurfacePoint& at(int i) const { return vertices[static_cast<std::size_t>(i)]; }
    SurfacePoint& at(int i) { return vertices[static_cast<std::size_t>(i)]; }
    void append(const SurfacePoint& point) { at(num_vertices++) = point; }
};

/// The ends of the paths of one pair; of a pixel, of those through one position within it.
struct PathDomain {
    PathEndpoints ends;
    core::Vec2 pixel_u = core::Vec2::Zero();
    std::optional<PathVertex> seen;  ///< of a pixel: the surface point where paths start
    bool is_dark = false;            ///< of a pixel that sees nothing: there are no paths

    const core::Vec3& start() const { return seen ? seen->point.position : ends.sensor.position; }
    const core::Vec3& start_normal() const { return seen ? seen->normal : ends.sensor.normal; }
    /// Length that counts in addition to that of the path itself [m].
    double extra_opl_m() const { return extra().opl_m; }
    /// That length and its rate of change.
    OpticalPath extra() const {
        OpticalPath optical_path = seen ? seen->optical_path : OpticalPath{};
        optical_path.opl_m += ends.device_segments_m;
        return optical_path;
    }
    /// Velocity of the surface where paths start; wall points are at rest.
    core::Vec3 start_velocity(const Scene& scene) const {
        return seen ? scene.velocity_m_per_s(seen->point.facet) : core::Vec3(core::Vec3::Zero());
    }
};

/// The contribution of a path, as a density over the areas at all its vertices.
struct PathValue {
    double radiance = 0.0;     ///< unoccluded [W / (m^2 sr)] per product of areas
    OpticalPath optical_path;  ///< the whole length on the axis, and its rate of change
};

/// Evaluates reusable paths.
class PathIntegrand {
 public:
    /// scene, walk   must outlive this
    /// dropped       per facet, whether paths whose last vertex lies on it are left out; may be
    ///               empty
    PathIntegrand(const Scene& scene,
                  const RandomWalk& walk,
                  double laser_spot_m2,
                  std::vector<bool> dropped)
        : scene_(&scene),
          walk_(&walk),
          laser_spot_m2_(laser_spot_m2),
          dropped_(std::move(dropped)) {}

    /// A path of at least one vertex; radiance 0 when it has no contribution.
    PathValue evaluate(const PathDomain& domain, const ReusablePath& path) const;

    /// Segment `segment` goes to vertex `segment`, the last one to the light.
    bool is_blocked(const PathDomain& domain, const ReusablePath& path, int segment) const;
    /// Whether any segment is blocked; each counts as a ray.
    bool is_any_blocked(const PathDomain& domain,
                        const ReusablePath& path,
                        std::uint64_t& num_rays) const;

 private:
    const Scene* scene_;
    const RandomWalk* walk_;
    double laser_spot_m2_;
    std::vector<bool> dropped_;
};

}  // namespace renderer
