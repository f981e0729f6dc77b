// SPDX-License-Identifier: MIT
#include "calib/track/tracker.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <vector>

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Measurements of the seen part of a state: the smoothed means are those of the joint normal
// distribution of all states, solved at once.
TEST(Smoother, AgreesWithTheJointDistributionOfAllStates) {
    calib::TrackSettings settings;
    const calib::Motion motion(settings.motion);
    constexpr double kDt_s = 0.2;
    constexpr int kFrames = 5;
    const calib::SeenMatrix noise = 0.01 * calib::SeenMatrix::Identity();
    const std::vector<double> data{0.0, 0.3, 0.1, 0.6, 0.5};
    const calib::Gaussian start =
        motion.start(calib::SeenVector::Zero(), 4.0 * calib::SeenMatrix::Identity());
    const Eigen::Index n = start.mean.size();
    MatrixXd information = MatrixXd::Zero(kFrames * n, kFrames * n);
    VectorXd weighted = VectorXd::Zero(kFrames * n);
    information.topLeftCorner(n, n) += start.covariance.inverse();

    std::vector<calib::FrameEstimate> frames;
    for (int f = 0; f < kFrames; ++f) {
        calib::TargetEstimate target;
        target.id = 1;
        target.probability = target.predicted_probability = 0.9;
        target.predicted = f == 0 ? start : motion.predict(frames.back().targets[0].state, kDt_s);
        const calib::SeenMatrix prior = target.predicted.covariance.topLeftCorner<4, 4>();
        const calib::SeenMatrix posterior = (prior.inverse() + noise.inverse()).inverse();
        const calib::SeenVector measured =
            calib::SeenVector::Constant(data[static_cast<std::size_t>(f)]);
        const calib::SeenVector seen =
            posterior *
            (prior.inverse() * target.predicted.mean.head<4>() + noise.inverse() * measured);
        target.state = calib::condition(target.predicted, seen, posterior);
        calib::FrameEstimate frame;
        frame.time_s = f * kDt_s;
        frame.dt_s = kDt_s;
        frame.targets.push_back(target);
        frames.push_back(frame);

        information.block(f * n, f * n, 4, 4) += noise.inverse();
        weighted.segment(f * n, 4) += noise.inverse() * measured;
        if (f == 0) continue;
        MatrixXd step(n, 2 * n);
        step << -motion.transition(kDt_s), MatrixXd::Identity(n, n);
        information.block((f - 1) * n, (f - 1) * n, 2 * n, 2 * n) +=
            step.transpose() * motion.noise(kDt_s).inverse() * step;
    }
    const MatrixXd covariance = information.inverse();
    const VectorXd mean = covariance * weighted;
    calib::smooth(frames, settings);
    for (int f = 0; f < kFrames; ++f) {
        const calib::Gaussian& state = frames[static_cast<std::size_t>(f)].targets[0].state;
        EXPECT_LT((state.mean - mean.segment(f * n, n)).norm(), 1e-6) << f;
        EXPECT_LT((state.covariance - covariance.block(f * n, f * n, n, n)).norm(), 1e-6) << f;
    }
}

TEST(Smoother, LaterFramesRaiseTheProbabilityOfEarlierOnes) {
    calib::TrackSettings settings;
    const calib::Motion motion(settings.motion);
    std::vector<calib::FrameEstimate> frames(2);
    for (std::size_t f = 0; f < 2; ++f) {
        calib::TargetEstimate target;
        target.id = 1;
        target.predicted = target.state =
            motion.start(calib::SeenVector::Zero(), calib::SeenMatrix::Identity());
        target.probability = f == 0 ? 0.2 : 0.999;
        target.predicted_probability = 0.2;
        frames[f].dt_s = 0.05;
        frames[f].targets.push_back(target);
    }
    calib::smooth(frames, settings);
    EXPECT_GT(frames[0].targets[0].probability, 0.99);
    EXPECT_TRUE(frames[0].targets[0].is_named);
}

}  // namespace
