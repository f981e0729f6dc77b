// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/film/pass_histogram.h"
#include "renderer/path/endpoint_direction_sampler.h"
#include "renderer/path/path_vertex.h"
#include "renderer/scene/area_sampler.h"

#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// What first vertices need to know about their facets.
class FacetTraits {
 public:
    /// adds_third_bounce   per object: whether its surface may reflect straight to the light
    FacetTraits(const Scene& scene, const std::vector<bool>& adds_third_bounce);

    /// 1 where draws by hidden area reach, 0 on the relay wall.
    double is_hidden(std::uint32_t facet) const { return is_hidden_[facet]; }
    /// BSDF value [1/sr] towards the light where it is the same for all directions and points, else
    /// 0.
    double constant(std::uint32_t facet) const { return constant_[facet]; }
    /// Whether the BSDF depends on directions or place; then constant() is 0.
    bool varies(std::uint32_t facet) const { return varies_[facet] != 0; }
    bool any_varies() const { return any_varies_; }
    /// Whether any surface adds third bounces.
    bool any_adds() const { return any_adds_; }

 private:
    std::vector<double> is_hidden_;
    std::vector<double> constant_;
    std::vector<char> varies_;
    bool any_varies_ = false;
    bool any_adds_ = false;
};

/// The first vertices after the sensor of many paths of one pair, evaluated together: plain arrays
/// with one entry per vertex, so that the compiler fills vector units.
class FirstVertexBatch {
 public:
    static constexpr int kCapacity = 128;  // several ray packets; the arrays fit the L1 cache

    /// How the vertices were drawn.
    struct Draw {
        double weight = 1.0;           ///< of one path
        double area_fraction = 1.0;    ///< fraction drawn by hidden area; the others by direction
        double hidden_pdf_area = 0.0;  ///< density of the former [1/m^2]
    };

    FirstVertexBatch(const Scene& scene, const FacetTraits& traits)
        : scene_(scene), traits_(traits) {}

    int size() const { return count_; }
    bool full() const { return count_ == kCapacity; }
    void clear() {
        count_ = 0;
        num_in_sight_ = 0;
    }

    /// `count` draws from the hidden area, made batch by batch: the points of a randomly shifted
    /// lattice, core::lattice_point().
    struct AreaDraws {
        AreaDraws(int num_draws, core::Rng& rng) : count(num_draws) {
            shift.x() = rng.uniform();
            shift.y() = rng.uniform();
        }
        bool done() const { return begin == count; }

        int count;
        int begin = 0;
        std::size_t hint = 0;
        core::Vec2 shift;
    };
    /// Appends the next points, uniform by area, until the arrays are full or all are done.
    void draw_by_area(const AreaSampler& sampler, AreaDraws& draws);
    /// Fills empty arrays with the points that the next directions hit, until the arrays are nearly
    /// full or all directions are done.
    ///
    /// returns   the number of rays
    std::uint64_t draw_by_direction(EndpointDirectionSampler& directions);
    /// Fills empty arrays with the next draws of both kinds.
    ///
    /// returns   the number of rays
    std::uint64_t draw(EndpointDirectionSampler& directions,
                       const AreaSampler& sampler,
                       AreaDraws& by_area) {
        const std::uint64_t num_rays = draw_by_direction(directions);
        draw_by_area(sampler, by_area);
        return num_rays;
    }

    /// Appends a point; not to be called when full().
    void add(const core::Vec3& position, std::uint32_t facet) {
        const int i = count_++;
        const core::Vec3& normal = scene_.facet(facet).normal;
        facet_[i] = facet;
        x_[i] = position.x();
        y_[i] = position.y();
        z_[i] = position.z();
        normal_x_[i] = normal.x();
        normal_y_[i] = normal.y();
        normal_z_[i] = normal.z();
        is_hidden_[i] = traits_.is_hidden(facet);
        constant_bsdf_[i] = traits_.constant(facet);
    }

