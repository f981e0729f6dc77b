// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/ellipsoidal_tracer.h"

#include "renderer/core/sampling.h"

#include <algorithm>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

// Fraction of samples that choose the length first. They cost several times as much as the others,
// of which only the fraction `asked` has a length within the axis (constants tuned on scenes/bars
// and scenes/letter).
double ellipsoidal_fraction(double asked) {
    constexpr double kMax = 0.85;
    constexpr double kMin = 0.05;
    constexpr double kHalved = 0.3;
    return std::max(kMin, kMax / (1.0 + asked / kHalved));
}

// Connections per vertex with a lobe narrower than this: its reflections make bright, noisy pixels.
constexpr int kDrawsAlongLobes = 6;
constexpr double kNarrowLobe_rad = 0.2;

// A Gaussian gate has fallen to e^-10 of its peak this many widths from its centre; what lies
// beyond is left to the walk.
constexpr double kGaussianReach = 4.5;

// Entries of a pair's cut: enough to single out facets, few compared with the samples.
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

}  // namespace

class EllipsoidalTracer::Walk : public PairWalk {
 public:
    Walk(const EllipsoidalTracer& tracer,
         const PathEndpoints& ends,
         core::Rng& rng,
         PassHistogram& histogram)
        : PairWalk(tracer, ends, rng, histogram),
          tracer_(tracer),
          cut_(tracer.technique_.hierarchy()) {}

    void trace_samples(int count) override;
    void trace_pixel_samples(const SensorPairs& sensor_pairs,
                             std::size_t pixel,
                             int count,
                             const LightSubpaths* subpaths) override;

 private:
    void cut_hierarchy(int num_samples);
    void trace_connections(int count);
    void finish_connections();
    void weigh_first_vertices() override;
    void weigh(int index, double ellipsoidal_pdf);
    void extend(PathVertex vertex) override;
    void connect(const PathVertex& vertex,
                 const ConnectionEnds& ends,
                 const OplBand& lengths,
                 const std::optional<LobeOnFacet>& lobe,
                 int num_draws);
    double opl_to_light(const PathVertex& vertex) const;

    const EllipsoidalTracer& tracer_;
    HierarchyCut cut_;                   ///< for third bounces
    double ellipsoidal_fraction_ = 0.0;  ///< of third bounces
    double walk_weight_ = 0.0;           ///< of one walk: 1 / their expected number
    std::array<double, FirstVertexBatch::kCapacity> ellipsoidal_pdf_;
};

EllipsoidalTracer::EllipsoidalTracer(const Scene& scene,
                                     const core::Scan& scan,
                                     const core::TimeAxis& axis,
                                     const RenderSettings& settings,
                                     ConnectionScope scope,
                                     ThirdBounceScope third_bounces)
    : Tracer(scene, settings, third_bounces),
      scope_(scope),
      lengths_(lengths_of_gate(axis, settings.gate)),
      excluded_(ExcludedFacets::of(scene, axis, settings)),
      technique_(scene, excluded_, scan) {
    const SensorPairs sensor_pairs(scene, scan);
    if (sensor_pairs.is_image()) pixel_positions_.emplace(sensor_pairs, sensor_pairs.camera());
}

std::unique_ptr<PairWalk> EllipsoidalTracer::start(const PathEndpoints& ends,
                                                   core::Rng& rng,
                                                   PassHistogram& histogram) const {
    return std::make_unique<Walk>(*this, ends, rng, histogram);
}

void EllipsoidalTracer::Walk::trace_samples(int count) {
    cut_hierarchy(count);
    // Numbers of each kind are rounded at random, so that their means are the fractions that the
    // weights assume: all by the same number, so that none takes from another.
    const double u = rng_.uniform();
    const auto rounded = [&](double expected) { return static_cast<int>(expected + u); };
    const double fraction = ellipsoidal_fraction_;
    const int num_connections = rounded(count * fraction);
    const int num_chosen = rounded(count * (fraction + (1.0 - fraction) * kAreaFractionFromWall));
    trace_connections(num_connections);
    trace_walks(num_chosen - num_connections, count - num_chosen, walk_weight_);
}

// For third bounces, before any is traced.
void EllipsoidalTracer::Walk::cut_hierarchy(int num_samples) {
    const OplBand lengths{tracer_.lengths_.low_m - ends_.device_segments_m,
                          tracer_.lengths_.high_m - ends_.device_segments_m};
    if (tracer_.facet_traits_.any_adds() && tracer_.connects()) {
        cut_.rebuild(connection_ends(ends_),
                     lengths,
                     std::max(kMinEntries, static_cast<std::size_t>(num_samples)));
    }
    if (!cut_.empty()) ellipsoidal_fraction_ = ellipsoidal_fraction(cut_.fraction_asked());
    walk_weight_ = 1.0 / (num_samples * (1.0 - ellipsoidal_fraction_));
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
    evaluate_first_vertices(walk_weight_);
    for (int i = 0; i < first_.size(); ++i) {
        weigh(i, ellipsoidal_pdf_[static_cast<std::size_t>(i)]);
    }
    first_.keep_useful();
    num_rays_ += first_.trace_from_sensor(ends_);
    if (!ends_.coincide) first_.keep_useful();
    connect_first_vertices();
}

