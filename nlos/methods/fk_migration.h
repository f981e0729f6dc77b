// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// f-k migration: a confocal scan of a plane is the wave field, at the plane, of a wave that starts
/// everywhere on the hidden surface at once and travels with one metre of range per metre. Its
/// spectrum is moved from (kx, ky, f) to (kx, ky, kz) with f^2 = kx^2 + ky^2 + kz^2, which gives
/// the field at the start.
///
/// That wave, of amplitude f at the start, is d/dr (r M) at range r, M being the mean of f over the
/// sphere of that radius. What is measured is the sum of f / r^4 over the sphere on diffuse
/// surfaces and of f / r^2 on retroreflecting ones: times r^3 or r, and derived along range, it is
/// the wave. [Lindell2019] takes the root of what is measured for it. But light of several surfaces
/// adds up, its root does not, so that they blur each other's depths; and without the derivative a
/// haze of low frequencies lies about them.
///
/// input     confocal scan with input.wall.grid; x and y of input.axes at the grid's points
/// settings  falloff
/// num_slabs of |kx|, worked on one after another: the result is the same up to rounding, each
///           repeats the lateral transforms
/// returns   magnitude of the field, up to a common factor
/// throws    core::Failure when asked to stop
/// source    [Lindell2019]
Volume fk_migration(const MethodInput& input,
                    const ReconstructSettings& settings,
                    std::size_t num_slabs = 1);

/// Memory that fk_migration() takes on top of its input, its volume included [bytes].
double fk_migration_bytes(const MethodInput& input,
                          const ReconstructSettings& settings,
                          std::size_t num_slabs = 1);

}  // namespace nlos
