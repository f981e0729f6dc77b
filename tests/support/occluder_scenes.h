// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"
#include "tests/support/test_scenes.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace test_support {

/// Hidden sheets behind occluders of one kind and width: slats of a comb, a grid of them, dots or
/// panels.
struct OccluderScene {
    std::string name;
    std::vector<Parallelogram> sheets;  ///< all that reflects and all that hides
    core::WallScan scan;
    core::TimeAxis axis;

    renderer::Scene scene() const;
};

/// A random one, with occluders from 1 mm to 1 m: the same for the same number.
OccluderScene random_occluder_scene(std::uint64_t number);

/// A comb of 200 slats of 2 mm, and 5,000 dots of 4 mm, halfway before a sheet.
OccluderScene comb_of_thin_slats();
OccluderScene thousands_of_dots();

/// Two independent estimates of the third bounce, by rays to random points, one in each cell of a
/// grid on every sheet.
///
/// num_points   of all sheets, about
std::array<std::vector<double>, 2> sampled_third_bounces(const OccluderScene& setup,
                                                         const renderer::Scene& scene,
                                                         double num_points);

/// Relative L2 error of a third bounce. The product of its differences from two independent
/// estimates is free of their noise.
double error_against(const std::array<std::vector<double>, 2>& truths,
                     const core::Transient& transient);

}  // namespace test_support
