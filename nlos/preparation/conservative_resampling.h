// SPDX-License-Identifier: MIT
#pragma once

#include <array>
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

/// Moves the contents of histogram bins to other bins, each fraction by overlap, so that the total
/// is kept where the new bins cover the old ones. A sparse matrix, built directly.
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
    void apply(const float* input, float* output) const { apply_lanes<1>(&input, &output); }

    /// Computes all output bins of several histograms, each as if it were alone.
    void apply(std::span<const float* const> inputs, std::span<float* const> outputs) const {
        std::size_t i = 0;
        for (; i + kLanes <= inputs.size(); i += kLanes) {
            apply_lanes<kLanes>(inputs.data() + i, outputs.data() + i);
        }
        for (; i < inputs.size(); ++i) apply_lanes<1>(inputs.data() + i, outputs.data() + i);
    }

 private:
    /// Histograms at once: rows have few inputs, whose number is hard to foresee.
    static constexpr std::size_t kLanes = 8;

    struct Row {
        std::size_t first_input = 0;
        std::size_t first_weight = 0;
        std::size_t count = 0;
    };

    template <std::size_t kCount>
    void apply_lanes(const float* const* inputs, float* const* outputs) const {
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            const Row& r = rows_[row];
            std::array<float, kCount> sums{};
            for (std::size_t i = 0; i < r.count; ++i) {
                const float weight = weights_[r.first_weight + i];
                for (std::size_t lane = 0; lane < kCount; ++lane) {
                    sums[lane] += weight * inputs[lane][r.first_input + i];
                }
            }
            for (std::size_t lane = 0; lane < kCount; ++lane) outputs[lane][row] = sums[lane];
        }
    }

    std::vector<Row> rows_;
    std::vector<float> weights_;
};

/// `count + 1` evenly spaced edges of `count` bins over [begin, end].
std::vector<double> even_edges(double begin, double end, std::size_t count);

}  // namespace nlos
