// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/pixel_position_sampler.h"
#include "renderer/restir/path_candidates.h"
#include "renderer/restir/resampling.h"
#include "renderer/restir/restir_counts.h"
#include "renderer/shift/shift_mapping.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace renderer {

/// A scene prepared for resampling; shared by all frames in which nothing moves.
struct RestirScene {
    /// scan   must outlive this
    /// axes   of any frame: only their spans and kinds matter, not where they begin
    RestirScene(std::shared_ptr<const Scene> scene_of_frames,
                const core::Scan& scan,
                const core::HistogramAxes& axes,
                const RenderSettings& settings);
    RestirScene(const RestirScene&) = delete;
    RestirScene& operator=(const RestirScene&) = delete;

    std::shared_ptr<const Scene> scene;
    SensorPairs sensor_pairs;
    RandomWalk walk;
    PathCandidates candidates;
    std::optional<ShiftMapping> shift;                    ///< nothing: paths are reused as they are
    std::optional<PixelPositionSampler> pixel_positions;  ///< of an image
};

/// Many finished reservoirs of paths, stored compactly for paths of limited length.
class PackedReservoirs {
 public:
    PackedReservoirs(std::size_t count, int max_vertices)
        : max_vertices_(static_cast<std::size_t>(max_vertices)),
          heads_(count),
          vertices_(count * max_vertices_) {}

    std::size_t size() const { return heads_.size(); }

    /// Memory of one reservoir [bytes].
    static double bytes_per_reservoir(int max_vertices) {
        return static_cast<double>(sizeof(Head)) +
               static_cast<double>(max_vertices) * static_cast<double>(sizeof(SurfacePoint));
    }

    Reservoir<ReusablePath> load(std::size_t index) const {
        const Head& head = heads_[index];
        Reservoir<ReusablePath> reservoir;
        reservoir.target_value = head.target_value;
        reservoir.contribution_weight = head.contribution_weight;
        reservoir.confidence = double{head.confidence};
        reservoir.sample.num_vertices = head.num_vertices;
        reservoir.sample.pixel_u = head.pixel_u;
        const SurfacePoint* const stored = vertices_.data() + index * max_vertices_;
        std::copy(stored, stored + head.num_vertices, reservoir.sample.vertices.begin());
        return reservoir;
    }

    void store(std::size_t index, const Reservoir<ReusablePath>& reservoir) {
        Head& head = heads_[index];
        head.target_value = reservoir.target_value;
        head.contribution_weight = reservoir.contribution_weight;
        head.confidence = static_cast<float>(reservoir.confidence);
        head.num_vertices = reservoir.empty() ? 0 : reservoir.sample.num_vertices;
        head.pixel_u = reservoir.sample.pixel_u;
        std::copy_n(reservoir.sample.vertices.begin(),
                    head.num_vertices,
                    vertices_.data() + index * max_vertices_);
    }

 private:
    struct Head {
        double target_value = 0.0;
        double contribution_weight = 0.0;
        core::Vec2 pixel_u = core::Vec2::Zero();
        float confidence = 0.0F;
        std::int32_t num_vertices = 0;
    };

    std::size_t max_vertices_;
    std::vector<Head> heads_;
    std::vector<SurfacePoint> vertices_;
};

/// The reservoirs of one pair: one per bin of the time axis or, with a velocity axis, one per bin
/// of that (of both, where velocities are resolved in time). The last one then holds the paths
/// outside the velocity axis; it serves the time histogram alone and is not reused.
class ReservoirBins {
 public:
    ReservoirBins() = default;
    /// shape   of the gate of a time axis with one bin
    ReservoirBins(const core::HistogramAxes& axes, GateShape shape) : axes_(axes), shape_(shape) {}

    const core::HistogramAxes& axes() const { return axes_; }

    std::size_t count() const {
        return axes_.velocity ? num_velocity_values() + 1
                              : static_cast<std::size_t>(axes_.time.num_bins);
    }
    bool is_left_out(std::size_t bin) const {
        return axes_.velocity && bin == num_velocity_values();
    }

    /// The gate of all reservoirs together.
    TimeGate lengths() const { return TimeGate::of_axis(axes_.time, shape_); }
    /// The bin of a path; nothing when its length lies outside.
    std::optional<std::size_t> bin_of(const OpticalPath& path) const;
    /// The gate of a bin; not for the one outside the velocity axis.
    PathGate gate(std::size_t bin) const;

    /// The next bin along the quantity that shifts preserve, `step` is 1 or -1; nothing at the
    /// ends.
    std::optional<std::size_t> beside(std::size_t bin, int step) const;

    /// The time and the velocity bin of a reservoir; nothing where it holds paths of several.
    std::optional<int> time_bin(std::size_t bin) const;
    std::optional<int> velocity_bin(std::size_t bin) const;

 private:
    std::size_t num_velocity_values() const {
        return static_cast<std::size_t>(axes_.velocity->num_values(axes_.time.num_bins));
    }
    /// Reservoirs of one bin of velocity.
    std::size_t stride() const {
        return axes_.velocity && axes_.velocity->with_time
                   ? static_cast<std::size_t>(axes_.time.num_bins)
                   : 1;
    }

    core::HistogramAxes axes_;
    GateShape shape_ = GateShape::Box;
};

/// The reservoirs of one frame, with their scene, bins and domains.
struct RestirFrame {
    std::shared_ptr<RestirScene> scene;
    ReservoirBins bins;                 ///< of every pair
    std::vector<PathDomain> domains;    ///< per pair, of the frame's own candidates
    PackedReservoirs reservoirs{0, 0};  ///< [pair][bin]
    std::vector<float> candidates{};    ///< likewise: what the frame's own candidates estimate
};

/// The domain of a reservoir: a pair and a gate, in a scene.
struct ReservoirDomain {
    const RestirScene* scene = nullptr;
    const PathDomain* domain = nullptr;  ///< of a pixel, the one of the frame's own candidates
    PathGate gate;
    std::size_t pair = 0;

    ReservoirDomain() = default;
    ReservoirDomain(const RestirFrame& frame, std::size_t pair_index, std::size_t bin)
        : scene(frame.scene.get()),
          domain(&frame.domains[pair_index]),
          gate(frame.bins.gate(bin)),
          pair(pair_index) {}

    /// Whether the same paths have the same target values in another domain.
    bool is_same_as(const ReservoirDomain& other) const {
        return scene == other.scene && pair == other.pair && gate == other.gate;
    }
};

using PathReservoir = Reservoir<ReusablePath>;
using ShiftedSample = std::optional<Carried<ReusablePath>>;

/// The ends of the paths through one position within a pixel.
PathDomain pixel_domain(const SensorPairs& sensor_pairs,
                        std::size_t pixel,
                        const core::Vec2& pixel_u);

/// Shifts a reservoir's path from one domain to another, so that it fits the gate there.
///
/// The position within the pixel where an image's path starts is part of the path, and is kept when
/// another pixel reuses it. Objects may have moved between the frames of the two domains. The shift
/// is solved in the `current` scene: the first vertex and both its neighbours are brought there by
/// the motion of the object with the first vertex, which preserves lengths and areas.
///
/// counts    receives shifts and rays
/// returns   the shifted path; nothing where the shift is not defined
ShiftedSample shift_sample(const PathReservoir& reservoir,
                           ReservoirDomain from,
                           ReservoirDomain to,
                           const RestirScene& current,
                           RestirCounts& counts);

}  // namespace renderer
