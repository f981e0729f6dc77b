// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>

namespace nlos {

struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;
};

/// How values become colours: Inferno for amounts of light, Viridis for depths, Diverging for
/// signed differences (white in the middle), Grey for photographs.
enum class ColourMap { Inferno, Viridis, Diverging, Grey };

/// The map's 256 colours, from the lowest to the highest value.
const std::array<Colour, 256>& colours_of(ColourMap map);

/// The colour at `share` of the value range; shares outside [0, 1] are clamped.
Colour colour_at(ColourMap map, double share);

}  // namespace nlos
