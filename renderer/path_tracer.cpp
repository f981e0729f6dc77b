// SPDX-License-Identifier: MIT
#include "renderer/path_tracer.h"

#include "renderer/core/sampling.h"
#include "renderer/third_bounce_pieces.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec2;
using core::Vec3;

// Share of vertices drawn from the hidden area. Seen from the wall, hidden objects are small and
// most BSDF samples miss; between surfaces BSDF samples follow the lobes and nearby surfaces.
constexpr double kAreaShareFromWall = 0.75;
constexpr double kAreaShareBetweenSurfaces = 0.25;

// Paths are always continued up to this order; above it Russian roulette may end them.
constexpr int kFirstRouletteOrder = 5;
constexpr double kLeastSurvival = 0.1;

double pdf_direction(const PathEnd& end, const Vec3& direction) {
    if (end.isotropic) return core::pdf_sphere();
    return std::max(0.0, end.normal.dot(direction)) / kPi;
}

}  // namespace

// One call of trace(): what is fixed for the pair, and the paths under way.
class PathTracer::Walk {
 public:
    Walk(const PathTracer& tracer,
         const PathEnds& ends,
         int num_samples,
         core::Rng& rng,
         PassHistogram& histogram)
        : tracer_(tracer),
          scene_(*tracer.scene_),
          ends_(ends),
          rng_(rng),
          histogram_(histogram),
          weight_(1.0 / num_samples) {}

    void trace_area_samples(int count);
    void trace_bsdf_samples(int count);
    std::uint64_t num_rays() const { return num_rays_; }

 private:
    // A first vertex and what its connection to the light carries if nothing is in the way.
    struct Candidate {
        PathVertex vertex;
        double value = 0.0;
    };

    bool make_candidate(const SurfacePoint& point, Candidate& candidate) const;
    void trace_packet();
    void keep_seen_from_sensor();
    void finish_candidates();
    Vec3 sample_sensor_direction(const Vec2& u) const;
    double evaluate(const PathVertex& vertex, const Vec3& outgoing) const;
    double connection_value(const PathVertex& vertex) const;
    void deposit(const PathVertex& vertex, double value);
    void extend(PathVertex vertex);
    bool draw_next(PathVertex& vertex);

    const PathTracer& tracer_;
    const Scene& scene_;
    const PathEnds& ends_;
    core::Rng& rng_;
    PassHistogram& histogram_;
    double weight_;  ///< of one path: 1 / number of samples

    std::array<Candidate, SegmentPacket::kSize> candidates_;
    int num_candidates_ = 0;
    SegmentPacket packet_;
    std::uint64_t num_rays_ = 0;
};

PathTracer::PathTracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope)
    : scene_(&scene),
      area_sampler_(scene),
      max_order_(settings.max_bounces),
      by_order_(settings.by_order),
      laser_spot_m2_(settings.laser_spot_m2) {
    for (const Object& object : scene.objects()) {
        // At the third bounce the relay wall only passes light on; see formats of scenes.
        adds_third_bounce_.push_back(
            object.role != Role::RelayWall &&
            (scope == ThirdBounceScope::All || !is_integrable(object.material)));
    }
}

std::uint64_t PathTracer::trace(const PathEnds& ends,
                                int num_samples,
                                core::Rng& rng,
                                PassHistogram& histogram) const {
    // The number of each kind is rounded at random, so that its mean is the share that the weights
    // assume.
    const double expected = num_samples * kAreaShareFromWall;
    const int num_area = std::min(num_samples, static_cast<int>(expected + rng.uniform()));
    Walk walk(*this, ends, num_samples, rng, histogram);
    walk.trace_area_samples(num_area);
    walk.trace_bsdf_samples(num_samples - num_area);
    return walk.num_rays();
}

void PathTracer::Walk::trace_area_samples(int count) {
    std::size_t hint = 0;
    for (int i = 0; i < count; ++i) {
        const double u1 = (i + rng_.uniform()) / count;
        const SurfacePoint point = tracer_.area_sampler_.sample(u1, rng_.uniform(), hint);
        if (!make_candidate(point, candidates_[static_cast<std::size_t>(num_candidates_)]))
            continue;
        if (++num_candidates_ < SegmentPacket::kSize) continue;
        keep_seen_from_sensor();
        finish_candidates();
    }
    keep_seen_from_sensor();
    finish_candidates();
}

