// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/methods.h"

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
/// Where the response smears depth by more than the distance of wall points, such scatterers would
/// explain nearly everything. If surfaces that face the wall explain the data clearly better, the
/// background is found with the scene, since a gate full of light shows no dark bins, and a smaller
/// weight of total variation shows finer strokes. Under a spot wider than the distance of wall
/// points, sparsity is reweighted by columns: an empty one costs the most, a bright one next to
/// nothing. The width of the spot is a full width at half maximum; between the points where its
/// light has fallen to 1/e^2 a laser's spot is 1.7 times as wide. Off by a third, it spoils
/// outlines.
///
/// returns    albedo per metre of depth, see albedo_density_of_light(); not negative
/// throws     core::Failure when asked to stop
/// source     [OToole2018], supplement; [Boyd2011]; [Candes2008]; Poisson likelihood
/// [Figueiredo2010]
Volume solve_confocal(const MethodInput& input, const ReconstructSettings& settings);

/// Finds how light falls off on a confocal grid: diffuse, unless a few iterations of the solver
/// explain the data clearly better another way. Counts tell retroreflective light where they are
/// many, and data whose depth is smeared surfaces that face the wall too.
///
/// settings   falloff is not used
/// trial      needed where the response smears depth so far that what a model leaves out looks like
///            surfaces
/// returns    nothing without a confocal grid or need
/// throws     core::Failure when asked to stop
std::optional<FalloffChoice> choose_falloff(const MethodInput& input,
                                            const ReconstructSettings& settings,
                                            FalloffTrial trial);

/// Memory that solve_confocal() takes on top of its input [bytes].
double solve_confocal_bytes(const MethodInput& input, const ReconstructSettings& settings);

}  // namespace nlos
