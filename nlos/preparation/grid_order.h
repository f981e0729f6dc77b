// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/wall_scan.h"

#include <cstddef>
#include <vector>

namespace nlos {

/// Sorts wall points that fill an even planar grid but are not stored as one (a list in any order,
/// rows of one column) into it: x before y, both ascending, x and y the grid's directions nearest
/// to those of a list's frame (see derive_wall_frame()). How points are stored then changes nothing
/// of what is made of them.
///
/// scan      illumination and sensing points are sorted each for itself, confocal ones together
/// returns   of every pair of the sorted scan, its number in the scan as it was
std::vector<std::size_t> sort_into_grids(core::WallScan& scan);

}  // namespace nlos
