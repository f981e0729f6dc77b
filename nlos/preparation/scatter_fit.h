// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <cstddef>
#include <limits>
#include <vector>

namespace nlos {

/// A few histograms of a capture, a few dozen bins each: enough to ask whether a geometry can be
/// true.
struct HistogramSample {
    std::vector<std::size_t> pairs;  ///< numbers in the capture
    std::size_t num_bins = 0;        ///< per histogram
    double first_bin = 0.0;          ///< of the capture, where the sample begins
    double merged_bins = 1.0;        ///< bins of the capture in one of these
    std::vector<float> values;       ///< [pair][bin], photon counts or what stands for them
    std::vector<float> observed;     ///< [pair][bin], 1 where something could be recorded, else 0
    std::vector<float> ambient;      ///< per bin of each pair
    bool has_poisson_noise = false;
};

/// Where the light of a sample's histograms went, as a hypothesis has it.
struct PathGeometry {
    std::vector<core::Vec3> illumination;  ///< point of each pair [m]
    std::vector<core::Vec3> sensing;       ///< point of each pair [m]
    std::vector<double> legs_m;            ///< length of the device legs in each pair's axis
    core::Transform world_from_wall = core::Transform::Identity();  ///< z towards the hidden side
    double opl_start_m = 0.0;                                       ///< of the sample's bin 0
    double bin_width_m = 0.0;  ///< of the sample; negative: time runs backwards
};

/// The share of a sample's structure that no hidden scene explains under a geometry.
///
/// The scene is what scatters light evenly from anywhere before the wall: cells in polar
/// coordinates around the middle of the points, each not negative, fitted by expectation
/// maximisation [Shepp1982] with a free gain per histogram, so that angles, materials and gains of
/// pixels matter little; the heaviest cells are halved twice. What is left over, squares in units
/// of the variance that Poisson noise and a model right to a tenth have, without the noise that
/// counts have, is divided by what the mean histogram, scaled to each pair, leaves: 0 is a perfect
/// explanation, and above 1 the geometry explains less than no geometry does.
///
/// hopeless   a share after which the fit is not refined any more: coarse cells often leave more
/// costs      196 pairs of 48 bins: 5e7 terms, some 60 ms on one core
/// returns    1 where all lengths would lie behind the wall
/// throws     nothing
double unexplained_share(const HistogramSample& sample,
                         const PathGeometry& geometry,
                         double hopeless = std::numeric_limits<double>::infinity());

/// Whether histograms differ from each other beyond noise; else all geometries explain them alike.
bool has_structure(const HistogramSample& sample);

}  // namespace nlos
