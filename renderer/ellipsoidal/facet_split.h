// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// Cuts a set of facets into parts over which bounds say much.
///
/// Every cut is the one, by place or by size of the facets, that leaves the least area times
/// surface of the box around it, summed over both sides (the surface area heuristic with area
/// instead of rays): a wall beside many small facets would hide them. Costly parts are cut first.
///
/// set         facets, reordered so that parts follow each other
/// facets      of the scene
/// max_parts  at most this many, at least 2 where the set has 2 facets
/// halve       cut in the middle of the set instead, so that the parts' sizes are sure to fall
/// returns     the parts, none empty, in the order of the set
std::vector<std::span<std::uint32_t>> split_facets(std::span<std::uint32_t> set,
                                                   std::span<const Facet> facets,
                                                   std::size_t max_parts,
                                                   bool halve);

}  // namespace renderer
