// SPDX-License-Identifier: MIT
#include "renderer/restir/path_candidates.h"

#include "renderer/core/sampling.h"
#include "renderer/ellipsoidal/hierarchy_cut.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec3;

// Shared walks per frame, in multiples of what one pair tries: neighbouring pairs then rarely try
// the same walks, so that their noise is hardly correlated.
constexpr int kStretchesOfSharedWalks = 8;

// Of a pair's cut through the hierarchy, at least: enough to tell facets apart.
constexpr std::size_t kMinEntriesOfCut = 32;

}  // namespace

// One call of generate().
class PathCandidates::Job {
 public:
    Job(const PathCandidates& candidates,
        const Request& request,
        core::Rng& rng,
        const Offer& offer)
        : candidates_(candidates),
          scene_(*candidates.scene_),
          walk_(*candidates.walk_),
          max_vertices_(candidates.max_vertices_),
          request_(request),
          domain_(request.domain),
          ends_(request.domain.ends),
          rng_(rng),
          offer_(offer) {}

    void connect_from_wall();
    void walk_from_sensor();
    void try_shared();
    std::uint64_t num_rays() const { return num_rays_; }

 private:
    // Where a connection starts: at a vertex of the walk, else at what a pixel sees or a wall
    // point.
    struct Start {
        ConnectionEnds ends;
        OplBand lengths;  ///< of the two segments to the light
        std::optional<LobeOnFacet> lobe;
    };
    Start start_of_connection(const PathVertex* walked);
    void connect_by_ellipsoid(const PathVertex* walked, ReusablePath path);
    void offer_connection(const SurfacePoint& point, ReusablePath path);
    bool draw_first(PathVertex& vertex);
    std::optional<RandomWalk::Step> first_step(const SurfacePoint& next) const;
    std::optional<PathValue> value_within(const ReusablePath& path) const;
    double density(const ReusablePath& path);
    double density_of_walks(const ReusablePath& path);
    bool is_blocked(const ReusablePath& path, int segment);
    // Confocal, a single vertex is seen from the light if it is seen from the sensor.
    bool is_seen_back(const ReusablePath& path) const {
        return ends_.coincide && path.num_vertices == 1;
    }
    double opl_straight_to_light(const PathVertex& vertex) const {
        return ends_.device_segments_m + vertex.optical_path.opl_m +
               (ends_.light.position - vertex.point.position).norm();
    }

    const PathCandidates& candidates_;
    const Scene& scene_;
    const RandomWalk& walk_;
    int max_vertices_;
    const Request& request_;
    const PathDomain& domain_;
    const PathEndpoints& ends_;
    core::Rng& rng_;
    const Offer& offer_;
    std::uint64_t num_rays_ = 0;
    std::optional<HierarchyCut> cut_;  ///< of the connections from a wall point
};

PathCandidates::PathCandidates(const Scene& scene,
                               const core::Scan& scan,
                               const SensorPairs& sensor_pairs,
                               const RandomWalk& walk,
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
    if (request.domain.is_dark || max_vertices_ < 1) return 0;
    Job job(*this, request, rng, offer);
    if (request.effort.connections > 0 && !request.domain.seen) job.connect_from_wall();
    for (int i = 0; i < request.effort.walks; ++i) job.walk_from_sensor();
    if (request.effort.shared_walks > 0) job.try_shared();
    return job.num_rays();
}

std::optional<RandomWalk::Step> PathCandidates::Job::first_step(const SurfacePoint& next) const {
    if (domain_.seen) return walk_.step_to(*domain_.seen, next);
    const PathEndpoint& sensor = ends_.sensor;
    const Vec3 offset = next.position - sensor.position;
    const double distance2 = offset.squaredNorm();
    RandomWalk::Step step;
    step.distance_m = std::sqrt(distance2);
    step.direction = offset / step.distance_m;
    const double per_area =
        std::abs(scene_.facet(next.facet).normal.dot(step.direction)) / distance2;
    step.transport = sensor.factor(step.direction) * per_area;
    if (!(step.transport > 0.0)) return std::nullopt;
    const double area_pdf = scene_.is_hidden(next.facet) ? walk_.area_sampler().pdf_area() : 0.0;
    step.pdf_area = kAreaFractionFromWall * area_pdf + (1.0 - kAreaFractionFromWall) *
                                                           sensor.normal.dot(step.direction) / kPi *
                                                           per_area;
    return step;
}

