// SPDX-License-Identifier: MIT
#include "calib/track/tracker.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace calib {
namespace {

// What later frames say of a target in an earlier one.
struct Later {
    const TargetEstimate* target;
    double dt_s;
    double predicted_probability;  // as it was before smoothing, as are the means predicted
};

void look_back(TargetEstimate& now, const Later& later, const TrackSettings& settings) {
    const Motion motion(settings.motion);
    const Gaussian& next = later.target->state;
    const Gaussian& predicted = later.target->predicted;
    const Eigen::MatrixXd gain = predicted.covariance.ldlt()
                                     .solve(motion.transition(later.dt_s) * now.state.covariance)
                                     .transpose();
    now.state.mean += gain * (next.mean - predicted.mean);
    now.state.covariance += gain * (next.covariance - predicted.covariance) * gain.transpose();
    now.state.covariance = (0.5 * (now.state.covariance + now.state.covariance.transpose())).eval();
    const double survival = std::exp(-later.dt_s / settings.existence.lifetime_s);
    const double there = survival * later.target->probability / later.predicted_probability;
    const double gone = (1.0 - survival) * (1.0 - later.target->probability) /
                        std::max(1.0 - later.predicted_probability, 1e-300);
    now.probability = std::clamp(now.probability * (there + gone), 0.0, 1.0);
    now.is_named = now.probability >= settings.existence.name_at;
}

}  // namespace

void smooth(std::vector<FrameEstimate>& frames, const TrackSettings& settings) {
    std::map<int, Later> later;
    double dt_s = 0.0;  // to the next frame used
    for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
        if (!frame->is_used) continue;
        std::map<int, Later> here;
        double none = 1.0;
        for (TargetEstimate& target : frame->targets) {
            if (const auto it = later.find(target.id); it != later.end()) {
                look_back(
                    target, {it->second.target, dt_s, it->second.predicted_probability}, settings);
            }
            here[target.id] = {&target, 0.0, target.predicted_probability};
            none *= 1.0 - target.probability;
        }
        if (!frame->is_learning) frame->probability = 1.0 - none;
        later = std::move(here);
        dt_s = frame->dt_s;
    }
}

}  // namespace calib
