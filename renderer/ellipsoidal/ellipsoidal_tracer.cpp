// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/ellipsoidal_tracer.h"

#include "renderer/core/sampling.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

// Of the samples that do not choose the length first, those drawn from the hidden area rather than
// by direction.
constexpr double kAreaShare = 0.75;

// Share of samples that choose the length first. They cost several times more than the others, of
// which only the share `asked` has a length that counts (constants by trial on scenes/bars and
// scenes/letter).
double ellipsoidal_share(double asked) {
    constexpr double kMax = 0.85;
    constexpr double kMin = 0.05;
    constexpr double kHalved = 0.3;
    return std::max(kMin, kMax / (1.0 + asked / kHalved));
}

// Connections of a vertex with a lobe this narrow: what it mirrors makes bright, noisy pixels.
constexpr int kDrawsAlongLobes = 6;
constexpr double kNarrowLobe_rad = 0.2;

// A Gaussian gate lets through e^-10 of its peak this many widths from its centre; what lies beyond
// is left to the walk.
constexpr double kGaussianReach = 4.5;

// Entries of a pair's cut: enough to single out facets, few against the samples they serve.
constexpr std::size_t kMinEntries = 32;

OplBand lengths_of_gate(const core::TimeAxis& axis, GateShape gate) {
    OplBand lengths{axis.opl_start_m, axis.opl_end_m()};
    if (gate != GateShape::Box) {
        const double reach =
            gate == GateShape::Tent ? axis.bin_width_m : kGaussianReach * axis.bin_width_m;
        lengths = {axis.bin_center_m(0) - reach, axis.bin_center_m(0) + reach};
    }
    lengths.low_m = std::max(0.0, lengths.low_m);
    lengths.high_m = std::max(lengths.low_m, lengths.high_m);
    return lengths;
}

// The relay wall passes third bounces on; see formats of scenes.
std::vector<bool> hidden_objects(const Scene& scene) {
    std::vector<bool> hidden;
    for (const Object& object : scene.objects()) hidden.push_back(object.role != Role::RelayWall);
    return hidden;
}

}  // namespace

// One call of trace(): what is fixed for the pair, and the paths under way.
class EllipsoidalTracer::Walk {
 public:
    Walk(const EllipsoidalTracer& tracer,
         const PathEndpoints& ends,
         core::Rng& rng,
         PassHistogram& histogram)
        : tracer_(tracer),
          scene_(*tracer.scene_),
          ends_(ends),
          rng_(rng),
          histogram_(histogram),
          cut_(tracer.technique_.hierarchy()),
          first_(*tracer.scene_, tracer.facet_traits_) {}

    /// For third bounces, before all others; returns the share of trace_connections().
    double cut_hierarchy(int num_samples);
    void trace_connections(int count);
    void trace_walks(int num_area, int num_directions);
    void trace_pixel_samples(const SensorPairs& sensor_pairs, std::size_t pixel, int count);
    std::uint64_t num_rays() const { return num_rays_; }

 private:
    void finish_connections();
    void finish_first_vertices();
    void evaluate();
    void weigh(int index, double ellipsoidal_pdf);
    void connect_seen();
    void extend(PathVertex vertex);
    void connect(const PathVertex& vertex,
                 const ConnectionEnds& ends,
                 const OplBand& lengths,
                 const std::optional<LobeOnFacet>& lobe,
                 int num_draws);
    void deposit(const PathVertex& vertex, double value);
    OplBand lengths_left(const PathVertex& vertex) const;
    double opl_to_light(const PathVertex& vertex) const;

    const EllipsoidalTracer& tracer_;
    const Scene& scene_;
    const PathEndpoints& ends_;
    core::Rng& rng_;
    PassHistogram& histogram_;
    HierarchyCut cut_;                ///< for third bounces
    double ellipsoidal_share_ = 0.0;  ///< of third bounces
    double walk_weight_ = 0.0;        ///< of one walk: 1 / their expected number
    FirstVertexBatch first_;
    std::vector<PathVertex> go_on_;  ///< those of which longer paths are made
    std::array<double, FirstVertexBatch::kCapacity> ellipsoidal_pdf_;
    std::uint64_t num_rays_ = 0;
};

