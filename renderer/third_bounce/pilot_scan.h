// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/scene/scene.h"

namespace renderer {

/// The pairs on which the deterministic integrator tries out how fine is fine enough: some points
/// of each side, spread evenly and out of step with rows of a grid; more of them for few bins,
/// where there is less to compare per pair. Where there are retroreflectors and some pair's ends
/// coincide, that is so for one of these pairs, too: what it returns outshines everything else.
core::Scan pilot_scan(const Scene& scene, const core::Scan& scan, int num_bins);

/// Bins that begin at multiples of their width, so that a shift of the axis by part of a bin
/// changes no choice and no energy; few bins are tried as they are.
core::TimeAxis pilot_axis(const core::TimeAxis& axis);

}  // namespace renderer
