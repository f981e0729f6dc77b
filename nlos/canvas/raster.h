// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/canvas/colour_map.h"

#include <cstddef>
#include <vector>

namespace nlos {

/// Colours row by row from the top.
struct Raster {
    int columns = 0;
    int rows = 0;
    std::vector<Colour> colours;

    const Colour& at(int x, int y) const {
        return colours[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                       static_cast<std::size_t>(x)];
    }
};

/// A raster of another size, each axis by itself: averaged where it shrinks, every cell in
/// one block where it grows.
///
/// columns, rows   at least 1
Raster resized(const Raster& raster, int columns, int rows);

}  // namespace nlos
