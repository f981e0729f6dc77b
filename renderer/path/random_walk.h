// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/path/path_vertex.h"
#include "renderer/scene/area_sampler.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace renderer {

/// Fraction of the first vertices drawn from the hidden area, the others by direction. Seen from
/// the wall, hidden objects are small and most directions miss them.
inline constexpr double kAreaFractionFromWall = 0.75;
/// The same after a vertex on a hidden surface, where BSDF samples follow lobes and find what is
/// near.
inline constexpr double kAreaFractionBetweenSurfaces = 0.25;

/// Fraction of walks that Russian roulette lets continue from a vertex that they come to from the
/// direction `to_previous`; of those from the light, at every order.
inline double survival_at(const PathVertex& vertex, const core::Vec3& to_previous) {
    constexpr double kLeast = 0.1;
    const double cosine = std::abs(vertex.normal.dot(to_previous));
    return std::clamp(reflects_at_most(vertex.bsdf, cosine), kLeast, 1.0);
}

/// How paths continue from surface vertices and connect to the light; shared by the estimators.
///
/// The next vertex is drawn either from the hidden area or from the BSDF; both kinds are weighted
/// by the balance heuristic (source [Veach1997]).
class RandomWalk {
 public:
    /// A segment between two surface points, without visibility.
    struct Step {
        core::Vec3 direction;  ///< unit, away from the first point
        double distance_m = 0.0;
        double transport =
            0.0;                ///< BSDF at the first point times both cosines / distance^2 [1/m^2]
        double pdf_area = 0.0;  ///< with which draw_next() takes it [1/m^2]
    };

    /// scene           must outlive the walk
    /// laser_spot_m2   area of the laser spot, for retroreflectors
    /// area_fraction   of the vertices after one on a hidden surface, drawn from the hidden area
    RandomWalk(const Scene& scene,
               double laser_spot_m2,
               double area_fraction = kAreaFractionBetweenSurfaces)
        : scene_(&scene),
          area_sampler_(scene),
          laser_spot_m2_(laser_spot_m2),
          area_fraction_(area_fraction) {}

    const AreaSampler& area_sampler() const { return area_sampler_; }
    /// Fraction of the next vertices that draw_next() draws from the hidden area.
    double area_fraction(const PathVertex& vertex) const;

    /// BSDF value [1/sr] at a vertex towards `outgoing` (unit).
    double evaluate(const PathVertex& vertex, const core::Vec3& outgoing) const;

    /// Unoccluded contribution of the path that connects `vertex` to the light.
    double connection_value(const PathVertex& vertex, const PathEndpoints& ends) const;
    /// Length and velocity of that path, segments to the devices included.
    OpticalPath optical_path_to_light(const PathVertex& vertex, const PathEndpoints& ends) const;
    bool light_is_hidden(const PathVertex& vertex, const PathEndpoints& ends) const {
        return scene_->rays().is_blocked(
            vertex.point.position, vertex.normal, ends.light.position, ends.light.normal);
    }

    /// Russian roulette: false when the path ends here, else its throughput is compensated.
    bool survives(PathVertex& vertex, core::Rng& rng) const;

    /// The step from a vertex to a point; nothing when its transport is zero.
    std::optional<Step> step_to(const PathVertex& vertex, const SurfacePoint& next) const;

    /// Density [1/m^2] with which draw_next() goes from a vertex to a point, if the vertex is come
    /// to from the direction `to_previous` instead of its own; 0 when nothing is carried there.
    double pdf_area(const PathVertex& vertex,
                    const core::Vec3& to_previous,
                    const SurfacePoint& next) const;

    /// Replaces `vertex` by the next one of the path.
    ///
    /// num_rays   raised by the rays traced
    /// returns    the step's density pdf_area [1/m^2]; nothing when the path ends
    std::optional<double> draw_next(PathVertex& vertex,
                                    core::Rng& rng,
                                    std::uint64_t& num_rays) const;

    /// The vertex after a step, its throughput divided by the density `pdf_area`.
    PathVertex advance(const PathVertex& vertex,
                       const SurfacePoint& next,
                       const Step& step,
                       double pdf_area) const;

 private:
    /// Density [1/sr] with which the BSDF draws a direction on the side that the vertex is come to
    /// from.
    ///
    /// cosine   of the direction with the normal, positive
    double pdf_direction(const PathVertex& vertex,
                         const core::Vec3& direction,
                         double cosine) const;

    const Scene* scene_;
    AreaSampler area_sampler_;
    double laser_spot_m2_;
    double area_fraction_;
};

}  // namespace renderer
