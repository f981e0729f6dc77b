// SPDX-License-Identifier: MIT
#include "renderer/restir/path_candidates.h"

#include "renderer/core/sampling.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec3;

// Shared walks per frame, in multiples of what one pair considers: neighbours then rarely consider
// the same ones, so that their noise is hardly correlated.
constexpr int kStretchesOfSharedWalks = 8;

// The vertex that a connection leaves: of a walk, else what a pixel sees; null on a wall.
const PathVertex* leaving(const PathDomain& domain, const PathVertex* walked) {
    if (walked != nullptr) return walked;
    return domain.seen ? &*domain.seen : nullptr;
}

ConnectionEnds ends_of(const PathDomain& domain, const PathVertex* vertex) {
    return vertex != nullptr ? connection_ends(*vertex, domain.ends.light)
                             : connection_ends(domain.ends);
}

// Lengths that the two last legs of a path may have after a vertex.
OplBand remaining(const PathCandidates::Request& request, const PathVertex* vertex) {
    const double before =
        request.domain.ends.device_legs_m + (vertex != nullptr ? vertex->extent.opl_m : 0.0);
    return {request.opl_begin_m - before, request.opl_end_m - before};
}

}  // namespace

// One call of generate().
struct PathCandidates::Job {
    const Request& request;
    core::Rng& rng;
    const Offer& offer;
    std::uint64_t num_rays = 0;

    const PathDomain& domain() const { return request.domain; }
    const PathEndpoints& ends() const { return request.domain.ends; }
};

PathCandidates::PathCandidates(const Scene& scene,
                               const core::Scan& scan,
                               const SensorPairs& sensor_pairs,
                               const SurfaceWalk& walk,
                               const core::TimeAxis& axis,
                               const RenderSettings& settings)
    : scene_(&scene),
      walk_(&walk),
      excluded_(ExcludedFacets::of(scene, axis, settings)),
      integrand_(scene,
                 walk,
                 settings.laser_spot_m2,
                 settings.exclude == Exclusion::Drop ? excluded_.facets : std::vector<bool>()),
      light_vertices_(scene, walk, sensor_pairs),
      shared_walks_(has_shared_walks(settings.restir.candidates) ? settings.restir.shared_walks
                                                                 : 0),
      max_vertices_(settings.max_bounces - sensor_pairs.first_order() +
                    (sensor_pairs.is_image() ? 0 : 1)) {
    if (has_connections(settings.restir.candidates)) {
        connections_.emplace(scene, excluded_, scan);
    }
}

std::uint64_t PathCandidates::prepare(std::uint64_t seed, std::uint64_t frame) {
    if (shared_walks_ == 0) return 0;
    return light_vertices_.trace(
        kStretchesOfSharedWalks * shared_walks_, max_vertices_, seed, frame);
}

std::uint64_t PathCandidates::generate(const Request& request,
                                       core::Rng& rng,
                                       const Offer& offer) const {
    Job job{request, rng, offer};
    if (request.domain.is_dark || max_vertices_ < 1) return 0;
    for (int i = 0; i < request.effort.walks; ++i) walk_from_sensor(job);
    if (request.effort.shared_walks > 0) try_shared(job);
    return job.num_rays;
}

std::optional<SurfaceWalk::Step> PathCandidates::first_step(const PathDomain& domain,
                                                            const SurfacePoint& next) const {
    if (domain.seen) return walk_->step_to(*domain.seen, next);
    const PathEndpoint& sensor = domain.ends.sensor;
    const Vec3 offset = next.position - sensor.position;
    const double distance2 = offset.squaredNorm();
    SurfaceWalk::Step step;
    step.distance_m = std::sqrt(distance2);
    step.direction = offset / step.distance_m;
    const double per_area =
        std::abs(scene_->facet(next.facet).normal.dot(step.direction)) / distance2;
    step.transport = sensor.factor(step.direction) * per_area;
    if (!(step.transport > 0.0)) return std::nullopt;
    const double area_pdf = scene_->is_hidden(next.facet) ? walk_->area_sampler().pdf_area() : 0.0;
    step.pdf_area = kAreaShareFromWall * area_pdf +
                    (1.0 - kAreaShareFromWall) * sensor.normal.dot(step.direction) / kPi * per_area;
    return step;
}

// The first vertex of a walk; false when there is none or no path through it can be in the gate.
bool PathCandidates::draw_first(Job& job, PathVertex& vertex) const {
    if (job.domain().seen) {
        vertex = *job.domain().seen;
        return walk_->draw_next(vertex, job.rng, job.num_rays).has_value();
    }
    const PathEndpoint& sensor = job.ends().sensor;
    SurfacePoint point;
    const bool from_area = job.rng.uniform() < kAreaShareFromWall;
    const double u1 = job.rng.uniform();
    const double u2 = job.rng.uniform();
    if (from_area) {
        point = walk_->area_sampler().sample(u1, u2);
    } else {
        const core::Mat3 world_from_end =
            core::frame_from_normal(sensor.normal, scene_->tangent_hint(sensor.normal));
        const auto hit =
            scene_->first_hit(sensor.position,
                              sensor.normal,
                              world_from_end * core::sample_cosine_hemisphere({u1, u2}));
        ++job.num_rays;
        if (!hit) return false;
        point = *hit;
    }
    const auto step = first_step(job.domain(), point);
    if (!step) return false;
    // No path through this point is shorter than the one that continues straight to the light.
    const double shortest = job.domain().extra_opl_m() + step->distance_m +
                            (job.ends().light.position - point.position).norm();
    if (shortest >= job.request.opl_end_m) return false;
    if (max_vertices_ == 1 && shortest < job.request.opl_begin_m) return false;
    if (from_area) {
        ++job.num_rays;
        if (scene_->rays().is_blocked(sensor.position,
                                      sensor.normal,
                                      point.position,
                                      scene_->facet(point.facet).normal)) {
            return false;
        }
    }
    PathVertex start;
    start.throughput = 1.0;
    vertex = walk_->advance(start, point, *step, step->pdf_area);
    return true;
}

