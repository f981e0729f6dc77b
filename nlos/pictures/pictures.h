// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/picture.h"
#include "nlos/reconstruction/reconstruction.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/true_surface.h"

#include <vector>

namespace nlos {

// Pictures of results, to be drawn by nlos/pictures/picture.h. All axes are the wall's. Views along
// its normal show what an eye at the wall sees: wall y upwards and wall x running right to left.

/// Front, side and top maximum projections, the depth map and, where reported, the probability of a
/// surface and the standard deviation of depth; two columns align their axes.
std::vector<Panel> volume_panels(const Reconstruction& reconstruction);

/// Streak image of the middle row of wall points, light over the wall, and mean transient.
///
/// Point lists have no picture of the wall; a single time gate has nothing but that. Of a camera:
/// the image of all light, the mean transient, and images in a few gates. Of a sequence: some of
/// its frames on one scale. Behind them velocity_panels().
std::vector<Panel> capture_panels(const core::Capture& capture);

/// What a capture says of path velocities: the image of their mean, the spectrum and, where time is
/// resolved too, power by both. Nothing without velocities; no image of lists and exhaustive scans.
std::vector<Panel> velocity_panels(const core::Capture& capture);

/// The image of a camera, all bins together, as a screen shows it: grey, gamma 2.2, one pixel in a
/// hundred white, small images enlarged.
/// returns   the bytes of a PNG file
std::string encode_preview_png(const core::Capture& capture, const core::PinholeCamera& camera);

/// True depth, reconstructed depth on the same scale, and the signed difference from the nearest
/// true surface of each column.
/// throws    core::Error when the two have different columns
std::vector<Panel> comparison_panels(const Reconstruction& reconstruction,
                                     const core::TrueSurface& truth_of_columns);

/// Values of columns along the wall's normal, such as a maximum projection, as an eye at the wall
/// sees them; `values` are stored [x][y].
ImagePanel front_panel(const std::vector<double>& x_m,
                       const std::vector<double>& y_m,
                       const std::vector<float>& values);

/// True depth and, where known, the albedo seen and how far the surface faces the wall.
std::vector<Panel> truth_panels(const core::DepthMap& truth);

}  // namespace nlos
