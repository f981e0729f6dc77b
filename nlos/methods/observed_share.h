// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"

namespace nlos {

/// Divides the backprojected sums of a capture whose bins were not all observed by the share of
/// each voxel's look-ups that met an observed bin, of those within the axis. What is left are sums
/// as of the whole capture, and no trace of which points were dead or where their gates began.
///
/// Few look-ups that all meet light are weak evidence: no voxel is raised to more than twice what
/// the mean share, over all observed look-ups, would raise it to. A voxel that nobody looked at
/// stays 0.
///
/// input    with `observed`
/// throws   core::Failure when asked to stop
void divide_by_observed_share(const MethodInput& input, std::size_t num_slabs, Volume& volume);

/// Memory that this takes on top of its input [bytes]; 0 when all bins were observed.
double observed_share_bytes(const MethodInput& input);

}  // namespace nlos
