// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace nlos {

/// A run [begin, end) of what a method can treat by parts, so that as much as memory holds is
/// worked on at a time: frequencies, rows of a grid.
struct Slab {
    std::size_t begin = 0, end = 0;

    std::size_t size() const { return end - begin; }
    /// The fraction of a method's progress that belongs to this slab of `count`.
    core::Progress part_of(const core::Progress& progress, std::size_t count) const {
        const double all = static_cast<double>(count);
        return progress.part(static_cast<double>(begin) / all, static_cast<double>(end) / all);
    }
};

/// The largest slab when `count` is split into `num_slabs`.
inline std::size_t largest_slab(std::size_t count, std::size_t num_slabs) {
    return (count + num_slabs - 1) / num_slabs;
}

/// [0, count) in at most `num_slabs` runs of nearly equal size, none of them empty.
inline std::vector<Slab> split_into_slabs(std::size_t count, std::size_t num_slabs) {
    const std::size_t num_runs = std::min(count, num_slabs);
    std::vector<Slab> slabs;
    for (std::size_t i = 0; i < num_runs; ++i) {
        slabs.push_back({i * count / num_runs, (i + 1) * count / num_runs});
    }
    return slabs;
}

}  // namespace nlos
