// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/reconstruction.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/json_fwd.h"

#include <functional>
#include <string>
#include <vector>

namespace nlos {

/// Fills in how uncertain the set-up is where nobody said: 10 ps, 0.3 % and 2 mm for captures that
/// were measured, which is what a careful set-up reaches; 0 for others. `none` is 0, too.
void enter_uncertainties(const core::Capture& capture, SetupSettings& setup);

/// What the uncertainties of a set-up do to the depths of a surface.
///
/// For each parameter that is uncertain a capture with it moved a little is reconstructed, and the
/// depths' derivative is how far the columns' peaks move at the same place of the wall, the median
/// of foreground columns nearby. Nothing but the description differs, so that noise moves with it.
/// Derivatives times standard deviations are added in squares; they are errors common to all
/// columns.
///
/// depth    of the surface
/// setup    with every uncertainty filled in
/// run      the volume of a capture, on columns at its own wall points
/// returns  nothing where every uncertainty is 0 or no column has a depth
std::optional<SetupReport> propagate_setup(const core::Capture& capture,
                                           const core::DepthMap& depth,
                                           const SetupSettings& setup,
                                           const std::function<Volume(const core::Capture&)>& run);

/// What moves the surface by how much, in a line for people.
std::string describe(const SetupReport& report);

/// The standard deviations of a result's set-up, and under `depth_sigma_m` the medians of what
/// `noise` and `setup` make of depths; null: it is exact.
core::Json setup_json(const Reconstruction& result);

}  // namespace nlos
