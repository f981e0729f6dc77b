// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/reconstruct_settings.h"
#include "nlos/reconstruction/volume.h"
#include "renderer/core/depth_map.h"
#include "renderer/core/mesh.h"
#include "renderer/core/settings/boxed_json.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What the uncertainty of one of a set-up's parameters does to a surface.
struct SetupEffect {
    std::string parameter;  ///< for people
    std::string amount;     ///< its standard deviation, for people
    double depth_m = 0.0;   ///< by which that moves depths: the median
};

/// What those of a set-up do, see propagate_setup().
struct SetupReport {
    std::vector<SetupEffect> effects;
    std::vector<double> sigma_m;          ///< per column, of all together; NaN = background
    double depth_sigma_m = 0.0;           ///< median of these
    std::optional<double> noise_sigma_m;  ///< that of noise beside it; nothing: not known
};

/// What reconstruct() found, and what it took.
struct Reconstruction {
    Volume volume;
    core::DepthMap depth;  ///< sub-bin depth of each column's peak; NaN = background
    std::vector<double> surface_probability;  ///< per column [x][y]; empty: not given
    std::vector<double> depth_sigma_m;   ///< of `depth`, by noise and set-up; NaN = background;
                                         ///< empty: noise not known
    std::vector<std::uint8_t> observed;  ///< per column, 1 where the scan's geometry tells places
                                         ///< from others across the volume, else 0
    std::optional<SetupReport> setup;    ///< where it is uncertain
    core::PointCloud points;  ///< foreground of `depth` in world coordinates, normals to the wall
    /// How far apart the scan tells positions at the middle of its light, in the direction told
    /// worst [m]: the same for every method; nothing where no distance is enough or nobody knows.
    std::optional<double> resolution_m;
    std::string method;                 ///< the one that ran
    std::string reason;                 ///< why `auto` took it
    std::vector<std::string> findings;  ///< what `auto` found looking at the capture, a line each
    ReconstructSettings settings;       ///< with every choice filled in
    std::vector<std::string> warnings;  ///< what looks wrong about the capture
    core::BoxedJson provenance;         ///< who made it from what, as the caller says
    double seconds = 0.0;
    double estimated_bytes = 0.0;  ///< memory on top of the capture, announced before the run
    std::uint64_t peak_bytes = 0;
};

}  // namespace nlos