EllipsoidalTracer::EllipsoidalTracer(const Scene& scene,
                                     const core::Scan& scan,
                                     const core::TimeAxis& axis,
                                     const RenderSettings& settings,
                                     ConnectionScope scope)
    : scene_(&scene),
      max_order_(settings.max_bounces),
      by_order_(settings.by_order),
      scope_(scope),
      lengths_(lengths_of_gate(axis, settings.gate)),
      surface_walk_(scene, settings.laser_spot_m2),
      facet_traits_(scene, hidden_objects(scene)),
      excluded_(ExcludedFacets::of(scene, axis, settings)),
      technique_(scene, excluded_, scan) {
    if (scan.camera) pixel_places_.emplace(SensorPairs(scene, scan), *scan.camera);
}

std::uint64_t EllipsoidalTracer::trace(const PathEndpoints& ends,
                                       int num_samples,
                                       core::Rng& rng,
                                       PassHistogram& histogram) const {
    Walk walk(*this, ends, rng, histogram);
    const double share = walk.cut_hierarchy(num_samples);
    // Numbers of each kind are rounded at random, so that their means are the shares that the
    // weights assume: all by the same number, so that none takes from another.
    const double u = rng.uniform();
    const auto rounded = [&](double expected) { return static_cast<int>(expected + u); };
    const int num_connections = rounded(num_samples * share);
    const int num_chosen = rounded(num_samples * (share + (1.0 - share) * kAreaShare));
    walk.trace_connections(num_connections);
    walk.trace_walks(num_chosen - num_connections, num_samples - num_chosen);
    return walk.num_rays();
}

std::uint64_t EllipsoidalTracer::trace_pixel(const SensorPairs& sensor_pairs,
                                             std::size_t pixel,
                                             int num_samples,
                                             core::Rng& rng,
                                             PassHistogram& histogram) const {
    const PathEndpoints ends = sensor_pairs.ends(pixel);
    Walk walk(*this, ends, rng, histogram);
    walk.trace_pixel_samples(sensor_pairs, pixel, num_samples);
    return walk.num_rays();
}

double EllipsoidalTracer::Walk::cut_hierarchy(int num_samples) {
    const OplBand lengths{tracer_.lengths_.low_m - ends_.device_legs_m,
                          tracer_.lengths_.high_m - ends_.device_legs_m};
    cut_.rebuild(connection_ends(ends_),
                 lengths,
                 std::max(kMinEntries, static_cast<std::size_t>(num_samples)));
    if (!cut_.empty()) ellipsoidal_share_ = ellipsoidal_share(cut_.share_asked());
    walk_weight_ = 1.0 / (num_samples * (1.0 - ellipsoidal_share_));
    return ellipsoidal_share_;
}

void EllipsoidalTracer::Walk::trace_connections(int count) {
    if (cut_.empty()) return;
    std::size_t hint = 0;
    for (int i = 0; i < count; ++i) {
        const double u = (i + rng_.uniform()) / count;
        const auto draw = tracer_.technique_.sample(cut_, u, hint, rng_);
        if (!draw) continue;
        ellipsoidal_pdf_[static_cast<std::size_t>(first_.size())] = draw->pdf_area;
        first_.add(draw->point.position, draw->point.facet);
        if (first_.full()) finish_connections();
    }
    finish_connections();
}

void EllipsoidalTracer::Walk::finish_connections() {
    evaluate();
    for (int i = 0; i < first_.size(); ++i) {
        weigh(i, ellipsoidal_pdf_[static_cast<std::size_t>(i)]);
    }
    first_.keep_useful(true);
    num_rays_ += first_.trace_from_sensor(ends_);
    if (!ends_.coincide) first_.keep_useful(true);
    connect_seen();
}

