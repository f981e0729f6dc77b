// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <string>

namespace nlos {

/// Statistical reconstruction of a confocal grid: the albedo f >= 0 that minimises
///
///     -log likelihood(histograms | B K f + background) + tv |grad f|_1 + sparsity |f|_1,
///
/// K the light-cone convolution (ConeConvolution), B what follows it in time (TimeOperator), over
/// the observed bins alone. The weights of both norms are multiples of what the data's own noise
/// makes of a voxel (settings.solver). Scatterers outside the wall's footprint are allowed, but
/// cost their square, for what the model leaves out; with falloff=facing it knows the cosines too,
/// and there are none. By the alternating direction method of multipliers, until neither the result
/// nor the constraints change by more than settings.solver.tolerance.
///
/// num_slabs  not used: every iteration needs all frequencies
/// returns    albedo per metre of depth, up to a common factor; not negative
/// throws     core::Failure when asked to stop
/// source     [OToole2018], supplement; [Boyd2011]; [Candes2008]; Poisson likelihood
/// [Figueiredo2010]
Volume solve_confocal(const MethodInput& input,
                      const ReconstructSettings& settings,
                      std::size_t num_slabs);

/// How light falls off with range, and why, for people.
struct FalloffChoice {
    Falloff falloff = Falloff::Diffuse;
    std::string reason;
};

/// Whether the response smears depth so far that what a model leaves out looks like surfaces.
bool needs_falloff_choice(const MethodInput& input);

/// Finds how light falls off on a confocal grid: diffuse, unless a few iterations of the solver
/// explain the data clearly better another way. Counts tell retroreflective light where they are
/// many, and data whose depth is smeared surfaces that face the wall too.
///
/// settings   falloff is not used
/// throws     core::Failure when asked to stop
FalloffChoice choose_falloff(const MethodInput& input, ReconstructSettings settings);

/// Memory that solve_confocal() takes on top of its input [bytes].
double solve_confocal_bytes(const MethodInput& input,
                            const ReconstructSettings& settings,
                            std::size_t num_slabs);

}  // namespace nlos
