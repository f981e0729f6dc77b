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
    SurfaceWalk walk;
    PathCandidates candidates;
    std::optional<ShiftMapping> shift;                 ///< nothing: paths are reused as they are
    std::optional<PixelPositionSampler> pixel_places;  ///< of an image
};

/// The reservoirs of one frame, with their scene, bins and domains.
struct RestirFrame {
    std::shared_ptr<RestirScene> scene;
    ReservoirBins bins;                 ///< of every pair
    std::vector<PathDomain> domains;    ///< per pair, of the frame's own candidates
    PackedReservoirs reservoirs{0, 0};  ///< [pair][bin]
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
