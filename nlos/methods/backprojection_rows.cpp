// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"

#include <cmath>
#include <map>

namespace nlos {
namespace {

constexpr std::size_t kMaxStep = 4;

double spacing(const std::vector<double>& positions) {
    return (positions.back() - positions.front()) / static_cast<double>(positions.size() - 1);
}

}  // namespace

std::optional<CommonLattice> common_lattice(const WallGrid& grid, const std::vector<double>& y_m) {
    if (y_m.empty()) return std::nullopt;
    if (y_m.size() == 1) return CommonLattice{};
    for (std::size_t voxel_step = 1; voxel_step <= kMaxStep; ++voxel_step) {
        for (std::size_t wall_step = 1; wall_step <= kMaxStep; ++wall_step) {
            const double mismatch = static_cast<double>(voxel_step) * spacing(y_m) -
                                    static_cast<double>(wall_step) * grid.pitch_m[1];
            const double drift = std::abs(mismatch) * static_cast<double>(y_m.size());
            if (drift < 1e-6 * grid.pitch_m[1]) return CommonLattice{voxel_step, wall_step};
        }
    }
    return std::nullopt;
}

RowPairs pair_rows(const WallGrid& grid, const std::vector<double>& x_m) {
    RowPairs pairs;
    std::map<long long, std::size_t> known;
    const double quantum = 1e-6 * grid.pitch_m[0];
    pairs.of_wall_row.resize(grid.size[0]);
    for (std::size_t wall = 0; wall < grid.size[0]; ++wall) {
        std::map<std::size_t, Offset> offsets;
        for (std::size_t voxel = 0; voxel < x_m.size(); ++voxel) {
            const double dx = std::abs(x_m[voxel] - grid.x_m(wall));
            const auto [entry, is_new] =
                known.try_emplace(std::llround(dx / quantum), pairs.distances_m.size());
            if (is_new) pairs.distances_m.push_back(dx);
            Offset& offset = offsets[entry->second];
            offset.distance = entry->second;
            offset.voxel_rows.push_back(voxel);
        }
        for (auto& [distance, offset] : offsets) pairs.of_wall_row[wall].push_back(offset);
    }
    return pairs;
}

}  // namespace nlos
