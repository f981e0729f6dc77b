// SPDX-License-Identifier: MIT
#include "renderer/path/tracer.h"

namespace renderer {
namespace {

// Third bounces that contribute less than this many means are drawn in proportion to what they
// contribute before their shadow rays are traced.
constexpr double kStepOfConnected = 0.75;
// Likewise the vertices that paths continue from, where all third bounces count: these carry most
// of the light and of its noise, and longer paths most of the cost (tuned on scenes/bars and
// scenes/letter).
constexpr double kStepOfContinued = 20.0;

// Per object, whether first vertices on it may reflect straight to the light. The relay wall has no
// third bounce; it takes part from order 4 on.
std::vector<bool> objects_that_add(const Scene& scene, ThirdBounceScope scope) {
    std::vector<bool> adds;
    for (const Object& object : scene.objects()) {
        adds.push_back(object.role != Role::RelayWall &&
                       (scope == ThirdBounceScope::All || !is_integrable(object.material)));
    }
    return adds;
}

}  // namespace

Tracer::Tracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope)
    : scene_(&scene),
      max_order_(settings.max_bounces),
      by_order_(settings.by_order),
      random_walk_(scene, settings.laser_spot_m2),
      facet_traits_(scene, objects_that_add(scene, scope)) {}

std::uint64_t Tracer::trace(const PathEndpoints& ends,
                            int num_samples,
                            core::Rng& rng,
                            PassHistogram& histogram) const {
    const auto walk = start(ends, rng, histogram);
    walk->trace_samples(num_samples);
    walk->finish();
    return walk->num_rays();
}

std::uint64_t Tracer::trace(const SensorPairs& sensor_pairs,
                            std::size_t pair,
                            int num_samples,
                            core::Rng& rng,
                            PassHistogram& histogram,
                            const LightSubpaths* subpaths) const {
    const PathEndpoints ends = sensor_pairs.ends(pair);
    if (!sensor_pairs.is_image()) return trace(ends, num_samples, rng, histogram);
    const auto walk = start(ends, rng, histogram);
    walk->trace_pixel_samples(sensor_pairs, pair, num_samples, subpaths);
    walk->finish();
    return walk->num_rays();
}

std::unique_ptr<const LightSubpaths> Tracer::trace_subpaths(const SensorPairs&,
                                                            int,
                                                            const core::Rng&) const {
    return nullptr;
}

PairWalk::PairWalk(const Tracer& tracer,
                   const PathEndpoints& ends,
                   core::Rng& rng,
                   PassHistogram& histogram)
    : scene_(*tracer.scene_),
      ends_(ends),
      rng_(rng),
      histogram_(histogram),
      first_(*tracer.scene_, tracer.facet_traits_),
      shadow_rays_(*tracer.scene_, histogram),
      tracer_(tracer) {}

void PairWalk::trace_walks(int num_area, int num_directions, double weight) {
    EndpointDirectionSampler directions(scene_, ends_.sensor, num_directions, rng_);
    FirstVertexBatch::AreaDraws by_area(num_area, rng_);
    while (!by_area.done() || !directions.done()) {
        num_rays_ += first_.draw(directions, tracer_.random_walk_.area_sampler(), by_area);
        finish_first_vertices(weight);
    }
}

// Connects first vertices to the light and continues their paths.
void PairWalk::finish_first_vertices(double weight) {
    evaluate_first_vertices(weight);
    weigh_first_vertices();
    const double counted = first_.leave_out_other_lengths(histogram_.gate());
    continued_.clear();
    if (tracer_.max_order_ > 3) {
        draw_continued(tracer_.by_order_ ? 0.0 : kStepOfContinued * counted);
    }
    first_.thin(kStepOfConnected, rng_);
    num_rays_ += first_.trace_from_sensor(ends_);
    if (!ends_.coincide) first_.keep_seen();
    connect_first_vertices();
    for (const PathVertex& vertex : continued_) extend(vertex);
}

void PairWalk::draw_continued(double step_in_means) {
    for (const auto& [index, scale] : first_.draw_by_throughput(step_in_means, rng_)) {
        PathVertex vertex = first_.vertex(index, ends_.sensor);
        vertex.throughput *= scale;
        if (!first_.is_in_sight(index)) {
            ++num_rays_;
            if (scene_.rays().is_blocked(ends_.sensor.position,
                                         ends_.sensor.normal,
                                         vertex.point.position,
                                         vertex.normal)) {
                continue;
            }
        }
        continued_.push_back(vertex);
    }
}

void PairWalk::evaluate_first_vertices(double weight) {
    const RandomWalk& walk = tracer_.random_walk_;
    first_.evaluate(ends_, {weight, kAreaFractionFromWall, walk.area_sampler().pdf_area()});
    for (int i = 0; i < first_.size() && tracer_.facet_traits_.any_varies(); ++i) {
        if (!tracer_.facet_traits_.varies(first_.facet(i))) continue;
        first_.set_contribution(i, walk.connection_value(first_.vertex(i, ends_.sensor), ends_));
    }
}

void PairWalk::connect_first_vertices() {
    if (!ends_.coincide) num_rays_ += first_.trace_from_light(ends_);
    std::span<const double> velocities;
    if (histogram_.resolves_velocity()) velocities = first_.find_velocities(ends_);
    histogram_.add(tracer_.by_order_ ? 2 : 0, first_.opl_m(), velocities, first_.contributions());
    first_.clear();
}

void PairWalk::connect_to_light(const PathVertex& vertex, double value) {
    if (!(value > 0.0)) return;
    shadow_rays_.add({vertex.point.position, vertex.normal},
                     {ends_.light.position, ends_.light.normal},
                     channel_of(vertex),
                     tracer_.random_walk_.optical_path_to_light(vertex, ends_),
                     value);
}

void PairWalk::deposit(const PathVertex& vertex, double value) {
    histogram_.add(
        channel_of(vertex), tracer_.random_walk_.optical_path_to_light(vertex, ends_), value);
}

int PairWalk::channel_of(const PathVertex& vertex) const {
    return tracer_.by_order_ ? vertex.order - 1 : 0;
}

void add_short_paths(const Scene& scene,
                     const PathEndpoints& ends,
                     const RenderSettings& settings,
                     PassHistogram& histogram) {
    const auto channel = [&](int order) { return settings.by_order ? order - 1 : 0; };
    if (ends.coincide) {
        if (settings.direct_return) {
            histogram.add(channel(1),
                          {ends.device_segments_m, 0.0},
                          ends.light.strength / settings.laser_spot_m2);
        }
        return;
    }
    if (settings.max_bounces < 2 || scene.has_relay_wall()) return;
    const core::Vec3 offset = ends.light.position - ends.sensor.position;
    const double distance = offset.norm();
    const core::Vec3 direction = offset / distance;
    const double value =
        ends.sensor.factor(direction) * ends.light.factor(-direction) / (distance * distance);
    if (value > 0.0 &&
        !scene.rays().is_blocked(
            ends.sensor.position, ends.sensor.normal, ends.light.position, ends.light.normal)) {
        histogram.add(channel(2), {distance + ends.device_segments_m, 0.0}, value);
    }
}

}  // namespace renderer
