// SPDX-License-Identifier: MIT
#pragma once

#include "calib/forward/path_segments.h"
#include "renderer/geometry/visibility_mask.h"
#include "renderer/triangle/triangle_histogram.h"

#include <algorithm>
#include <array>

namespace calib {

/// How the knots of an element change.
struct KnotDerivative {
    std::array<double, 3> opl;
    std::array<double, 3> weight;
};

/// Gradients by path lengths and weights at the nodes of an element.
struct NodeGradients {
    std::array<double, 6> opl;
    std::array<double, 6> weight;
};

/// Mean of three of six nodes: of the corners (first = 0) or of the midpoints (3).
inline double mean3(const std::array<double, 6>& values, std::size_t first) {
    return (values[first] + values[first + 1] + values[first + 2]) / 3.0;
}

/// renderer::match_midpoints and its derivative: the knots of an element from path lengths and
/// weights at its nodes, corners first, and how they change when these do.
class KnotFit {
 public:
    KnotFit(const std::array<double, 6>& opl, const std::array<double, 6>& weight) {
        renderer::TriangleKnots corners{{opl[0], opl[1], opl[2]},
                                        {weight[0], weight[1], weight[2]}};
        renderer::TriangleKnots middles{{opl[3], opl[4], opl[5]},
                                        {weight[3], weight[4], weight[5]}};
        knots_ = renderer::match_midpoints(corners, middles);
        corners_ = corners.weight;
        mean_ = mean3(weight, 3);
        corner_mean_ = mean3(weight, 0);
        lowest_ = static_cast<std::size_t>(std::min_element(corners_.begin(), corners_.end()) -
                                           corners_.begin());
        is_clamped_ = corners_[lowest_] - corner_mean_ < -mean_;
    }

    const renderer::TriangleKnots& knots() const { return knots_; }

    KnotDerivative change(const std::array<double, 6>& opl,
                          const std::array<double, 6>& weight) const {
        KnotDerivative result;
        const double shift = mean3(opl, 3) - mean3(opl, 0);
        const double mean = mean3(weight, 3);
        const double corner_mean = mean3(weight, 0);
        double spread = 1.0;
        double spread_change = 0.0;
        if (is_clamped_) {
            const double depth = corner_mean_ - corners_[lowest_];
            spread = mean_ / depth;
            spread_change = (mean - spread * (corner_mean - weight[lowest_])) / depth;
        }
        for (std::size_t j = 0; j < 3; ++j) {
            result.opl[j] = opl[j] + shift;
            result.weight[j] = mean + spread * (weight[j] - corner_mean) +
                               spread_change * (corners_[j] - corner_mean_);
        }
        return result;
    }

    /// The transpose of change(): gradients by the nodes from those by the knots.
    NodeGradients pull(const KnotDerivative& by_knots) const {
        double opl_sum = 0.0;
        double weight_sum = 0.0;
        double by_spread = 0.0;  // per change of the spread
        for (std::size_t j = 0; j < 3; ++j) {
            opl_sum += by_knots.opl[j];
            weight_sum += by_knots.weight[j];
            by_spread += by_knots.weight[j] * (corners_[j] - corner_mean_);
        }
        double spread = 1.0;
        double per_depth = 0.0;
        if (is_clamped_) {
            const double depth = corner_mean_ - corners_[lowest_];
            spread = mean_ / depth;
            per_depth = by_spread / depth;
        }
        const double by_mean = weight_sum + per_depth;
        const double by_corner_mean = -spread * by_mean;
        NodeGradients result;
        for (std::size_t j = 0; j < 3; ++j) {
            result.opl[j] = by_knots.opl[j] - opl_sum / 3.0;
            result.opl[3 + j] = opl_sum / 3.0;
            result.weight[j] = spread * by_knots.weight[j] + by_corner_mean / 3.0;
            result.weight[3 + j] = by_mean / 3.0;
        }
        if (is_clamped_) result.weight[lowest_] += spread * per_depth;
        return result;
    }

 private:
    renderer::TriangleKnots knots_;
    std::array<double, 3> corners_{};
    double mean_ = 0.0;
    double corner_mean_ = 0.0;
    std::size_t lowest_ = 0;
    bool is_clamped_ = false;
};

/// Of the paths over the nodes, all longer by `opl_m`, their factors times `factor`.
inline KnotFit fit_knots(const std::array<Path, 6>& paths, double opl_m, double factor) {
    std::array<double, 6> opl{};
    std::array<double, 6> weight{};
    for (std::size_t i = 0; i < 6; ++i) {
        opl[i] = paths[i].opl + opl_m;
        weight[i] = factor * paths[i].factor;
    }
    return {opl, weight};
}

/// The weights of an element's visible part: the product of two linear functions, made linear again
/// with its integral kept, and how it changes with the weights.
///
/// With W, S and P the sums of weights w, fractions s and products w s, the integral of the product
/// is (W S + P)/12 times twice the area, that of linear corner values p is their sum over 6 times
/// it.
class VisibleWeights {
 public:
    VisibleWeights(const std::array<double, 3>& weight, renderer::VisibilityMask mask)
        : is_whole_(mask == renderer::kAllVisible), weight_(weight) {
        if (is_whole_) return;
        fraction_ = renderer::visible_fraction(mask);
        for (std::size_t j = 0; j < 3; ++j) {
            weights_ += weight[j];
            fractions_ += fraction_[j];
            products_ += weight[j] * fraction_[j];
        }
        factor_ = products_ > 0.0 ? 0.25 * (weights_ * fractions_ / products_ + 1.0) : 0.0;
    }

    std::array<double, 3> values() const {
        if (is_whole_) return weight_;
        std::array<double, 3> result{};
        for (std::size_t j = 0; j < 3; ++j) result[j] = factor_ * weight_[j] * fraction_[j];
        return result;
    }

    void convert_change(std::array<double, 3>& change) const {
        if (is_whole_) return;
        if (!(products_ > 0.0)) {
            change = {0.0, 0.0, 0.0};
            return;
        }
        double weights = 0.0;
        double products = 0.0;
        for (std::size_t j = 0; j < 3; ++j) {
            weights += change[j];
            products += change[j] * fraction_[j];
        }
        const double factor =
            0.25 * fractions_ / products_ * (weights - weights_ * products / products_);
        for (std::size_t j = 0; j < 3; ++j) {
            change[j] = fraction_[j] * (factor_ * change[j] + factor * weight_[j]);
        }
    }

 private:
    bool is_whole_;
    std::array<double, 3> weight_;
    std::array<double, 3> fraction_{};
    double weights_ = 0.0;
    double fractions_ = 0.0;
    double products_ = 0.0;
    double factor_ = 0.0;
};

}  // namespace calib
