// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace nlos {

/// Voxels of a volume that may hold something: where they are, what they hold, who their neighbours
/// are.
struct ActiveVoxels {
    static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

    std::vector<std::size_t> indices;  ///< in the volume [x][y][z], ascending
    std::vector<float> albedo;
    std::array<std::vector<float>, 3> duals;       ///< of total variation
    std::array<std::vector<std::size_t>, 3> next;  ///< along x, y, z; kNone: holds nothing
    std::array<std::vector<std::size_t>, 3> previous;

    std::size_t size() const { return indices.size(); }

    /// Finds `next` and `previous` in a volume of so many voxels along x, y and z.
    void link_neighbours(const std::array<std::size_t, 3>& volume_size);

    /// Those that hold more than `least`, not linked yet.
    ActiveVoxels brighter_than(float least) const;
};

/// Replaces the albedo f by argmin over u >= 0 of
///
///     sum of seen (u - f)^2 / (2 f) + sum of weight |grad u|
///
/// by projected gradients of the dual, started from the last call's.
///
/// seen, weights   one of each voxel, not negative
/// source          [Sawatzky2008]
void smooth_albedo(ActiveVoxels& voxels,
                   const std::vector<float>& seen,
                   const std::vector<float>& weights);

}  // namespace nlos
