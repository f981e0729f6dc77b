// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// Splits a set of facets into parts with tight bounds.
///
/// Every split, by position or by size of the facets, minimises the facets' area times the surface
/// area of their bounding box, summed over both sides: the surface area heuristic with area in
/// place of the number of primitives, since a wall among many small facets would dominate their
/// bounds. The costliest part is split first.
///
/// set         facets, reordered so that parts follow each other
/// facets      of the scene
/// max_parts   at most this many, at least 2 where the set has 2 facets
/// halve       split in the middle of the set instead, so that the depth is bounded
/// returns     the parts, none empty, in the order of the set
std::vector<std::span<std::uint32_t>> split_facets(std::span<std::uint32_t> set,
                                                   std::span<const Facet> facets,
                                                   std::size_t max_parts,
                                                   bool halve);

}  // namespace renderer