void PathTracer::Walk::trace_bsdf_samples(int count) {
    const PathEnd& sensor = ends_.sensor;
    for (int i = 0; i < count; ++i) {
        const double u1 = (i + rng_.uniform()) / count;
        const Vec3 direction = sample_sensor_direction({u1, rng_.uniform()});
        const auto point = scene_.first_hit(sensor.position, sensor.normal, direction);
        ++num_rays_;
        if (!point) continue;
        if (!make_candidate(*point, candidates_[static_cast<std::size_t>(num_candidates_)]))
            continue;
        if (++num_candidates_ == SegmentPacket::kSize) finish_candidates();
    }
    finish_candidates();
}

// False when the vertex can add nothing to any order asked for.
bool PathTracer::Walk::make_candidate(const SurfacePoint& point, Candidate& candidate) const {
    PathVertex& vertex = candidate.vertex;
    vertex.point = point;
    vertex.normal = scene_.facet(point.facet).normal;
    const Vec3 offset = point.position - ends_.sensor.position;
    const double distance2 = offset.squaredNorm();
    vertex.opl_m = std::sqrt(distance2);
    const Vec3 direction = offset / vertex.opl_m;
    vertex.to_previous = -direction;
    vertex.order = 3;

    const double per_area = std::abs(vertex.normal.dot(direction)) / distance2;
    const double area_pdf = scene_.is_hidden(point.facet) ? tracer_.area_sampler_.pdf_area() : 0.0;
    const double pdf = kAreaShareFromWall * area_pdf + (1.0 - kAreaShareFromWall) *
                                                           pdf_direction(ends_.sensor, direction) *
                                                           per_area;
    vertex.throughput = weight_ * ends_.sensor.factor(direction) * per_area / pdf;
    if (!(vertex.throughput > 0.0)) return false;
    vertex.bsdf = scene_.bsdf_at(point);
    candidate.value = connection_value(vertex);
    return candidate.value > 0.0 || tracer_.max_order_ > 3;
}

void PathTracer::Walk::trace_packet() {
    if (packet_.count == 0) return;
    scene_.rays().trace(packet_);
    num_rays_ += static_cast<std::uint64_t>(packet_.count);
}

void PathTracer::Walk::keep_seen_from_sensor() {
    packet_.count = 0;
    for (int i = 0; i < num_candidates_; ++i) {
        const PathVertex& vertex = candidates_[static_cast<std::size_t>(i)].vertex;
        scene_.rays().add_segment(packet_,
                                  ends_.sensor.position,
                                  ends_.sensor.normal,
                                  vertex.point.position,
                                  vertex.normal);
    }
    trace_packet();
    int kept = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_candidates_); ++i) {
        if (!packet_.blocked[i]) candidates_[static_cast<std::size_t>(kept++)] = candidates_[i];
    }
    num_candidates_ = kept;
}

// Connects first vertices that the sensor sees to the light, and continues their paths.
void PathTracer::Walk::finish_candidates() {
    packet_.count = 0;
    std::array<std::size_t, SegmentPacket::kSize> lane_owner{};
    for (std::size_t i = 0; i < static_cast<std::size_t>(num_candidates_); ++i) {
        const Candidate& candidate = candidates_[i];
        if (!(candidate.value > 0.0)) continue;
        if (ends_.coincide) {
            deposit(candidate.vertex, candidate.value);
            continue;
        }
        lane_owner[static_cast<std::size_t>(packet_.count)] = i;
        scene_.rays().add_segment(packet_,
                                  ends_.light.position,
                                  ends_.light.normal,
                                  candidate.vertex.point.position,
                                  candidate.vertex.normal);
    }
    trace_packet();
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(packet_.count); ++lane) {
        const Candidate& candidate = candidates_[lane_owner[lane]];
        if (!packet_.blocked[lane]) deposit(candidate.vertex, candidate.value);
    }
    if (tracer_.max_order_ > 3) {
        for (std::size_t i = 0; i < static_cast<std::size_t>(num_candidates_); ++i) {
            extend(candidates_[i].vertex);
        }
    }
    num_candidates_ = 0;
}

Vec3 PathTracer::Walk::sample_sensor_direction(const Vec2& u) const {
    if (ends_.sensor.isotropic) return core::sample_sphere(u);
    const Vec3& normal = ends_.sensor.normal;
    return core::frame_from_normal(normal, scene_.tangent_hint(normal)) *
           core::sample_cosine_hemisphere(u);
}

double PathTracer::Walk::evaluate(const PathVertex& vertex, const Vec3& outgoing) const {
    if (const auto* lambertian = std::get_if<Lambertian>(&vertex.bsdf)) {
        const bool same_side =
            vertex.normal.dot(vertex.to_previous) * vertex.normal.dot(outgoing) > 0.0;
        return same_side ? lambertian->albedo / kPi : 0.0;
    }
    const core::Mat3 facet_from_world =
        scene_.facet(vertex.point.facet).world_from_facet().transpose();
    return evaluate_bsdf(
        vertex.bsdf, facet_from_world * vertex.to_previous, facet_from_world * outgoing);
}

