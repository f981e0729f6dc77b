// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/reconstruction.h"

#include <string>

namespace nlos {

/// Writes VOLUME.h5: volume, axes, depth_m, depth_sigma_m and surface_probability where reported,
/// max_projection, normals, points, attributes. Places and directions state their frame and unit.
/// throws    core::Error for a bad target, core::Failure when writing fails
void write_volume(const std::string& path, const Reconstruction& reconstruction);

/// Reads what write_volume() wrote. Throws core::Error when the file is something else or damaged.
Reconstruction read_volume(const std::string& path);

/// True for an HDF5 file with a dataset `volume`.
bool is_volume_file(const std::string& path);

}  // namespace nlos