    /// Computes throughputs, path lengths and unoccluded contributions of the connections to the
    /// light; for facets with varies() the caller sets the contributions.
    void evaluate(const PathEndpoints& ends, const Draw& draw);
    /// Sets the contributions of vertices that are occluded from an end to 0, and remembers which
    /// are. Vertices found by rays from the sensor are known to be visible to it.
    ///
    /// returns   the number of rays
    std::uint64_t trace_from_sensor(const PathEndpoints& ends) {
        return trace_from(ends.sensor, num_in_sight_);
    }
    std::uint64_t trace_from_light(const PathEndpoints& ends) { return trace_from(ends.light, 0); }
    /// Drops the vertices that were blocked in the last call of trace_from_sensor() or
    /// trace_from_light().
    void keep_seen();
    /// Drops vertices whose own contribution is zero.
    void keep_useful();
    /// Sets contributions of path lengths that the gate does not admit to 0.
    ///
    /// returns   the fraction of all contributions that count; 0 when there are none
    double leave_out_other_lengths(const TimeGate& gate);
    /// Drops vertices by systematic sampling in their order (source [Madow1949]). Those that
    /// contribute at least a step are kept; of the others as many as have steps in their sum, each
    /// of which then contributes a step.
    ///
    /// step_in_means   in mean contributions of all vertices
    void thin(double step_in_means, core::Rng& rng);

    /// A vertex, and the inverse of the probability that it is drawn.
    struct Drawn {
        int index;
        double scale;
    };
    /// The same by throughput, without dropping any; all that carry light when the step is at most
    /// one mean.
    std::vector<Drawn> draw_by_throughput(double step_in_means, core::Rng& rng) const;
    /// Whether it was found by a ray from the sensor.
    bool is_in_sight(int index) const { return index < num_in_sight_; }

    /// The vertex of a path that starts at `sensor`.
    PathVertex vertex(int index, const PathEndpoint& sensor) const;
    std::uint32_t facet(int index) const { return facet_[index]; }
    SurfacePoint point(int index) const {
        return {{x_[index], y_[index], z_[index]}, facet_[index]};
    }
    /// Density of the draw [1/m^2], known after evaluate().
    double pdf_area(int index) const { return pdf_area_[index]; }
    void set_contribution(int index, double value) { contribution_[index] = value; }
    /// Sensor to light by way of each vertex, devices included [m].
    std::span<const double> opl_m() const { return {opl_m_, size_t_count()}; }
    /// How fast these lengths change [m/s], computed by this call; the ends are at rest.
    std::span<const double> find_velocities(const PathEndpoints& ends);
    std::span<const double> contributions() const { return {contribution_, size_t_count()}; }

 private:
    std::size_t size_t_count() const { return static_cast<std::size_t>(count_); }
    int add_on_facet(std::uint32_t facet,
                     const core::DiscreteDistribution::Interval& interval,
                     const double* u1,
                     const double* u2);
    std::uint64_t trace_from(const PathEndpoint& end, int first);
    template <bool kCoincide>
    void evaluate_segments(const PathEndpoints& ends, const Draw& draw);
    template <class Predicate>
    void keep_if(const Predicate& keep);

    static constexpr int kLanes = 8;
    // Points are drawn in groups of kLanes and traced in packets; the last group may overhang.
    static constexpr int kPadded = kCapacity + SegmentPacket::kSize;

    const Scene& scene_;
    const FacetTraits& traits_;
    int count_ = 0;
    int num_in_sight_ = 0;  ///< leading vertices found by rays from the sensor
    std::uint32_t facet_[kPadded];
    bool seen_[kCapacity];
    alignas(64) double x_[kPadded];
    alignas(64) double y_[kPadded];
    alignas(64) double z_[kPadded];
    alignas(64) double normal_x_[kPadded];
    alignas(64) double normal_y_[kPadded];
    alignas(64) double normal_z_[kPadded];
    alignas(64) double constant_bsdf_[kPadded];
    alignas(64) double is_hidden_[kPadded];  ///< 1 where draws by area reach, 0 on the wall
    alignas(64) double pdf_area_[kCapacity];
    alignas(64) double throughput_[kCapacity];
    alignas(64) double opl_m_[kCapacity];
    alignas(64) double velocity_[kCapacity];
    alignas(64) double contribution_[kCapacity];
};

}  // namespace renderer