// What the path carries when it goes from `vertex` straight to the light, unless blocked.
double PathTracer::Walk::connection_value(const PathVertex& vertex) const {
    const std::uint32_t object = scene_.facet(vertex.point.facet).object;
    if (vertex.order == 3 && !tracer_.adds_third_bounce_[object]) return 0.0;
    if (const auto* retro = std::get_if<Retroreflective>(&vertex.bsdf)) {
        if (!ends_.coincide || vertex.order != 3) return 0.0;
        return vertex.throughput * retro->albedo / tracer_.laser_spot_m2_ * ends_.light.strength;
    }
    const Vec3 offset = ends_.light.position - vertex.point.position;
    const double distance2 = offset.squaredNorm();
    const Vec3 direction = offset / std::sqrt(distance2);
    return vertex.throughput * evaluate(vertex, direction) *
           std::abs(vertex.normal.dot(direction)) * ends_.light.factor(-direction) / distance2;
}

void PathTracer::Walk::deposit(const PathVertex& vertex, double value) {
    const double to_light = (ends_.light.position - vertex.point.position).norm();
    const int channel = tracer_.by_order_ ? vertex.order - 1 : 0;
    histogram_.add(channel, vertex.opl_m + to_light + ends_.device_legs_m, value);
}

void PathTracer::Walk::extend(PathVertex vertex) {
    while (vertex.order < tracer_.max_order_) {
        if (vertex.order >= kFirstRouletteOrder) {
            const double survival = std::clamp(albedo_of(vertex.bsdf), kLeastSurvival, 1.0);
            if (rng_.uniform() >= survival) return;
            vertex.throughput /= survival;
        }
        if (!draw_next(vertex)) return;
        const double value = connection_value(vertex);
        if (!(value > 0.0)) continue;
        ++num_rays_;
        if (!scene_.rays().is_blocked(
                vertex.point.position, vertex.normal, ends_.light.position, ends_.light.normal)) {
            deposit(vertex, value);
        }
    }
}

// Replaces `vertex` by the next one of the path; false when the path ends.
bool PathTracer::Walk::draw_next(PathVertex& vertex) {
    const core::Mat3 world_from_facet = scene_.facet(vertex.point.facet).world_from_facet();
    const Vec3 incoming = world_from_facet.transpose() * vertex.to_previous;
    const bool on_wall = !scene_.is_hidden(vertex.point.facet);
    const double area_share = on_wall ? kAreaShareFromWall : kAreaShareBetweenSurfaces;

    SurfacePoint next;
    const bool from_area = rng_.uniform() < area_share;
    if (from_area) {
        std::size_t hint = 0;
        const double u1 = rng_.uniform();
        next = tracer_.area_sampler_.sample(u1, rng_.uniform(), hint);
    } else {
        const double u1 = rng_.uniform();
        const auto local = sample_bsdf(vertex.bsdf, incoming, {u1, rng_.uniform()});
        if (!local) return false;
        ++num_rays_;
        const auto hit =
            scene_.first_hit(vertex.point.position, vertex.normal, world_from_facet * *local);
        if (!hit) return false;
        next = *hit;
    }
    const Vec3 offset = next.position - vertex.point.position;
    const double distance2 = offset.squaredNorm();
    if (!(distance2 > 0.0)) return false;
    const double distance = std::sqrt(distance2);
    const Vec3 direction = offset / distance;
    const Vec3 outgoing = world_from_facet.transpose() * direction;
    const Vec3& next_normal = scene_.facet(next.facet).normal;
    const double per_area = std::abs(next_normal.dot(direction)) / distance2;
    const double area_pdf = scene_.is_hidden(next.facet) ? tracer_.area_sampler_.pdf_area() : 0.0;
    const double pdf = area_share * area_pdf +
                       (1.0 - area_share) * pdf_bsdf(vertex.bsdf, incoming, outgoing) * per_area;
    const double transport = evaluate(vertex, direction) * std::abs(outgoing.z()) * per_area;
    if (!(transport > 0.0)) return false;
    if (from_area) {
        ++num_rays_;
        if (scene_.rays().is_blocked(
                vertex.point.position, vertex.normal, next.position, next_normal)) {
            return false;
        }
    }
    vertex.throughput *= transport / pdf;
    vertex.opl_m += distance;
    vertex.point = next;
    vertex.normal = next_normal;
    vertex.to_previous = -direction;
    vertex.bsdf = scene_.bsdf_at(next);
    ++vertex.order;
    return true;
}

}  // namespace renderer
