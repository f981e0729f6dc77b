// SPDX-License-Identifier: MIT
#include "nlos/preparation/conservative_resampling.h"

#include <algorithm>

namespace nlos {

ConservativeResampling::ConservativeResampling(std::span<const double> from_edges,
                                               std::span<const double> to_edges,
                                               std::span<const double> from_scale) {
    const std::size_t num_inputs = from_edges.size() - 1;
    rows_.resize(to_edges.size() - 1);
    weights_.reserve(num_inputs + rows_.size());
    std::size_t first = 0;
    for (std::size_t row = 0; row < rows_.size(); ++row) {
        const double begin = to_edges[row];
        const double end = to_edges[row + 1];
        while (first < num_inputs && from_edges[first + 1] <= begin) ++first;
        rows_[row].first_input = first;
        rows_[row].first_weight = weights_.size();
        for (std::size_t i = first; i < num_inputs && from_edges[i] < end; ++i) {
            const double overlap =
                std::min(end, from_edges[i + 1]) - std::max(begin, from_edges[i]);
            const double width = from_edges[i + 1] - from_edges[i];
            weights_.push_back(
                width > 0.0 ? static_cast<float>(from_scale[i] * std::max(0.0, overlap) / width)
                            : 0.0F);
            ++rows_[row].count;
        }
    }
}

std::vector<double> even_edges(double begin, double end, std::size_t count) {
    std::vector<double> edges(count + 1);
    for (std::size_t i = 0; i <= count; ++i) {
        edges[i] = begin + (end - begin) * static_cast<double>(i) / static_cast<double>(count);
    }
    return edges;
}

}  // namespace nlos