// The first vertex of a walk; false when there is none or no path through it can be in the gate.
bool PathCandidates::Job::draw_first(PathVertex& vertex) {
    if (domain_.seen) {
        vertex = *domain_.seen;
        return walk_.draw_next(vertex, rng_, num_rays_).has_value();
    }
    const PathEndpoint& sensor = ends_.sensor;
    SurfacePoint point;
    const bool from_area = rng_.uniform() < kAreaFractionFromWall;
    const double u1 = rng_.uniform();
    const double u2 = rng_.uniform();
    if (from_area) {
        point = walk_.area_sampler().sample(u1, u2);
    } else {
        const core::Mat3 world_from_end =
            core::frame_from_normal(sensor.normal, scene_.tangent_hint(sensor.normal));
        const auto hit =
            scene_.first_hit(sensor.position,
                             sensor.normal,
                             world_from_end * core::sample_cosine_hemisphere({u1, u2}));
        ++num_rays_;
        if (!hit) return false;
        point = *hit;
    }
    const auto step = first_step(point);
    if (!step) return false;
    // No path through this point is shorter than the one that continues straight to the light.
    const double shortest =
        ends_.device_segments_m + step->distance_m + (ends_.light.position - point.position).norm();
    if (shortest >= request_.opl_end_m) return false;
    if (max_vertices_ == 1 && shortest < request_.opl_begin_m) return false;
    PathVertex start;
    start.throughput = 1.0;
    vertex = walk_.advance(start, point, *step, step->pdf_area);
    if (!from_area) return true;
    ++num_rays_;
    return !scene_.rays().is_blocked(sensor.position, sensor.normal, point.position, vertex.normal);
}

bool PathCandidates::Job::is_blocked(const ReusablePath& path, int segment) {
    ++num_rays_;
    return candidates_.integrand_.is_blocked(domain_, path, segment);
}

void PathCandidates::Job::walk_from_sensor() {
    ReusablePath path;
    PathVertex vertex;
    if (!cut_) connect_by_ellipsoid(nullptr, path);
    if (!draw_first(vertex)) return;
    while (true) {
        path.append(vertex.point);
        const auto value = value_within(path);
        if (value && (is_seen_back(path) || !is_blocked(path, path.num_vertices))) {
            offer_(path, *value, density(path));
        }
        if (path.num_vertices == max_vertices_) return;
        if (opl_straight_to_light(vertex) >= request_.opl_end_m) return;
        connect_by_ellipsoid(&vertex, path);
        if (!walk_.draw_next(vertex, rng_, num_rays_)) return;
    }
}

PathCandidates::Job::Start PathCandidates::Job::start_of_connection(const PathVertex* walked) {
    const PathVertex* const vertex = walked == nullptr && domain_.seen ? &*domain_.seen : walked;
    if (vertex == nullptr) {
        const double segments = ends_.device_segments_m;
        return {connection_ends(ends_),
                {request_.opl_begin_m - segments, request_.opl_end_m - segments},
                std::nullopt};  // walls are diffuse
    }
    const double before = ends_.device_segments_m + vertex->optical_path.opl_m;
    return {connection_ends(*vertex, ends_.light),
            {request_.opl_begin_m - before, request_.opl_end_m - before},
            candidates_.connections_->lobe_of(*vertex, ends_.light.position, num_rays_)};
}

void PathCandidates::Job::connect_by_ellipsoid(const PathVertex* walked, ReusablePath path) {
    const auto& connections = candidates_.connections_;
    if (!connections || path.num_vertices == max_vertices_) return;
    const Start start = start_of_connection(walked);
    const auto draw = connections->sample(start.ends, start.lengths, rng_, start.lobe);
    if (draw) offer_connection(draw->point, path);
}

