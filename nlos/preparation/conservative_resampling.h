// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace nlos {

/// How the content of a bin lies along the axis.
enum class BinSpread {
    Even,   ///< evenly over the bin
    Linear  ///< densest in its middle and falling to nothing at those of its neighbours, so that
            ///< the density of even bins is linear between their middles
};

/// Moves the contents of histogram bins to other bins, each share by overlap, so that the total is
/// kept where the new bins cover the old ones. A sparse matrix, built directly.
class ConservativeResampling {
 public:
    /// from_edges   ascending, one more than there are input bins
    /// to_edges     ascending, one more than there are output bins, in the same coordinate
    /// from_scale   factor for each input bin
    ConservativeResampling(std::span<const double> from_edges,
                           std::span<const double> to_edges,
                           std::span<const double> from_scale,
                           BinSpread spread = BinSpread::Even);

    std::size_t num_outputs() const { return rows_.size(); }

    /// Computes all output bins.
    void apply(const float* input, float* output) const {
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            const Row& r = rows_[row];
            float sum = 0.0F;
            for (std::size_t i = 0; i < r.count; ++i) {
                sum += weights_[r.first_weight + i] * input[r.first_input + i];
            }
            output[row] = sum;
        }
    }

 private:
    struct Row {
        std::size_t first_input = 0;
        std::size_t first_weight = 0;
        std::size_t count = 0;
    };
    std::vector<Row> rows_;
    std::vector<float> weights_;
};

/// `count + 1` evenly spaced edges of `count` bins over [begin, end].
std::vector<double> even_edges(double begin, double end, std::size_t count);

}  // namespace nlos
