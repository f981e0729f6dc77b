// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace nlos {

struct Colour {
    std::uint8_t red = 0;
    std::uint8_t green = 0;
    std::uint8_t blue = 0;
};

/// How values become colours: Inferno for amounts of light, Viridis for depths, Cividis for
/// fractions, Diverging for signed differences (white in the middle), Grey for photographs. All but
/// the diverging one grow evenly lighter, so that they survive colour blindness and print.
enum class ColourMap { Inferno, Viridis, Cividis, Diverging, Grey };

/// The map's 256 colours, from the lowest to the highest value.
const std::array<Colour, 256>& colours_of(ColourMap map);

/// The colour at `fraction` of the value range; fractions outside [0, 1] are clamped.
Colour colour_at(ColourMap map, double fraction);

/// The colours of lines and results that are told apart by them, again from the first after the
/// last; colour-blind readers see them apart too.
inline constexpr std::array<Colour, 10> kSeriesColours{{{0, 114, 178},
                                                        {230, 159, 0},
                                                        {0, 158, 115},
                                                        {204, 121, 167},
                                                        {213, 94, 0},
                                                        {86, 180, 233},
                                                        {140, 140, 140},
                                                        {181, 169, 0},
                                                        {139, 69, 19},
                                                        {110, 60, 200}}};
inline Colour series_colour(std::size_t number) {
    return kSeriesColours[number % kSeriesColours.size()];
}

}  // namespace nlos
