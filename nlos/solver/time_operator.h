// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/capture/time_axis.h"

#include <cstddef>
#include <span>
#include <vector>

namespace nlos {

/// From the light that reaches wall points at squared ranges v = (path length / 2)^2 to their
/// histograms: falloff by range^power, bins of v to bins of time, the set-up's response. A banded
/// matrix B, the same for all wall points.
///
/// All functions work on rows of wall points at once: element [i][lane] of an array is the i-th bin
/// of v or of time of point `lane`.
class TimeOperator {
 public:
    /// axis       of path lengths from and to the wall; its bins are the operator's output
    /// v_edges    of the bins of v [m^2], even and ascending
    /// power      of the falloff
    /// response   on bins of the axis's width; no weights: none
    TimeOperator(const core::TimeAxis& axis,
                 std::span<const double> v_edges,
                 double power,
                 const core::ResponseFilter& response);

    std::size_t num_v() const { return num_v_; }
    std::size_t num_bins() const { return rows_.size(); }

    /// Multiplies all of B by a factor.
    void scale(double factor);

    /// time = B v.
    void apply(const float* v, float* time, std::size_t lanes) const;
    /// v = B' time.
    void apply_adjoint(const float* time, float* v, std::size_t lanes) const;

    /// Diagonal of B' diag(weights) B.
    std::vector<double> normal_diagonal(std::span<const double> weights) const;

    /// Prepares solve() for 1 + B' diag(weights) B.
    void factorize(std::span<const double> weights);
    /// Solves (1 + B' diag(weights) B) x = v in place.
    void solve(float* v, std::size_t lanes) const;

 private:
    struct Row {
        std::size_t first = 0;  ///< bin of v of the first weight
        std::vector<float> weights;
    };
    std::size_t num_v_;
    std::vector<Row> rows_;  ///< one per bin of time

    // Cholesky factor L of the matrix of solve(): row i holds L[i][i - band .. i - 1], and the
    // reciprocals of its diagonal.
    std::size_t band_ = 0;
    std::vector<float> factor_;
    std::vector<float> inverse_diagonal_;
};

}  // namespace nlos
