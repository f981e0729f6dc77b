// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/panel.h"
#include "renderer/core/capture/capture.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace nlos {

// What is shown of a capture's light, by which colours and under which label.

inline constexpr double kBrightestPixels = 0.01;  // of an image's values: highlights, fireflies

/// What the renderers' values are: of 1 W on the lit point, or from the light of a camera.
inline constexpr const char* kRenderedRadiance = "radiance at 1 W [W/(m² sr)]";
inline constexpr const char* kRenderedRadiancePerBin = "radiance per bin at 1 W [W/(m² sr)]";

/// The label of sums over bins; the unit of radiance is given of captures that were rendered, since
/// nobody knows that of others.
std::string light_label(const core::Capture& capture);

/// The label of single bins.
std::string light_per_bin_label(const core::Capture& capture);

/// Pictures of the wall show `WallScan::scanned_points`. Whether these are the illumination points:
bool shows_lit_points(const core::WallScan& scan);

/// The pair that shows a point; of exhaustive scans the one with the middle of the other points.
std::size_t pair_of(const core::WallScan& scan, std::size_t point);

/// The point that a pair is of.
std::size_t point_of(const core::WallScan& scan, std::size_t pair);

/// The mean histogram over all pairs that observed a bin; 0 where none did.
std::vector<double> mean_transient(const core::Capture& capture);

/// First and one past the last bin worth showing: all but the quiet ends.
std::array<std::size_t, 2> shown_bins(const std::vector<double>& mean);

/// The range from 0 to all but a fraction of brightest values, so that a few cannot darken the
/// rest.
std::array<double, 2> light_range(std::vector<float> values, double brightest_fraction);

/// Draws light of which most is far below the brightest on a scale that shows it.
void choose_scale(ImagePanel& panel);

}  // namespace nlos
