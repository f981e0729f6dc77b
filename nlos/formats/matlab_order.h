// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/transient.h"

#include <vector>

namespace nlos {

/// The histograms of rows x columns pairs as MATLAB stores (rows, columns, bins): the row fastest,
/// the bin slowest.
///
/// pair   (row, column) -> pair
template <class T, class Pair>
std::vector<T> to_matlab_order(const core::Transient& transient,
                               std::size_t rows,
                               std::size_t columns,
                               Pair&& pair) {
    std::vector<T> values;
    values.reserve(transient.values().size());
    for (std::size_t bin = 0; bin < transient.num_bins(); ++bin) {
        for (std::size_t column = 0; column < columns; ++column) {
            for (std::size_t row = 0; row < rows; ++row) {
                values.push_back(static_cast<T>(transient.histogram(pair(row, column))[bin]));
            }
        }
    }
    return values;
}

}  // namespace nlos
