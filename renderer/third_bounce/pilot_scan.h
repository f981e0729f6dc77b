// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/scene/scene.h"

namespace renderer {

/// The pairs on which the deterministic integrator finds the refinement level it needs: some points
/// of each side, spread evenly but not in step with the rows of a grid, or all where these are at
/// most twice as many; more of them for few bins, where there is less to compare per pair. Where
/// there are retroreflectors and the scan has confocal pairs, one of these is among them, since its
/// light outshines everything else.
core::Scan pilot_scan_for(const Scene& scene, const core::Scan& scan, int num_bins);
/// The same with a number of points on each side.
core::Scan pilot_scan(const Scene& scene, const core::Scan& scan, std::size_t num_points);

/// The axis of pilot runs: bins begin at multiples of their width, so that shifting the axis by
/// part of a bin changes neither the level chosen nor the energy. Axes with few bins are kept as
/// they are.
core::TimeAxis pilot_axis(const core::TimeAxis& axis);

}  // namespace renderer