void EllipsoidalTracer::Walk::trace_pixel_samples(const SensorPairs& sensor_pairs,
                                                  std::size_t pixel,
                                                  int count,
                                                  const LightSubpaths*) {
    const RandomWalk& walk = tracer_.random_walk_;
    const PixelPositionSampler::Band band = tracer_.pixel_positions_->band(pixel, tracer_.lengths_);
    const Vec2 shift(rng_.uniform(), rng_.uniform());
    for (int i = 0; i < count; ++i) {
        const Vec2 position = band.sample(core::lattice_point(i, count, shift));
        auto vertex = sensor_pairs.first_vertex(pixel, position);
        ++num_rays_;
        if (!vertex || vertex->order > tracer_.max_order_) continue;
        vertex->throughput /= count * band.pdf(position);
        const double value = walk.connection_value(*vertex, ends_);
        if (value > 0.0 && tracer_.scope_ != ConnectionScope::Excluded &&
            histogram_.gate().admits(opl_to_light(*vertex))) {
            connect_to_light(*vertex, value);
        }
        extend(*vertex);
    }
}

void EllipsoidalTracer::Walk::weigh_first_vertices() {
    for (int i = 0; i < first_.size(); ++i) {
        const double opl_m = first_.opl_m()[static_cast<std::size_t>(i)];
        if (first_.contributions()[static_cast<std::size_t>(i)] == 0.0) continue;
        const bool asked = opl_m >= tracer_.lengths_.low_m && opl_m <= tracer_.lengths_.high_m;
        weigh(i, asked ? tracer_.technique_.pdf_area(cut_, first_.point(i)) : 0.0);
    }
}

// Divides a contribution by the density of both techniques together instead of that of the walk.
// Vertices whose paths have other lengths than those asked for, or whose facets are out of scope,
// get 0, so that no ray is traced for them.
void EllipsoidalTracer::Walk::weigh(int index, double ellipsoidal_pdf) {
    const auto i = static_cast<std::size_t>(index);
    const double by_walk = (1.0 - ellipsoidal_fraction_) * first_.pdf_area(index);
    const double both = by_walk + ellipsoidal_fraction_ * ellipsoidal_pdf;
    const bool keeps = histogram_.gate().admits(first_.opl_m()[i]) &&
                       tracer_.in_scope(first_.facet(index)) && both > 0.0;
    first_.set_contribution(index, keeps ? first_.contributions()[i] * by_walk / both : 0.0);
}

void EllipsoidalTracer::Walk::extend(PathVertex vertex) {
    const RandomWalk& walk = tracer_.random_walk_;
    while (vertex.order < tracer_.max_order_) {
        if (!walk.survives(vertex, rng_)) return;
        const ConnectionEnds ends = connection_ends(vertex, ends_.light);
        // What is left of the lengths asked for, for the two segments to the light.
        const double before = vertex.optical_path.opl_m + ends_.device_segments_m;
        const OplBand lengths{tracer_.lengths_.low_m - before, tracer_.lengths_.high_m - before};
        // No longer path from here is shorter than the one straight to the light.
        if (lengths.high_m < (ends.foci.a - ends.foci.b).norm()) return;
        std::optional<LobeOnFacet> lobe;
        int num_draws = 0;
        if (tracer_.connects()) {
            lobe = tracer_.technique_.lobe_of(vertex, ends_.light.position, num_rays_);
            num_draws = lobe && lobe->lobe.width_rad < kNarrowLobe_rad ? kDrawsAlongLobes : 1;
        }
        for (int i = 0; i < num_draws; ++i) connect(vertex, ends, lengths, lobe, num_draws);
        const auto pdf = walk.draw_next(vertex, rng_, num_rays_);
        if (!pdf) return;
        if (!tracer_.in_scope(vertex.point.facet)) continue;
        const double value = walk.connection_value(vertex, ends_);
        if (!(value > 0.0) || !histogram_.gate().admits(opl_to_light(vertex))) continue;
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
    const RandomWalk& walk = tracer_.random_walk_;
    const auto draw = tracer_.technique_.sample(ends, lengths, rng_, lobe);
    if (!draw || !tracer_.in_scope(draw->point.facet)) return;
    const auto step = walk.step_to(vertex, draw->point);
    if (!step) return;
    const PathVertex next =
        walk.advance(vertex, draw->point, *step, step->pdf_area + num_draws * draw->pdf_area);
    const double value = walk.connection_value(next, ends_);
    if (!(value > 0.0) || !histogram_.gate().admits(opl_to_light(next))) return;
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
    return vertex.optical_path.opl_m + (ends_.light.position - vertex.point.position).norm() +
           ends_.device_segments_m;
}

}  // namespace renderer