void PathCandidates::Job::connect_from_wall() {
    const ConnectionTechnique& connections = *candidates_.connections_;
    const int count = request_.effort.connections;
    const Start start = start_of_connection(nullptr);
    cut_.emplace(connections.hierarchy());
    cut_->rebuild(
        start.ends, start.lengths, std::max(kMinEntriesOfCut, static_cast<std::size_t>(count)));
    if (cut_->empty()) return;
    std::size_t hint = 0;
    for (int i = 0; i < count; ++i) {
        const double u = (i + rng_.uniform()) / count;
        const auto draw = connections.sample(*cut_, u, hint, rng_);
        if (draw) offer_connection(draw->point, {});
    }
}

// Offers a path that a connection ends.
void PathCandidates::Job::offer_connection(const SurfacePoint& point, ReusablePath path) {
    path.append(point);
    const auto value = value_within(path);
    if (!value || is_blocked(path, path.num_vertices - 1)) return;
    if (!is_seen_back(path) && is_blocked(path, path.num_vertices)) return;
    offer_(path, *value, density(path));
}

void PathCandidates::Job::try_shared() {
    thread_local std::vector<std::uint32_t> found;
    const LightVertexCache& cache = candidates_.light_vertices_;
    const int num_walks = std::min(request_.effort.shared_walks, cache.num_walks());
    const int first = static_cast<int>(rng_.uniform() * (cache.num_walks() - num_walks + 1));
    cache.find(domain_, {request_.opl_begin_m, request_.opl_end_m}, {first, num_walks}, found);
    for (const std::uint32_t vertex : found) {
        const ReusablePath path = cache.path_from(vertex);
        const auto value = value_within(path);
        if (!value || is_blocked(path, 0)) continue;
        if (cache.may_be_dark() && !is_seen_back(path) && is_blocked(path, path.num_vertices)) {
            continue;
        }
        offer_(path, *value, density(path));
    }
}

std::optional<PathValue> PathCandidates::Job::value_within(const ReusablePath& path) const {
    const PathValue value = candidates_.integrand_.evaluate(domain_, path);
    if (!(value.radiance > 0.0) || value.optical_path.opl_m < request_.opl_begin_m ||
        value.optical_path.opl_m >= request_.opl_end_m) {
        return std::nullopt;
    }
    return value;
}

double PathCandidates::Job::density(const ReusablePath& path) {
    const Effort& effort = request_.effort;
    double total = 0.0;
    if (effort.walks > 0) total += effort.walks * density_of_walks(path);
    if (cut_ && !cut_->empty() && path.num_vertices == 1) {
        total += effort.connections * candidates_.connections_->pdf_area(*cut_, path.last());
    }
    if (effort.shared_walks > 0) {
        total += effort.shared_walks * candidates_.light_vertices_.pdf_area(path);
    }
    return total;
}

// Of one walk and the connections from its vertices.
double PathCandidates::Job::density_of_walks(const ReusablePath& path) {
    double walked = 1.0;       // density of the vertices up to here
    double ellipsoidal = 0.0;  // of the last one, by the other technique
    PathVertex vertex;
    for (int i = 0; i < path.num_vertices; ++i) {
        const bool is_drawn_from_cut = cut_ && i == 0;
        if (candidates_.connections_ && !is_drawn_from_cut && i + 1 == path.num_vertices) {
            const Start start = start_of_connection(i == 0 ? nullptr : &vertex);
            ellipsoidal = walked * candidates_.connections_->pdf_area(
                                       start.ends, start.lengths, path.last(), start.lobe);
        }
        const auto step = i == 0 ? first_step(path.at(0)) : walk_.step_to(vertex, path.at(i));
        if (!step) break;  // never: paths without radiance are not offered
        walked *= step->pdf_area;
        PathVertex before = vertex;
        if (i == 0 && domain_.seen) before = *domain_.seen;
        before.throughput = 1.0;
        vertex = walk_.advance(before, path.at(i), *step, step->pdf_area);
    }
    return walked + ellipsoidal;
}

}  // namespace renderer
