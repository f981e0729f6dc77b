// SPDX-License-Identifier: MIT
#include "calib/track/target_state.h"

#include <Eigen/Dense>

namespace calib {

TrackBound track_bound(const std::vector<SeenMatrix>& information,
                       const SeenMatrix& first,
                       const Motion& motion,
                       double dt_s) {
    std::vector<Gaussian> predicted;
    std::vector<Gaussian> filtered;
    for (const SeenMatrix& told : information) {
        predicted.push_back(filtered.empty() ? motion.start(SeenVector::Zero(), first)
                                             : motion.predict(filtered.back(), dt_s));
        const SeenMatrix prior = predicted.back().covariance.topLeftCorner<kSeen, kSeen>();
        const SeenMatrix posterior = (prior.inverse() + told).inverse();
        filtered.push_back(
            condition(predicted.back(), predicted.back().mean.head<kSeen>(), posterior));
    }
    TrackBound bound;
    bound.smoothed_m2.resize(filtered.size());
    Eigen::MatrixXd smoothed;
    for (std::size_t i = filtered.size(); i-- > 0;) {
        if (i + 1 == filtered.size()) {
            smoothed = filtered[i].covariance;
        } else {
            const Eigen::MatrixXd& next = predicted[i + 1].covariance;
            const Eigen::MatrixXd gain =
                next.ldlt().solve(motion.transition(dt_s) * filtered[i].covariance).transpose();
            smoothed =
                (filtered[i].covariance + gain * (smoothed - next) * gain.transpose()).eval();
        }
        bound.smoothed_m2[i] = smoothed.topLeftCorner<3, 3>().trace();
    }
    for (const Gaussian& state : filtered) {
        bound.filtered_m2.push_back(state.position_covariance().trace());
    }
    return bound;
}

}  // namespace calib
