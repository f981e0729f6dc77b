// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/pixel_position_sampler.h"
#include "renderer/restir/packed_reservoirs.h"
#include "renderer/restir/path_candidates.h"
#include "renderer/restir/resampling.h"
#include "renderer/restir/reservoir_bins.h"
#include "renderer/restir/restir_counts.h"
#include "renderer/shift/shift_mapping.h"

#include <memory>
#include <optional>
#include <vector>

namespace renderer {

/// What reservoirs need to know of a scene; the same for all frames in which nothing moves.
struct RestirScene {
    /// scan   must outlive this
    /// axes   of all frames: their spans and kinds count, not where they begin
    RestirScene(std::shared_ptr<const Scene> scene_of_frames,
                const core::Scan& scan,
                const core::HistogramAxes& axes,
                const RenderSettings& settings);
    RestirScene(const RestirScene&) = delete;
    RestirScene& operator=(const RestirScene&) = delete;

    std::shared_ptr<const Scene> scene;
    SensorPairs sensor_pairs;
    SurfaceWalk walk;
    PathCandidates candidates;
    std::optional<ShiftMapping> shift;                 ///< nothing: paths are reused as they are
    std::optional<PixelPositionSampler> pixel_places;  ///< of an image
};

/// One frame's reservoirs, some per pair, and what they belong to.
struct RestirFrame {
    std::shared_ptr<RestirScene> scene;
    ReservoirBins bins;                 ///< of every pair
    std::vector<PathDomain> domains;    ///< per pair, of the frame's own candidates
    PackedReservoirs reservoirs{0, 0};  ///< [pair][bin]
};

/// One reservoir's place: a pair and a gate, in a scene.
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
};

using PathReservoir = Reservoir<ReusablePath>;
using ShiftedSample = std::optional<Carried<ReusablePath>>;

/// Where the paths through one place of a pixel start and end.
PathDomain pixel_domain(const SensorPairs& sensor_pairs,
                        std::size_t pixel,
                        const core::Vec2& pixel_u);

/// Carries a reservoir's path from one place to another, so that it fits the gate there.
///
/// A pixel's paths start anywhere in it: the place within the pixel is a part of the path, and
/// stays when another pixel takes the path over. Objects may have moved in between. The shift is
/// solved in the `current` scene: paths of another one are taken there by the motion of the object
/// that carries the first vertex, both neighbours along with it, which keeps lengths and areas.
///
/// counts    receives shifts and rays
/// returns   the path there, or nothing: what is not carried has no image
ShiftedSample shift_sample(const PathReservoir& reservoir,
                           ReservoirDomain from,
                           ReservoirDomain to,
                           const RestirScene& current,
                           RestirCounts& counts);

}  // namespace renderer
