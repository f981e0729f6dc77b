// SPDX-License-Identifier: MIT
#include "renderer/restir/reusable_path.h"

#include <cmath>

namespace renderer {

using core::Vec3;

PathValue PathIntegrand::evaluate(const PathDomain& domain, const ReusablePath& path) const {
    PathValue value;
    value.optical_path = domain.extra();
    if (!dropped_.empty() && dropped_[path.last().facet]) return value;
    // The relay wall has no third bounce.
    if (!domain.seen && path.num_vertices == 1 && !scene_->is_hidden(path.first().facet)) {
        return value;
    }
    const PathEndpoint& light = domain.ends.light;
    double carried = 1.0;
    PathVertex before;  // meaningless until the first vertex is passed
    Vec3 velocity = domain.start_velocity(*scene_);
    for (int i = 0; i <= path.num_vertices; ++i) {
        const bool to_light = i == path.num_vertices;
        const Vec3& from = i == 0 ? domain.start() : before.point.position;
        const Vec3& to = to_light ? light.position : path.at(i).position;
        const Vec3 offset = to - from;
        const double distance2 = offset.squaredNorm();
        const double distance = std::sqrt(distance2);
        const Vec3 direction = offset / distance;
        const Vec3& next_velocity =
            to_light ? light.velocity_m_per_s : scene_->velocity_m_per_s(path.at(i).facet);
        value.optical_path.opl_m += distance;
        value.optical_path.velocity_m_per_s += direction.dot(next_velocity - velocity);
        velocity = next_velocity;
        if (i > 0) {
            if (const auto returned = returned_to_source(before.bsdf)) {
                // Only back to a light at the sensor; the area of the laser spot replaces the
                // missing density.
                if (!domain.ends.coincide || path.num_vertices != 1) return value;
                value.radiance = carried * *returned / laser_spot_m2_ * light.strength;
                return value;
            }
            carried *= walk_->evaluate(before, direction) * std::abs(before.normal.dot(direction));
        } else if (domain.seen) {
            carried = walk_->evaluate(*domain.seen, direction) *
                      std::abs(domain.seen->normal.dot(direction));
        } else {
            carried = domain.ends.sensor.factor(direction);
        }
        if (to_light) {
            value.radiance = carried * light.factor(-direction) / distance2;
            return value;
        }
        before = vertex_at(*scene_, path.at(i), -direction);
        carried *= std::abs(before.normal.dot(direction)) / distance2;
        if (!(carried > 0.0)) return value;
    }
    return value;
}

bool PathIntegrand::is_blocked(const PathDomain& domain,
                               const ReusablePath& path,
                               int segment) const {
    const auto normal_at = [&](int i) -> const Vec3& {
        return scene_->facet(path.at(i).facet).normal;
    };
    const bool to_light = segment == path.num_vertices;
    return scene_->rays().is_blocked(
        segment == 0 ? domain.start() : path.at(segment - 1).position,
        segment == 0 ? domain.start_normal() : normal_at(segment - 1),
        to_light ? domain.ends.light.position : path.at(segment).position,
        to_light ? domain.ends.light.normal : normal_at(segment));
}

bool PathIntegrand::is_any_blocked(const PathDomain& domain,
                                   const ReusablePath& path,
                                   std::uint64_t& num_rays) const {
    // Confocal, a single vertex is seen from the light if it is seen from the sensor.
    const bool there_and_back = domain.ends.coincide && path.num_vertices == 1;
    const int num_segments = there_and_back ? 1 : path.num_vertices + 1;
    for (int segment = 0; segment < num_segments; ++segment) {
        ++num_rays;
        if (is_blocked(domain, path, segment)) return true;
    }
    return false;
}

}  // namespace renderer
