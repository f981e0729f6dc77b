// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "nlos/solver/pair_gains.h"

#include <cstddef>
#include <span>
#include <vector>

namespace nlos {

/// Light of voxels at any pairs of wall points, and its exact adjoint: albedo times
/// 1 / (r_l r_s)^2 (diffuse), the same with all cosines, (z_l z_s)^2 / (r_l r_s)^4 (facing), or
/// 1 / (r_l r_s) (retroreflective) and the pair's gain, shared linearly by the two bins whose
/// centres enclose the path length, blurred by the response, and 0 in bins that were not observed.
/// The factors are those of backproject() with compensation, the other way round.
///
/// A spot spreads path lengths, to first order as a Gaussian whose deviation is the spot's times
/// the slope of the path length along the wall; three points of the same moments up to the fifth
/// stand for it. The illuminated and the observed spot are blurred each for itself, the one of a
/// confocal scan only once.
class PairOperator {
 public:
    /// input    any scan; its measurement's response is part of the operator
    /// spot_m   full width at half maximum of the spots [m]
    PairOperator(const MethodInput& input, Falloff falloff, double spot_m);

    void set_gains(const PairGains& gains) { gains_ = gains; }

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
    struct Segments;
    struct SpotPoint {
        float shift_bins;  ///< per unit of the path length's slope along the wall
        float weight;
    };
    void blur(std::span<const float> input, std::span<float> output, bool is_adjoint) const;
    /// What does not depend on the spot's point, for voxels [begin, end).
    void fill_segments(std::size_t pair,
                       std::size_t begin,
                       std::size_t end,
                       Segments& segments) const;
    /// What does.
    void place(const SpotPoint& point, std::size_t count, Segments& segments) const;

    const core::WallScan& scan_;
    core::TimeAxis axis_;
    std::size_t num_bins_;
    core::ResponseFilter response_;
    Falloff falloff_;
    std::vector<SpotPoint> spot_;
    PairGains gains_;
    std::vector<core::BinRange> observed_;                 ///< per pair
    std::vector<Eigen::Vector3f> illumination_, sensing_;  ///< wall's frame
    std::vector<float> device_segments_bins_;              ///< per pair
    std::vector<float> x_, y_, z_;
};

}  // namespace nlos
