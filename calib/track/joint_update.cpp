// SPDX-License-Identifier: MIT
#include "calib/track/joint_update.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxSteps = 10;
constexpr int kMaxHalvings = 8;
constexpr double kSmallStep = 1e-6;  // squared, in standard deviations
constexpr double kLongestMove_m = 0.3;
constexpr double kLargestStrengthStep = 1.5;

// Of one target at one state.
struct Contribution {
    std::vector<double> unit;  // of strength 1
    std::vector<Vec3> gradient;
    std::vector<TargetResponse::Window> windows;
    double strength = 0.0;
};

class Problem {
 public:
    Problem(const TargetResponse& response,
            const FrameCounts& frame,
            const std::vector<Gaussian>& priors)
        : response_(response), frame_(frame), targets_(priors.size()) {
        for (const Gaussian& prior : priors) {
            prior_means_.push_back(prior.mean.head<kSeen>());
            const SeenMatrix covariance = prior.covariance.topLeftCorner<kSeen, kSeen>();
            prior_information_.push_back(covariance.inverse());
            prior_log_det_.push_back(std::log(covariance.determinant()));
        }
        for (Contribution& target : targets_) {
            target.unit.resize(response.size());
            target.gradient.resize(response.size());
        }
        signal_.resize(response.size());
    }

    VectorXd start() const {
        VectorXd state(size());
        for (std::size_t t = 0; t < targets_.size(); ++t)
            state.segment<kSeen>(at(t)) = prior_means_[t];
        return state;
    }
    Eigen::Index size() const { return kSeen * static_cast<Eigen::Index>(targets_.size()); }
    static Eigen::Index at(std::size_t target) { return kSeen * static_cast<Eigen::Index>(target); }

    // Logarithm of the posterior density up to a constant.
    double evaluate(const VectorXd& state) {
        std::fill(signal_.begin(), signal_.end(), 0.0);
        for (std::size_t t = 0; t < targets_.size(); ++t) {
            Contribution& target = targets_[t];
            std::fill(target.unit.begin(), target.unit.end(), 0.0);
            std::fill(target.gradient.begin(), target.gradient.end(), Vec3::Zero());
            target.windows =
                response_.evaluate(state.segment<3>(at(t)), target.unit, target.gradient);
            target.strength = std::exp(state[at(t) + kSeen - 1]);
            for_bins_of(target,
                        [&](std::size_t i) { signal_[i] += target.strength * target.unit[i]; });
        }
        log_likelihood_ = gain_over_background();
        double value = log_likelihood_;
        for (std::size_t t = 0; t < targets_.size(); ++t) value -= prior_misfit(state, t);
        return value;
    }

    // At the state of the last evaluate().
    void linearise(const VectorXd& state, MatrixXd& information, VectorXd& slope) const {
        information = MatrixXd::Zero(size(), size());
        slope = VectorXd::Zero(size());
        for (std::size_t t = 0; t < targets_.size(); ++t) {
            information.block<kSeen, kSeen>(at(t), at(t)) = prior_information_[t];
            slope.segment<kSeen>(at(t)) =
                -prior_information_[t] * (state.segment<kSeen>(at(t)) - prior_means_[t]);
        }
        VectorXd row = VectorXd::Zero(size());
        for (std::size_t i = 0; i < signal_.size(); ++i) {
            if (signal_[i] <= 0.0 || frame_.weights[i] == 0.0) continue;
            const double expected = frame_.background[i] + signal_[i];
            for (std::size_t t = 0; t < targets_.size(); ++t) {
                const Contribution& target = targets_[t];
                row.segment<3>(at(t)) = target.strength * target.gradient[i];
                row[at(t) + kSeen - 1] = target.strength * target.unit[i];
            }
            const double weight = frame_.weights[i] / expected;
            information.noalias() += weight * row * row.transpose();
            slope += (weight * (frame_.counts[i] - expected)) * row;
        }
    }

    double log_likelihood() const { return log_likelihood_; }
    const std::vector<double>& signal() const { return signal_; }

