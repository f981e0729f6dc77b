// SPDX-License-Identifier: MIT
#include "nlos/canvas/raster.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace nlos {
namespace {

/// What a cell of the new axis takes from consecutive cells of the old one; weights sum to 1.
struct CellWeights {
    int first = 0;
    std::vector<double> weights;

    bool operator==(const CellWeights&) const = default;
};

std::vector<CellWeights> axis_weights(int from, int to) {
    std::vector<CellWeights> result(static_cast<std::size_t>(to));
    const double step = static_cast<double>(from) / to;
    for (int i = 0; i < to; ++i) {
        CellWeights& cells = result[static_cast<std::size_t>(i)];
        if (from <= to) {
            cells = {std::min(from - 1, static_cast<int>((i + 0.5) * step)), {1.0}};
            continue;
        }
        const double begin = i * step;
        const double end = (i + 1) * step;
        cells.first = static_cast<int>(begin);
        for (int cell = cells.first; cell < std::min(from, static_cast<int>(std::ceil(end)));
             ++cell) {
            const double overlap = std::min(end, cell + 1.0) - std::max(begin, double(cell));
            cells.weights.push_back(overlap / step);
        }
    }
    return result;
}

Colour mean_colour(const Raster& raster, const CellWeights& across, const CellWeights& down) {
    double red = 0.5;  // for rounding
    double green = 0.5;
    double blue = 0.5;
    for (std::size_t j = 0; j < down.weights.size(); ++j) {
        for (std::size_t i = 0; i < across.weights.size(); ++i) {
            const Colour& colour =
                raster.at(across.first + static_cast<int>(i), down.first + static_cast<int>(j));
            const double weight = across.weights[i] * down.weights[j];
            red += weight * colour.red;
            green += weight * colour.green;
            blue += weight * colour.blue;
        }
    }
    const auto byte = [](double value) {
        return static_cast<std::uint8_t>(std::min(value, 255.0));
    };
    return {byte(red), byte(green), byte(blue)};
}

}  // namespace

Raster resized(const Raster& raster, int columns, int rows) {
    assert(raster.colours.size() ==
           static_cast<std::size_t>(raster.columns) * static_cast<std::size_t>(raster.rows));
    const std::vector<CellWeights> across = axis_weights(raster.columns, columns);
    const std::vector<CellWeights> down = axis_weights(raster.rows, rows);
    Raster result{columns, rows, std::vector<Colour>(across.size() * down.size())};
    auto next = result.colours.begin();
    for (std::size_t y = 0; y < down.size(); ++y) {
        if (y > 0 && down[y] == down[y - 1]) {  // most rows of an enlarged image
            next = std::copy(next - columns, next, next);
            continue;
        }
        for (const CellWeights& column : across) *next++ = mean_colour(raster, column, down[y]);
    }
    return result;
}

}  // namespace nlos
