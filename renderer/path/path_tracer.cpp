// SPDX-License-Identifier: MIT
#include "renderer/path/path_tracer.h"

#include "renderer/core/sampling.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

// Share of first vertices drawn from the hidden area: seen from the wall, hidden objects are small
// and most directions miss.
constexpr double kAreaShare = 0.75;

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
         const PathEndpoints& ends,
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

    void trace_samples(int num_area, int num_directions);
    void trace_pixel_samples(const SensorPairs& sensor_pairs, std::size_t pixel, int count);
    std::uint64_t num_rays() const { return num_rays_; }

 private:
    void finish_first_vertices();
    void deposit(const PathVertex& vertex, double value);
    void connect_to_light(const PathVertex& vertex);
    void extend(PathVertex vertex);

    const PathTracer& tracer_;
    const Scene& scene_;
    const PathEndpoints& ends_;
    core::Rng& rng_;
    PassHistogram& histogram_;
    double weight_;  ///< of one path: 1 / number of samples

    FirstVertexBatch first_;
    std::vector<PathVertex> go_on_;  ///< those of which longer paths are made
    std::uint64_t num_rays_ = 0;
};

PathTracer::PathTracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope)
    : scene_(&scene),
      max_order_(settings.max_bounces),
      by_order_(settings.by_order),
      surface_walk_(scene, settings.laser_spot_m2),
      facet_traits_(scene, objects_that_add(scene, scope)) {}

std::uint64_t PathTracer::trace(const PathEndpoints& ends,
                                int num_samples,
                                core::Rng& rng,
                                PassHistogram& histogram) const {
    // The number of each kind is rounded at random, so that its mean is the share that the weights
    // assume.
    const double expected = num_samples * kAreaShare;
    const int num_area = std::min(num_samples, static_cast<int>(expected + rng.uniform()));
    Walk walk(*this, ends, num_samples, rng, histogram);
    walk.trace_samples(num_area, num_samples - num_area);
    return walk.num_rays();
}

std::uint64_t PathTracer::trace_pixel(const SensorPairs& sensor_pairs,
                                      std::size_t pixel,
                                      int num_samples,
                                      core::Rng& rng,
                                      PassHistogram& histogram) const {
    const PathEndpoints ends = sensor_pairs.ends(pixel);
    Walk walk(*this, ends, num_samples, rng, histogram);
    walk.trace_pixel_samples(sensor_pairs, pixel, num_samples);
    return walk.num_rays();
}

void PathTracer::Walk::trace_samples(int num_area, int num_directions) {
    EndpointDirectionSampler directions(scene_, ends_.sensor, num_directions, rng_);
    FirstVertexBatch::AreaDraws by_area{num_area};
    while (!by_area.done() || !directions.done()) {
        num_rays_ += first_.draw(directions, tracer_.surface_walk_.area_sampler(), by_area, rng_);
        finish_first_vertices();
    }
}

void PathTracer::Walk::trace_pixel_samples(const SensorPairs& sensor_pairs,
                                           std::size_t pixel,
                                           int count) {
    const core::Vec2 shift(rng_.uniform(), rng_.uniform());
    for (int i = 0; i < count; ++i) {
        auto vertex = sensor_pairs.first_vertex(pixel, core::lattice_point(i, count, shift));
        ++num_rays_;
        if (!vertex) continue;
        vertex->throughput *= weight_;
        if (vertex->order > tracer_.max_order_) continue;
        connect_to_light(*vertex);
        extend(*vertex);
    }
}

// Connects first vertices to the light and continues their paths.
void PathTracer::Walk::finish_first_vertices() {
    first_.evaluate(ends_, {weight_, kAreaShare, tracer_.surface_walk_.area_sampler().pdf_area()});
    if (tracer_.facet_traits_.any_varies()) {
        for (int i = 0; i < first_.size(); ++i) {
            if (!tracer_.facet_traits_.varies(first_.facet(i))) continue;
            first_.set_contribution(
                i, tracer_.surface_walk_.connection_value(first_.vertex(i, ends_.sensor), ends_));
        }
    }
    const bool goes_on = tracer_.max_order_ > 3;
    first_.keep_useful(!goes_on);
    num_rays_ += first_.trace_from_sensor(ends_);
    if (goes_on || !ends_.coincide) first_.keep_seen();
    go_on_.clear();
    for (int i = 0; i < first_.size() && goes_on; ++i) {
        go_on_.push_back(first_.vertex(i, ends_.sensor));
    }
    if (!ends_.coincide) {
        if (goes_on) first_.keep_useful(true);
        num_rays_ += first_.trace_from_light(ends_);
    }
    std::span<const double> velocities;
    if (histogram_.resolves_velocity()) velocities = first_.find_velocities(ends_);
    histogram_.add(tracer_.by_order_ ? 2 : 0, first_.opl_m(), velocities, first_.contributions());
    first_.clear();
    for (const PathVertex& vertex : go_on_) extend(vertex);
}

void PathTracer::Walk::deposit(const PathVertex& vertex, double value) {
    const int channel = tracer_.by_order_ ? vertex.order - 1 : 0;
    histogram_.add(channel, tracer_.surface_walk_.extent_to_light(vertex, ends_), value);
}

void PathTracer::Walk::connect_to_light(const PathVertex& vertex) {
    const double value = tracer_.surface_walk_.connection_value(vertex, ends_);
    if (!(value > 0.0)) return;
    ++num_rays_;
    if (!tracer_.surface_walk_.light_is_hidden(vertex, ends_)) deposit(vertex, value);
}

void PathTracer::Walk::extend(PathVertex vertex) {
    const SurfaceWalk& walk = tracer_.surface_walk_;
    while (vertex.order < tracer_.max_order_) {
        if (!walk.survives(vertex, rng_)) return;
        if (!walk.draw_next(vertex, rng_, num_rays_)) return;
        connect_to_light(vertex);
    }
}

}  // namespace renderer
