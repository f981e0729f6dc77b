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
/// The measured intensity enters by its root as amplitude, negative values as 0; the squared
/// magnitude of the field is proportional to the data again.
///
/// input     confocal scan with input.wall.grid; x and y of input.axes at the grid's points
/// settings  falloff
/// num_slabs of |kx|, worked on one after another: the result is the same up to rounding, each
///           repeats the lateral transforms
/// returns   intensity, up to a common factor; not negative
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
