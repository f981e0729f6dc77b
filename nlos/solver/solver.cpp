// SPDX-License-Identifier: MIT
// The statistical solver: the scene that makes the histograms most likely, given that it has few
// edges and little in it. What a set-up does to light (response, spot, background, bins that were
// not observed) is part of the model instead of being taken off the data.
//
// Confocal scans of even planar grids, with voxel columns at their points, go the way of
// confocal_solver.h, all others that of pair_solver.h. There are no slabs: every iteration needs
// all of the data.
#include "nlos/solver/confocal_solver.h"
#include "nlos/solver/pair_solver.h"

namespace nlos {
namespace {

Volume solve(const MethodInput& input,
             const ReconstructSettings& settings,
             std::size_t /*num_slabs*/) {
    return is_confocal_grid(input) ? solve_confocal(input, settings) : solve_pairs(input, settings);
}

double solve_bytes(const MethodInput& input,
                   const ReconstructSettings& settings,
                   std::size_t /*num_slabs*/) {
    return is_confocal_grid(input) ? solve_confocal_bytes(input, settings)
                                   : solve_pairs_bytes(input);
}

}  // namespace

const MethodTraits kSolver{
    .method = Method::Solver,
    .meaning = "the most likely scene by the noise of the data, with few edges",
    .captures = "all; noisy captures, gates, missing points",
    .run = solve,
    .bytes = solve_bytes,
    .errors = {{.model_fraction = 0.067,
                .noise_fraction = 0.345,
                .doubt = 23.0,
                .plateau = {0.0, 0.4},  // leaves sharp edges
                .steepest = 2.0,
                .front = 0.4},
               {0.0, 0.35}},
    .explains_response = true,
    .explains_background = true,
    .explains_gaps = true,
    .knows_facing = true,
    .choose_falloff = choose_falloff};

}  // namespace nlos
