// SPDX-License-Identifier: MIT
#include "renderer/path/random_walk.h"

#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec3;

// Paths are always continued up to this order; above it Russian roulette may end them.
constexpr int kFirstRouletteOrder = 5;

// Directions with a smaller cosine lie in the plane of the surface, up to rounding. On which side
// of it they lie would be decided by rounding, differently for a sample and for its density.
constexpr double kMinCosine = 1e-12;

}  // namespace

double RandomWalk::area_fraction(const PathVertex& vertex) const {
    return scene_->is_hidden(vertex.point.facet) ? area_fraction_ : kAreaFractionFromWall;
}

double RandomWalk::evaluate(const PathVertex& vertex, const Vec3& outgoing) const {
    if (const auto value = constant_value(vertex.bsdf)) {
        const bool same_side =
            vertex.normal.dot(vertex.to_previous) * vertex.normal.dot(outgoing) > 0.0;
        return same_side ? *value : 0.0;
    }
    const core::Mat3 facet_from_world =
        scene_->facet(vertex.point.facet).world_from_facet().transpose();
    return evaluate_bsdf(
        vertex.bsdf, facet_from_world * vertex.to_previous, facet_from_world * outgoing);
}

double RandomWalk::connection_value(const PathVertex& vertex, const PathEndpoints& ends) const {
    if (const auto returned = returned_to_source(vertex.bsdf)) {
        if (!ends.coincide || vertex.order != 3) return 0.0;
        return vertex.throughput * *returned / laser_spot_m2_ * ends.light.strength;
    }
    const Vec3 offset = ends.light.position - vertex.point.position;
    const double distance2 = offset.squaredNorm();
    const Vec3 direction = offset / std::sqrt(distance2);
    return vertex.throughput * evaluate(vertex, direction) *
           std::abs(vertex.normal.dot(direction)) * ends.light.factor(-direction) / distance2;
}

OpticalPath RandomWalk::optical_path_to_light(const PathVertex& vertex,
                                              const PathEndpoints& ends) const {
    OpticalPath optical_path = vertex.optical_path;
    optical_path.add_segment(ends.light.position - vertex.point.position,
                             scene_->velocity_m_per_s(vertex.point.facet),
                             ends.light.velocity_m_per_s);
    optical_path.opl_m += ends.device_segments_m;
    return optical_path;
}

bool RandomWalk::survives(PathVertex& vertex, core::Rng& rng) const {
    if (vertex.order < kFirstRouletteOrder) return true;
    const double survival = survival_at(vertex, vertex.to_previous);
    if (rng.uniform() >= survival) return false;
    vertex.throughput /= survival;
    return true;
}

double RandomWalk::pdf_direction(const PathVertex& vertex,
                                 const Vec3& direction,
                                 double cosine) const {
    if (traits_of(vertex.bsdf).is_constant) return cosine / kPi;
    const core::Mat3 facet_from_world =
        scene_->facet(vertex.point.facet).world_from_facet().transpose();
    return pdf_bsdf(
        vertex.bsdf, facet_from_world * vertex.to_previous, facet_from_world * direction);
}

std::optional<RandomWalk::Step> RandomWalk::step_to(const PathVertex& vertex,
                                                    const SurfacePoint& next) const {
    const Vec3 offset = next.position - vertex.point.position;
    const double distance2 = offset.squaredNorm();
    if (!(distance2 > 0.0)) return std::nullopt;
    Step step;
    step.distance_m = std::sqrt(distance2);
    step.direction = offset / step.distance_m;
    const double cosine = std::abs(vertex.normal.dot(step.direction));
    const double next_cosine = std::abs(scene_->facet(next.facet).normal.dot(step.direction));
    if (cosine < kMinCosine || next_cosine < kMinCosine) return std::nullopt;
    const double per_area = next_cosine / distance2;
    step.transport = evaluate(vertex, step.direction) * cosine * per_area;
    if (!(step.transport > 0.0)) return std::nullopt;

    const double pdf_direction = this->pdf_direction(vertex, step.direction, cosine);
    const double area_fraction = this->area_fraction(vertex);
    const double area_pdf = scene_->is_hidden(next.facet) ? area_sampler_.pdf_area() : 0.0;
    step.pdf_area = area_fraction * area_pdf + (1.0 - area_fraction) * pdf_direction * per_area;
    return step;
}

double RandomWalk::pdf_area(const PathVertex& vertex,
                            const Vec3& to_previous,
                            const SurfacePoint& next) const {
    PathVertex turned = vertex;
    turned.to_previous = to_previous;
    const auto step = step_to(turned, next);
    return step ? step->pdf_area : 0.0;
}

std::optional<double> RandomWalk::draw_next(PathVertex& vertex,
                                            core::Rng& rng,
                                            std::uint64_t& num_rays) const {
    SurfacePoint next;
    const bool from_area = rng.uniform() < area_fraction(vertex);
    if (from_area) {
        const double u1 = rng.uniform();
        next = area_sampler_.sample(u1, rng.uniform());
    } else {
        const core::Mat3 world_from_facet = scene_->facet(vertex.point.facet).world_from_facet();
        const double u1 = rng.uniform();
        const auto local = sample_bsdf(
            vertex.bsdf, world_from_facet.transpose() * vertex.to_previous, {u1, rng.uniform()});
        if (!local) return std::nullopt;
        ++num_rays;
        const auto hit =
            scene_->first_hit(vertex.point.position, vertex.normal, world_from_facet * *local);
        if (!hit) return std::nullopt;
        next = *hit;
    }
    const auto step = step_to(vertex, next);
    if (!step) return std::nullopt;
    if (from_area) {
        ++num_rays;
        if (scene_->rays().is_blocked(vertex.point.position,
                                      vertex.normal,
                                      next.position,
                                      scene_->facet(next.facet).normal)) {
            return std::nullopt;
        }
    }
    vertex = advance(vertex, next, *step, step->pdf_area);
    return step->pdf_area;
}

PathVertex RandomWalk::advance(const PathVertex& vertex,
                               const SurfacePoint& next,
                               const Step& step,
                               double pdf_area) const {
    PathVertex advanced = vertex_at(*scene_, next, -step.direction);
    advanced.throughput = vertex.throughput * step.transport / pdf_area;
    advanced.optical_path.opl_m = vertex.optical_path.opl_m + step.distance_m;
    advanced.optical_path.velocity_m_per_s =
        vertex.optical_path.velocity_m_per_s +
        step.direction.dot(scene_->velocity_m_per_s(next.facet) -
                           scene_->velocity_m_per_s(vertex.point.facet));
    advanced.order = vertex.order + 1;
    return advanced;
}

}  // namespace renderer
