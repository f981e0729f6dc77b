// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <cstddef>
#include <span>
#include <vector>

namespace nlos {

/// Light of voxels at any pairs of wall points, and its exact adjoint: albedo times
/// 1 / (r_l r_s)^2 (diffuse) or 1 / (r_l r_s) (retroreflective), shared linearly by the two bins
/// whose centres enclose the path length, blurred by the response, and 0 in bins that were not
/// observed. The factors are those of backproject() with compensation, the other way round.
class PairOperator {
 public:
    /// input   any scan; its measurement's response is part of the operator
    PairOperator(const MethodInput& input, Falloff falloff);

    /// Chooses the voxels that albedo and its like are about [m, wall's frame].
    void set_voxels(std::vector<Eigen::Vector3f> positions);

    std::size_t num_voxels() const { return x_.size(); }
    std::size_t num_bins() const { return num_bins_; }
    const std::vector<core::BinRange>& observed() const { return observed_; }

    /// Histograms (pairs.size(), num_bins) of the pairs named.
    void forward(std::span<const float> albedo,
                 std::span<const std::size_t> pairs,
                 std::span<float> histograms) const;

    /// For each voxel the sum of what it adds to the pairs named, times histograms
    /// (pairs.size(), num_bins).
    void adjoint(std::span<const float> histograms,
                 std::span<const std::size_t> pairs,
                 std::span<float> albedo) const;

 private:
    struct Legs;
    void blur(std::span<const float> input, std::span<float> output, bool is_adjoint) const;
    void fill_legs(std::size_t pair, std::size_t begin, std::size_t end, Legs& legs) const;

    const core::Scan& scan_;
    core::TimeAxis axis_;
    std::size_t num_bins_;
    core::ResponseFilter response_;
    bool is_retro_;
    std::vector<core::BinRange> observed_;                 ///< per pair
    std::vector<Eigen::Vector3f> illumination_, sensing_;  ///< wall's frame
    std::vector<float> device_legs_bins_;                  ///< per pair
    std::vector<float> x_, y_, z_;
};

}  // namespace nlos