void EllipsoidalTracer::Walk::trace_walks(int num_area, int num_directions) {
    EndpointDirectionSampler directions(scene_, ends_.sensor, num_directions, rng_);
    FirstVertexBatch::AreaDraws by_area{num_area};
    while (!by_area.done() || !directions.done()) {
        num_rays_ += first_.draw(directions, tracer_.surface_walk_.area_sampler(), by_area, rng_);
        finish_first_vertices();
    }
}

void EllipsoidalTracer::Walk::trace_pixel_samples(const SensorPairs& sensor_pairs,
                                                  std::size_t pixel,
                                                  int count) {
    const SurfaceWalk& walk = tracer_.surface_walk_;
    const PixelPositionSampler::Band places = tracer_.pixel_places_->band(pixel, tracer_.lengths_);
    const Vec2 shift(rng_.uniform(), rng_.uniform());
    for (int i = 0; i < count; ++i) {
        const Vec2 place = places.sample(core::lattice_point(i, count, shift));
        auto vertex = sensor_pairs.first_vertex(pixel, place);
        ++num_rays_;
        if (!vertex || vertex->order > tracer_.max_order_) continue;
        vertex->throughput /= count * places.pdf(place);
        const double value = walk.connection_value(*vertex, ends_);
        if (value > 0.0 && tracer_.scope_ != ConnectionScope::Excluded &&
            histogram_.lets_through(opl_to_light(*vertex))) {
            ++num_rays_;
            if (!walk.light_is_hidden(*vertex, ends_)) deposit(*vertex, value);
        }
        extend(*vertex);
    }
}

// Connects first vertices of walks to the light and continues them.
void EllipsoidalTracer::Walk::finish_first_vertices() {
    evaluate();
    for (int i = 0; i < first_.size(); ++i) {
        const double opl_m = first_.opl_m()[static_cast<std::size_t>(i)];
        if (first_.contributions()[static_cast<std::size_t>(i)] == 0.0) continue;
        const bool asked = opl_m >= tracer_.lengths_.low_m && opl_m <= tracer_.lengths_.high_m;
        weigh(i, asked ? tracer_.technique_.pdf_area(cut_, first_.point(i)) : 0.0);
    }
    const bool goes_on = tracer_.max_order_ > 3;
    first_.keep_useful(!goes_on);
    num_rays_ += first_.trace_from_sensor(ends_);
    if (goes_on || !ends_.coincide) first_.keep_seen();
    go_on_.clear();
    for (int i = 0; i < first_.size() && goes_on; ++i) {
        go_on_.push_back(first_.vertex(i, ends_.sensor));
    }
    if (goes_on && !ends_.coincide) first_.keep_useful(true);
    connect_seen();
    for (const PathVertex& vertex : go_on_) extend(vertex);
}

// What the first vertices carry over the density of the walk alone, as if the walk drew them all.
void EllipsoidalTracer::Walk::evaluate() {
    const SurfaceWalk& walk = tracer_.surface_walk_;
    first_.evaluate(ends_, {walk_weight_, kAreaShare, walk.area_sampler().pdf_area()});
    for (int i = 0; i < first_.size() && tracer_.facet_traits_.any_varies(); ++i) {
        if (!tracer_.facet_traits_.varies(first_.facet(i))) continue;
        first_.set_contribution(i, walk.connection_value(first_.vertex(i, ends_.sensor), ends_));
    }
}

// Turns it into what it carries over the density of both techniques together. Nothing outside the
// lengths asked for goes on to rays, nor on facets out of scope.
void EllipsoidalTracer::Walk::weigh(int index, double ellipsoidal_pdf) {
    const auto i = static_cast<std::size_t>(index);
    const double by_walk = (1.0 - ellipsoidal_share_) * first_.pdf_area(index);
    const double both = by_walk + ellipsoidal_share_ * ellipsoidal_pdf;
    const bool keeps = histogram_.lets_through(first_.opl_m()[i]) &&
                       tracer_.in_scope(first_.facet(index)) && both > 0.0;
    first_.set_contribution(index, keeps ? first_.contributions()[i] * by_walk / both : 0.0);
}

