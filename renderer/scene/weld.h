// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

namespace renderer {

/// Puts vertices that differ by rounding alone at one position, that of the first of them: files
/// repeat vertices along seams, where single precision, or sines and cosines of full turns, set
/// them apart; edges there border on each other for all that. A mesh of which a triangle would lose
/// its area stays as it is.
///
/// Rounding: a ten-millionth of the mesh's longest side, which single precision needs, and four
/// roundings of the largest coordinate, far from the origin.
void weld_vertices(core::TriangleMesh& mesh);

}  // namespace renderer
