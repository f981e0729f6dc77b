// SPDX-License-Identifier: MIT
#include "nlos/solver/active_voxels.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace nlos {
namespace {

constexpr int kSteps = 8;  // of the dual
constexpr std::size_t kNone = ActiveVoxels::kNone;

/// step   how far each voxel gives
/// u      their albedos by the dual as it is
void move_dual(ActiveVoxels& voxels,
               std::size_t i,
               float weight,
               const std::vector<float>& step,
               const std::vector<float>& u) {
    std::array<float, 3> moved{};
    float norm = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t next = voxels.next[axis][i];
        const float other = next != kNone ? u[next] : 0.0F;
        const float most = std::max(step[i], next != kNone ? step[next] : 0.0F);
        const float rate = most > 0.0F ? 1.0F / (12.0F * most) : 0.0F;
        moved[axis] = voxels.duals[axis][i] + rate * (other - u[i]);
        norm += moved[axis] * moved[axis];
    }
    const float shrink = std::sqrt(norm) > weight ? weight / std::sqrt(norm) : 1.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) voxels.duals[axis][i] = shrink * moved[axis];
}

}  // namespace

void ActiveVoxels::link_neighbours(const std::array<std::size_t, 3>& volume_size) {
    std::vector<std::size_t> where(volume_size[0] * volume_size[1] * volume_size[2], kNone);
    for (std::size_t i = 0; i < size(); ++i) where[indices[i]] = i;
    const std::array<std::size_t, 3> strides{volume_size[1] * volume_size[2], volume_size[2], 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        next[axis].assign(size(), kNone);
        previous[axis].assign(size(), kNone);
        for (std::size_t i = 0; i < size(); ++i) {
            const std::size_t at = indices[i] / strides[axis] % volume_size[axis];
            if (at + 1 == volume_size[axis]) continue;
            const std::size_t neighbour = where[indices[i] + strides[axis]];
            next[axis][i] = neighbour;
            if (neighbour != kNone) previous[axis][neighbour] = i;
        }
    }
}

ActiveVoxels ActiveVoxels::brighter_than(float least) const {
    ActiveVoxels kept;
    for (std::size_t i = 0; i < size(); ++i) {
        if (!(albedo[i] > least)) continue;
        kept.indices.push_back(indices[i]);
        kept.albedo.push_back(albedo[i]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            kept.duals[axis].push_back(duals[axis][i]);
        }
    }
    return kept;
}

void smooth_albedo(ActiveVoxels& voxels,
                   const std::vector<float>& seen,
                   const std::vector<float>& weights) {
    const std::size_t count = voxels.size();
    std::vector<float> step(count);  // f / seen: how far a voxel gives
    for (std::size_t i = 0; i < count; ++i) {
        step[i] = seen[i] > 0.0F ? voxels.albedo[i] / seen[i] : 0.0F;
    }
    std::vector<float> u(count);
    for (int k = 0; k <= kSteps; ++k) {
        for (std::size_t i = 0; i < count; ++i) {
            float divergence = 0.0F;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t before = voxels.previous[axis][i];
                divergence += voxels.duals[axis][i];
                if (before != kNone) divergence -= voxels.duals[axis][before];
            }
            u[i] = std::max(0.0F, voxels.albedo[i] + step[i] * divergence);
        }
        if (k == kSteps) break;
        for (std::size_t i = 0; i < count; ++i) move_dual(voxels, i, weights[i], step, u);
    }
    voxels.albedo = std::move(u);
}

}  // namespace nlos
