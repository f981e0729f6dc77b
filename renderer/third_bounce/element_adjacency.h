// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/surface_elements.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace renderer {

/// Pairs of elements (indices into `elements`) that share an edge, or of which one has half an edge
/// of the other. Positions must agree to the last bit, as those of one cut do.
std::vector<std::pair<std::uint32_t, std::uint32_t>> adjacent_elements(
    std::span<const SurfaceElement> elements);

/// The lists of both ends of every pair, without duplicates, in rising order.
AdjacencyLists adjacency_lists(std::size_t num_items,
                               const std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs);

}  // namespace renderer
