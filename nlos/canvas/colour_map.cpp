// SPDX-License-Identifier: MIT
#include "nlos/canvas/colour_map.h"

#include "nlos/canvas/colour_tables.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using Table = std::array<Colour, 256>;

Table unpacked(const std::array<std::uint32_t, 256>& colours) {
    Table table;
    std::transform(colours.begin(), colours.end(), table.begin(), [](std::uint32_t rgb) {
        const auto byte = [rgb](int shift) { return static_cast<std::uint8_t>(rgb >> shift); };
        return Colour{byte(16), byte(8), byte(0)};
    });
    return table;
}

/// Colours spaced evenly between `anchors`, blended linearly.
template <std::size_t N>
Table blended_table(const std::array<Colour, N>& anchors) {
    Table table;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double position = static_cast<double>(i) / 255.0 * static_cast<double>(N - 1);
        const std::size_t low = std::min(static_cast<std::size_t>(position), N - 2);
        const double weight = position - static_cast<double>(low);
        const auto blend = [&](std::uint8_t a, std::uint8_t b) {
            return static_cast<std::uint8_t>(std::lround((1.0 - weight) * a + weight * b));
        };
        const Colour& a = anchors[low];
        const Colour& b = anchors[low + 1];
        table[i] = {blend(a.red, b.red), blend(a.green, b.green), blend(a.blue, b.blue)};
    }
    return table;
}

/// Blue to white to red; the anchors are the nine-class RdBu scheme of [Harrower2003], reversed.
Table diverging_table() {
    return blended_table<9>({{{33, 102, 172},
                              {67, 147, 195},
                              {146, 197, 222},
                              {209, 229, 240},
                              {255, 255, 255},
                              {253, 219, 199},
                              {244, 165, 130},
                              {214, 96, 77},
                              {178, 24, 43}}});
}

Table grey_table() {
    return blended_table<2>({{{0, 0, 0}, {255, 255, 255}}});
}

}  // namespace

const std::array<Colour, 256>& colours_of(ColourMap map) {
    static const Table inferno = unpacked(kInferno);
    static const Table viridis = unpacked(kViridis);
    static const Table diverging = diverging_table();
    static const Table grey = grey_table();
    switch (map) {
        case ColourMap::Inferno:
            return inferno;
        case ColourMap::Viridis:
            return viridis;
        case ColourMap::Diverging:
            return diverging;
        case ColourMap::Grey:
            return grey;
    }
    return grey;
}

Colour colour_at(ColourMap map, double share) {
    const double level = share > 0.0 ? std::min(share, 1.0) * 255.0 : 0.0;  // NaN is dark
    return colours_of(map)[static_cast<std::size_t>(std::lround(level))];
}

}  // namespace nlos