void EllipsoidalTracer::Walk::connect_seen() {
    if (!ends_.coincide) num_rays_ += first_.trace_from_light(ends_);
    std::span<const double> velocities;
    if (histogram_.resolves_velocity()) velocities = first_.find_velocities(ends_);
    histogram_.add(tracer_.by_order_ ? 2 : 0, first_.opl_m(), velocities, first_.contributions());
    first_.clear();
}

// What is left of the wanted lengths after the path up to a vertex, for the two legs to the light.
OplBand EllipsoidalTracer::Walk::lengths_left(const PathVertex& vertex) const {
    const double before = vertex.extent.opl_m + ends_.device_legs_m;
    return {tracer_.lengths_.low_m - before, tracer_.lengths_.high_m - before};
}

void EllipsoidalTracer::Walk::extend(PathVertex vertex) {
    const SurfaceWalk& walk = tracer_.surface_walk_;
    while (vertex.order < tracer_.max_order_) {
        if (!walk.survives(vertex, rng_)) return;
        const ConnectionEnds ends = connection_ends(vertex, ends_.light);
        const OplBand lengths = lengths_left(vertex);
        // Every longer path from here takes at least the way straight to the light.
        if (lengths.high_m < (ends.foci.a - ends.foci.b).norm()) return;
        const auto lobe = tracer_.technique_.lobe_of(vertex, ends_.light.position, num_rays_);
        const int num_draws = lobe && lobe->lobe.width_rad < kNarrowLobe_rad ? kDrawsAlongLobes : 1;
        for (int i = 0; i < num_draws; ++i) connect(vertex, ends, lengths, lobe, num_draws);
        const auto pdf = walk.draw_next(vertex, rng_, num_rays_);
        if (!pdf) return;
        if (!tracer_.in_scope(vertex.point.facet)) continue;
        const double value = walk.connection_value(vertex, ends_);
        if (!(value > 0.0) || !histogram_.lets_through(opl_to_light(vertex))) continue;
        const double other = tracer_.technique_.pdf_area(ends, lengths, vertex.point, lobe);
        ++num_rays_;
        if (walk.light_is_hidden(vertex, ends_)) continue;
        deposit(vertex, value * *pdf / (*pdf + num_draws * other));
    }
}

// Draws the vertex between `vertex` and the light on an ellipsoid, once of `num_draws` times.
void EllipsoidalTracer::Walk::connect(const PathVertex& vertex,
                                      const ConnectionEnds& ends,
                                      const OplBand& lengths,
                                      const std::optional<LobeOnFacet>& lobe,
                                      int num_draws) {
    const SurfaceWalk& walk = tracer_.surface_walk_;
    const auto draw = tracer_.technique_.sample(ends, lengths, rng_, lobe);
    if (!draw || !tracer_.in_scope(draw->point.facet)) return;
    const auto step = walk.step_to(vertex, draw->point);
    if (!step) return;
    const PathVertex next =
        walk.advance(vertex, draw->point, *step, step->pdf_area + num_draws * draw->pdf_area);
    const double value = walk.connection_value(next, ends_);
    if (!(value > 0.0) || !histogram_.lets_through(opl_to_light(next))) return;
    ++num_rays_;
    if (walk.light_is_hidden(next, ends_)) return;
    ++num_rays_;
    if (scene_.rays().is_blocked(
            vertex.point.position, vertex.normal, next.point.position, next.normal)) {
        return;
    }
    deposit(next, value);
}

double EllipsoidalTracer::Walk::opl_to_light(const PathVertex& vertex) const {
    return vertex.extent.opl_m + (ends_.light.position - vertex.point.position).norm() +
           ends_.device_legs_m;
}

void EllipsoidalTracer::Walk::deposit(const PathVertex& vertex, double value) {
    histogram_.add(tracer_.by_order_ ? vertex.order - 1 : 0,
                   tracer_.surface_walk_.extent_to_light(vertex, ends_),
                   value);
}

}  // namespace renderer
