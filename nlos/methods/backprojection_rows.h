// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/wall_frame.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace nlos {

/// Voxels and wall points along y seen as every n-th point of one lattice.
struct CommonLattice {
    std::size_t voxel_step = 1;
    std::size_t wall_step = 1;
};

/// The coarsest lattice of steps up to 4 that holds the grid's y positions and `y_m`, if any.
std::optional<CommonLattice> common_lattice(const WallGrid& grid, const std::vector<double>& y_m);

/// Voxel rows that one wall row serves at one |dx|: usually the two at +dx and -dx.
struct Offset {
    std::size_t distance = 0;  ///< index into the list of distinct |dx|
    std::vector<std::size_t> voxel_rows;
};

/// Pairs of wall rows and voxel rows, grouped by |dx|.
struct RowPairs {
    std::vector<double> distances_m;
    std::vector<std::vector<Offset>> of_wall_row;
};

/// Groups the rows of a grid and rows of voxels at `x_m` by how far they lie apart along x.
RowPairs pair_rows(const WallGrid& grid, const std::vector<double>& x_m);

}  // namespace nlos