void PathCandidates::walk_from_sensor(Job& job) const {
    ReusablePath path;
    PathVertex vertex;
    connect_by_ellipsoid(job, nullptr, path);
    if (!draw_first(job, vertex)) return;
    while (true) {
        path.append(vertex.point);
        if (const auto value = value_within(job, path)) {
            const bool seen_back = job.ends().coincide && path.num_vertices == 1;
            job.num_rays += seen_back ? 0 : 1;
            if (seen_back || !integrand_.is_blocked(job.domain(), path, path.num_vertices)) {
                job.offer(path, *value, density(job, path));
            }
        }
        if (path.num_vertices == max_vertices_) return;
        const double shortest = job.ends().device_legs_m + vertex.extent.opl_m +
                                (job.ends().light.position - vertex.point.position).norm();
        if (shortest >= job.request.opl_end_m) return;
        connect_by_ellipsoid(job, &vertex, path);
        if (!walk_->draw_next(vertex, job.rng, job.num_rays)) return;
    }
}

void PathCandidates::connect_by_ellipsoid(Job& job,
                                          const PathVertex* from,
                                          ReusablePath path) const {
    if (!connections_ || path.num_vertices == max_vertices_) return;
    const PathVertex* const vertex = leaving(job.domain(), from);
    const auto draw = connections_->sample(ends_of(job.domain(), vertex),
                                           remaining(job.request, vertex),
                                           job.rng,
                                           lobe_of(job, vertex));
    if (!draw) return;
    path.append(draw->point);
    const auto value = value_within(job, path);
    if (!value) return;
    ++job.num_rays;
    if (integrand_.is_blocked(job.domain(), path, path.num_vertices - 1)) return;
    if (!(job.ends().coincide && path.num_vertices == 1)) {
        ++job.num_rays;
        if (integrand_.is_blocked(job.domain(), path, path.num_vertices)) return;
    }
    job.offer(path, *value, density(job, path));
}

void PathCandidates::try_shared(Job& job) const {
    thread_local std::vector<std::uint32_t> found;
    const int num_walks = std::min(job.request.effort.shared_walks, light_vertices_.num_walks());
    const int first =
        static_cast<int>(job.rng.uniform() * (light_vertices_.num_walks() - num_walks + 1));
    light_vertices_.find(
        job.domain(), {job.request.opl_begin_m, job.request.opl_end_m}, {first, num_walks}, found);
    for (const std::uint32_t vertex : found) {
        const ReusablePath path = light_vertices_.path_from(vertex);
        const auto value = value_within(job, path);
        if (!value) continue;
        ++job.num_rays;
        if (integrand_.is_blocked(job.domain(), path, 0)) continue;
        if (light_vertices_.may_be_dark() && !(job.ends().coincide && path.num_vertices == 1)) {
            ++job.num_rays;
            if (integrand_.is_blocked(job.domain(), path, path.num_vertices)) continue;
        }
        job.offer(path, *value, density(job, path));
    }
}

std::optional<PathValue> PathCandidates::value_within(const Job& job,
                                                      const ReusablePath& path) const {
    const PathValue value = integrand_.evaluate(job.domain(), path);
    if (!(value.radiance > 0.0) || value.extent.opl_m < job.request.opl_begin_m ||
        value.extent.opl_m >= job.request.opl_end_m) {
        return std::nullopt;
    }
    return value;
}

double PathCandidates::density(Job& job, const ReusablePath& path) const {
    const PathCandidates::Effort& effort = job.request.effort;
    double total = 0.0;
    if (effort.walks > 0) {
        const PathDomain& domain = job.domain();
        double walked = 1.0;       // density of the vertices up to here
        double ellipsoidal = 0.0;  // of the last one, by the other technique
        PathVertex vertex;
        for (int i = 0; i < path.num_vertices; ++i) {
            if (connections_ && i + 1 == path.num_vertices) {
                ellipsoidal =
                    walked * ellipsoidal_pdf(job, i == 0 ? nullptr : &vertex, path.last());
            }
            const auto step =
                i == 0 ? first_step(domain, path.at(0)) : walk_->step_to(vertex, path.at(i));
            if (!step) break;  // never: paths without radiance are not offered
            walked *= step->pdf_area;
            PathVertex before = vertex;
            if (i == 0 && domain.seen) before = *domain.seen;
            before.throughput = 1.0;
            vertex = walk_->advance(before, path.at(i), *step, step->pdf_area);
        }
        total += effort.walks * (walked + ellipsoidal);
    }
    if (effort.shared_walks > 0) {
        total += effort.shared_walks * light_vertices_.pdf_area(path);
    }
    return total;
}

double PathCandidates::ellipsoidal_pdf(Job& job,
                                       const PathVertex* from,
                                       const SurfacePoint& point) const {
    const PathVertex* const vertex = leaving(job.domain(), from);
    return connections_->pdf_area(
        ends_of(job.domain(), vertex), remaining(job.request, vertex), point, lobe_of(job, vertex));
}

std::optional<LobeOnFacet> PathCandidates::lobe_of(Job& job, const PathVertex* vertex) const {
    if (vertex == nullptr) return std::nullopt;  // walls are diffuse
    return connections_->lobe_of(*vertex, job.ends().light.position, job.num_rays);
}

}  // namespace renderer