    // See JointUpdate::log_evidence.
    double log_evidence(const VectorXd& state, const MatrixXd& information, std::size_t t) const {
        const Contribution& target = targets_[t];
        double gain = 0.0;
        for_bins_of(target, [&](std::size_t i) {
            const double with = frame_.background[i] + signal_[i];
            const double mine = target.strength * target.unit[i];
            const double without = std::max(with - mine, frame_.background[i]);
            gain += frame_.weights[i] * (frame_.counts[i] * std::log(with / without) - mine);
        });
        const SeenMatrix own = information.block<kSeen, kSeen>(at(t), at(t));
        return gain - prior_misfit(state, t) - 0.5 * prior_log_det_[t] -
               0.5 * std::log(own.determinant());
    }

 private:
    template <class Body>
    void for_bins_of(const Contribution& target, const Body& body) const {
        const std::size_t bins = response_.num_bins();
        for (std::size_t z = 0; z < target.windows.size(); ++z) {
            for (int b = target.windows[z].begin; b < target.windows[z].end; ++b) {
                const std::size_t i = z * bins + static_cast<std::size_t>(b);
                if (frame_.weights[i] > 0.0) body(i);
            }
        }
    }

    double gain_over_background() const {
        double gain = 0.0;
        for (std::size_t i = 0; i < signal_.size(); ++i) {
            if (signal_[i] <= 0.0) continue;
            gain += frame_.weights[i] *
                    (frame_.counts[i] * std::log1p(signal_[i] / frame_.background[i]) - signal_[i]);
        }
        return gain;
    }

    double prior_misfit(const VectorXd& state, std::size_t t) const {
        const SeenVector d = state.segment<kSeen>(at(t)) - prior_means_[t];
        return 0.5 * d.dot(prior_information_[t] * d);
    }

    const TargetResponse& response_;
    const FrameCounts& frame_;
    std::vector<Contribution> targets_;
    std::vector<SeenVector> prior_means_;
    std::vector<SeenMatrix> prior_information_;
    std::vector<double> prior_log_det_;
    std::vector<double> signal_;
    double log_likelihood_ = 0.0;
};

// Shortened so that the linearisation still says something at its end.
VectorXd bounded(VectorXd step) {
    double scale = 1.0;
    for (Eigen::Index t = 0; t < step.size(); t += kSeen) {
        const double move = step.segment<3>(t).norm();
        if (move > kLongestMove_m) scale = std::min(scale, kLongestMove_m / move);
        const double strength = std::abs(step[t + kSeen - 1]);
        if (strength > kLargestStrengthStep)
            scale = std::min(scale, kLargestStrengthStep / strength);
    }
    return scale * step;
}

bool all_hidden(const VectorXd& state, const std::function<bool(const Vec3&)>& hidden) {
    for (Eigen::Index t = 0; t < state.size(); t += kSeen) {
        if (!hidden(state.segment<3>(t))) return false;
    }
    return true;
}

}  // namespace

JointUpdate update_jointly(const TargetResponse& response,
                           const FrameCounts& frame,
                           const std::vector<Gaussian>& priors,
                           const std::function<bool(const Vec3&)>& hidden) {
    Problem problem(response, frame, priors);
    VectorXd state = problem.start();
    double value = problem.evaluate(state);
    MatrixXd information;
    VectorXd slope;
    problem.linearise(state, information, slope);
    for (int i = 0; i < kMaxSteps; ++i) {
        VectorXd step = bounded(information.ldlt().solve(slope));
        const double length = step.dot(information * step);
        bool improved = false;
        for (int halving = 0; halving < kMaxHalvings && !improved; ++halving) {
            const VectorXd next = state + step;
            if (all_hidden(next, hidden)) {
                const double found = problem.evaluate(next);
                if (found >= value) {
                    improved = true;
                    state = next;
                    value = found;
                }
            }
            step *= 0.5;
        }
        if (!improved) problem.evaluate(state);
        problem.linearise(state, information, slope);
        if (!improved || length < kSmallStep) break;
    }
    JointUpdate result;
    const MatrixXd covariance =
        information.ldlt().solve(MatrixXd::Identity(problem.size(), problem.size()));
    for (std::size_t t = 0; t < priors.size(); ++t) {
        const Eigen::Index at = Problem::at(t);
        result.targets.push_back(
            condition(priors[t], state.segment<kSeen>(at), covariance.block<kSeen, kSeen>(at, at)));
        result.log_evidence.push_back(problem.log_evidence(state, information, t));
    }
    result.log_likelihood = problem.log_likelihood();
    result.signal = problem.signal();
    return result;
}

}  // namespace calib
