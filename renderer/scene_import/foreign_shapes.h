// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"

#include <optional>
#include <string>

namespace renderer {

/// The triangles of a built-in shape of Mitsuba in its own coordinates; round ones are cut into
/// facets whose corners lie on the surface.
///
/// type      rectangle (x, y from -1 to 1), cube (-1 to 1), disk (radius 1 in x, y), sphere (radius
///           1) or cylinder (radius 1 around z from 0 to 1, open)
/// returns   nothing for another type
std::optional<core::TriangleMesh> foreign_shape(const std::string& type);

/// True for shapes that foreign_shape() cuts into facets.
bool is_round(const std::string& type);

}  // namespace renderer
