// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"
#include "nlos/containers/shape.h"

namespace nlos {

/// How datasets are created, without times: the same values give the same bytes.
Hdf5Handle plain_creation();

/// How an array is created so that a checksum guards its values: a small one within the header of
/// its object, which has one, a larger one in chunks behind the filter fletcher32. Floating-point
/// numbers that a damaged index of chunks no longer finds read as infinity, which no array of ours
/// holds; others as 0.
///
/// type   of the values, an HDF5 identifier
Hdf5Handle guarded_creation(std::int64_t type, const Shape& shape);

/// Of an array that is written piece by piece, how many rows along the slowest index a piece best
/// has: whole chunks of a few megabytes.
std::size_t rows_of_write(const Shape& shape, std::size_t value_bytes);

}  // namespace nlos
