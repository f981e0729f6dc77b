// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/histogram_sample.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace nlos {

/// Where the light of a sample's histograms went, as a hypothesis has it.
struct PathGeometry {
    std::vector<core::Vec3> illumination;  ///< point of each pair, in the wall's frame [m]
    std::vector<core::Vec3> sensing;       ///< the same
    std::vector<double> segments_m;        ///< length of the device segments in each pair's axis
    double opl_start_m = 0.0;              ///< of the sample's bin 0
    double bin_width_m = 0.0;              ///< of the sample; negative: time runs backwards
};

/// Cells of the space before the wall, in polar coordinates around the middle of its points.
struct ScatterCells {
    /// Range [m] and the first two components of the direction, in the wall's frame.
    using Cell = Eigen::Vector3d;

    std::vector<Cell> centers;
    std::vector<Cell> sizes;
    std::vector<double> light;  ///< of each; empty: not fitted yet
    std::vector<float> reach;   ///< what each sends to the sample for unit light
};

/// Cells of all directions between two ranges.
ScatterCells coarse_cells(double low_m, double high_m);

/// The eighths of the heaviest cells; the others stay whole, but for those that together send
/// hardly any light to the sample.
ScatterCells refined_cells(const ScatterCells& cells);

/// Sums over all bins that cells reach.
struct CellReach {
    std::vector<float> plain;
    std::vector<float> rated;  ///< every bin times a ratio
};

/// Every `step`-th pair of a sample, from `first` on.
struct PairSubset {
    std::size_t first = 0;
    std::size_t step = 1;
};

/// How light of cells reaches the bins of a sample: a weight and a position between two bins for
/// each pair and each cell that it sees within them. Light falls with the squares of both segments
/// and with the cosines at the wall.
class ScatterTransport {
 public:
    ScatterTransport(const HistogramSample& sample,
                     const PathGeometry& geometry,
                     const ScatterCells& cells);

    /// What each cell sends to observed bins of all pairs for unit light.
    const std::vector<float>& reach() const { return reach_; }

    /// Histograms of the cells' light, [pair][bin]; 0 in bins that were not observed, and for pairs
    /// outside the subset.
    std::vector<float> forward(const std::vector<double>& light, const PairSubset& subset) const;

    /// What each cell sends to observed bins for unit light, each pair times its gain, and the same
    /// with every bin times `ratio` [pair][bin].
    CellReach backward(const std::vector<float>& ratio,
                       const std::vector<double>& gain,
                       const PairSubset& subset) const;

 private:
    /// Light of a cell that reaches the sample's bins.
    struct Arrival {
        std::uint32_t cell;
        float position;  ///< the bin, and the fraction of the light that falls into the next one
        float weight;

        int bin() const { return static_cast<int>(position); }
    };

    /// Fills the arrivals of a pair and adds what they bring to `reach`.
    void fill(std::size_t pair,
              const PathGeometry& geometry,
              const Eigen::ArrayX3f& positions,
              Eigen::ArrayXf& reach);

    void add_reach(std::size_t pair,
                   const Eigen::ArrayXf& bin_positions,
                   const Eigen::ArrayXf& weights,
                   Eigen::ArrayXf& reach) const;

    std::size_t num_pairs_;
    std::size_t num_bins_;
    std::size_t num_cells_;
    double unit_m_;                               ///< of lengths in single precision
    std::vector<float> observed_;                 ///< [pair][bin], 1 or 0
    std::vector<std::vector<Arrival>> arrivals_;  ///< of each pair, in the order of the cells
    std::vector<std::vector<std::size_t>> block_starts_;  ///< [pair][block of cells], in arrivals_
    std::vector<float> reach_;
};

}  // namespace nlos
