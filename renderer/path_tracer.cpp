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

// Per object, whether first vertices on it may reflect straight to the light. At the third bounce
// the relay wall only passes light on; see formats of scenes.
std::vector<bool> objects_that_add(const Scene& scene, ThirdBounceScope scope) {
    std::vector<bool> adds;
    for (const Object& object : scene.objects()) {
        adds.push_back(object.role != Role::RelayWall &&
                       (scope == ThirdBounceScope::All || !is_integrable(object.material)));
    }
    return adds;
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
          weight_(1.0 / num_samples),
          first_(*tracer.scene_, tracer.facet_traits_) {}

    void trace_area_samples(int count);
    void trace_bsdf_samples(int count);
    std::uint64_t num_rays() const { return num_rays_; }

 private:
    void finish_first_vertices(bool may_be_hidden);
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

    FirstVertices first_;
    std::uint64_t num_rays_ = 0;
};

PathTracer::PathTracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope)
    : scene_(&scene),
      area_sampler_(scene),
      max_order_(settings.max_bounces),
      by_order_(settings.by_order),
      laser_spot_m2_(settings.laser_spot_m2),
      adds_third_bounce_(objects_that_add(scene, scope)),
      facet_traits_(scene, adds_third_bounce_) {}

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
    std::array<double, FirstVertices::kCapacity> u1;
    std::array<double, FirstVertices::kCapacity> u2;
    std::size_t hint = 0;
    for (int begin = 0; begin < count; begin += FirstVertices::kCapacity) {
        const int size = std::min(count - begin, FirstVertices::kCapacity);
        rng_.fill_uniform({u1.data(), static_cast<std::size_t>(size)});
        rng_.fill_uniform({u2.data(), static_cast<std::size_t>(size)});
        const double strata = 1.0 / count;
        for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
            const double stratified = (begin + static_cast<double>(i) + u1[i]) * strata;
            const SurfacePoint point = tracer_.area_sampler_.sample(stratified, u2[i], hint);
            first_.add(point.position, point.facet);
        }
        finish_first_vertices(true);
    }
}

void PathTracer::Walk::trace_bsdf_samples(int count) {
    const PathEnd& sensor = ends_.sensor;
    const core::Mat3 world_from_end =
        core::frame_from_normal(sensor.normal, scene_.tangent_hint(sensor.normal));
    for (int i = 0; i < count; ++i) {
        const Vec2 u{(i + rng_.uniform()) / count, rng_.uniform()};
        const Vec3 direction = sensor.isotropic
                                   ? core::sample_sphere(u)
                                   : Vec3(world_from_end * core::sample_cosine_hemisphere(u));
        const auto point = scene_.first_hit(sensor.position, sensor.normal, direction);
        ++num_rays_;
        if (!point) continue;
        first_.add(point->position, point->facet);
        if (first_.full()) finish_first_vertices(false);
    }
    finish_first_vertices(false);
}

// Connects first vertices to the light and continues their paths. `may_be_hidden`: whether the
// sensor may not see them.
void PathTracer::Walk::finish_first_vertices(bool may_be_hidden) {
    first_.evaluate(ends_, {weight_, kAreaShareFromWall, tracer_.area_sampler_.pdf_area()});
    if (tracer_.facet_traits_.any_varies()) {
        for (int i = 0; i < first_.size(); ++i) {
            if (!tracer_.facet_traits_.varies(first_.facet(i))) continue;
            first_.set_contribution(i, connection_value(first_.vertex(i, ends_.sensor)));
        }
    }
    const bool goes_on = tracer_.max_order_ > 3;
    first_.keep_useful(!goes_on);
    if (may_be_hidden) {
        num_rays_ += first_.trace_from(ends_.sensor);
        if (goes_on || !ends_.coincide) first_.keep_seen();
    }
    std::array<PathVertex, FirstVertices::kCapacity> vertices;
    const int num_vertices = goes_on ? first_.size() : 0;
    for (int i = 0; i < num_vertices; ++i) {
        vertices[static_cast<std::size_t>(i)] = first_.vertex(i, ends_.sensor);
    }
    if (!ends_.coincide) {
        if (goes_on) first_.keep_useful(true);
        num_rays_ += first_.trace_from(ends_.light);
    }
    histogram_.add(tracer_.by_order_ ? 2 : 0, first_.opl_m(), first_.contributions());
    first_.clear();
    for (int i = 0; i < num_vertices; ++i) extend(vertices[static_cast<std::size_t>(i)]);
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
