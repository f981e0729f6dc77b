// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/solver/cone_convolution.h"
#include "nlos/solver/confocal_problem.h"
#include "nlos/solver/pair_gains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace nlos {

/// The alternating direction method of multipliers that solve_confocal() runs.
class ConfocalAdmm {
 public:
    ConfocalAdmm(const MethodInput& input,
                 const ConfocalProblem& data,
                 const SolverSettings& settings);

    /// at_most   iterations; as set or by default where nothing is given
    /// returns   the number of iterations
    int run(const core::Progress& progress, std::optional<int> at_most = {});

    /// The weight of total variation, as set or by default.
    double weight() const { return tv_factor_ * weight_; }

    /// The albedo that it found, per bin of v.
    const ConeField& albedo() const { return w_; }

    /// Twice how much less likely the observed bins are under the light of all scatterers than
    /// under their own values (the deviance). To be called once it has run.
    double misfit();

    /// Memory that it takes on top of its input [bytes].
    static double bytes(const Cone& cone, bool is_confined);

 private:
    /// Squares that say how far the iterations have come.
    struct Change {
        double step = 0.0, gap = 0.0, norm = 0.0;

        Change& operator+=(const Change& other) {
            step += other.step;
            gap += other.gap;
            norm += other.norm;
            return *this;
        }
        double relative() const { return norm > 0.0 ? std::sqrt(std::max(step, gap) / norm) : 0.0; }
    };

    /// From K f in light_ to the next c, p and r and, in light_, c - p - K f; or from the data
    /// alone to the first of them.
    void split_data(bool is_first);
    /// Calls visit(column, bin, light, value) for the observed bins of a row, with the light of a
    /// gain of 1 that light_ makes of each.
    template <class Visit>
    void visit_light(std::size_t ix, const Visit& visit);
    /// The gains, or the factor of the background, that explain the data best by K f, in light_.
    void update_gains();
    void update_background();
    /// What voxels of w cost by reweighted sparsity, and how total variation weighs beside it.
    void reweight();
    std::size_t column_of(std::size_t i) const {
        return i / (cone_.num_v() * cone_.ny) * cone_.ny + i % cone_.ny;
    }
    float background(std::size_t column) const {
        return background_factor_ * data_.background_per_bin[column];
    }
    /// From B c of one bin to P (h + r) in its place; h + r stays in `r`.
    void explain_bins(std::size_t ix, std::size_t t, bool is_first, float* time, float* r) const;
    /// Updates d, u, w and q from f in right_ and leaves grad'(d - u) + w - q there.
    Change split_field();
    /// d and u of a row of voxels; b_ = d - u. Differences across the volume's faces stay 0.
    void split_gradients(std::size_t ix, std::size_t v);
    /// w and q of a row of voxels, and the next right-hand side.
    Change split_albedo(std::size_t ix, std::size_t v);
    std::size_t at(std::size_t ix, std::size_t v) const {
        return (ix * cone_.num_v() + v) * cone_.ny;
    }

    const ConfocalProblem& data_;
    const Cone& cone_;
    double tolerance_;
    int max_iterations_;
    double weight_;
    TimeOperator time_;
    ConeConvolution convolution_;
    std::size_t num_bins_;
    bool has_gains_;
    PairGains gains_;
    ConeField right_, light_;  ///< f and K f, or what the next of them is computed from
    ConeField c_, p_, q_, w_;
    std::array<ConeField, 3> u_, b_;
    std::vector<float> r_;  ///< [x][bin][y]
    ConeField costs_;       ///< factors of sparsity_; empty: all 1
    bool is_weight_set_;
    double tv_factor_ = 1.0;
    float background_factor_;
    std::vector<float> tv_, sparsity_;  ///< thresholds, per bin of v
};

}  // namespace nlos
