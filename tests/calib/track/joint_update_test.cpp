// SPDX-License-Identifier: MIT
#include "calib/track/joint_update.h"

#include "tests/calib/track/track_example.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using calib::Gaussian;
using calib::SeenMatrix;
using calib::SeenVector;
using core::Vec3;

const auto kAnywhere = [](const Vec3& p) { return p.z() > 0.0; };

// Sees a target so clearly, and knows it so well beforehand, that all is linear.
TEST(JointUpdate, IsKalmansInTheLinearLimit) {
    const auto response = test_support::response_of(test_support::small_sensor());
    SeenVector mean;
    mean << 0.2, 0.1, 0.9, std::log(2000.0);
    SeenMatrix prior = SeenMatrix::Zero();
    prior.diagonal() << 4e-6, 4e-6, 4e-6, 1e-4;
    std::vector<double> unit(response.size(), 0.0);
    std::vector<Vec3> gradient(response.size(), Vec3::Zero());
    response.evaluate(mean.head<3>(), unit, gradient);
    const std::vector<double> background(response.size(), 50.0);
    const std::vector<double> weights(response.size(), 1.0);
    // Expected counts of a target a little beside the prior mean, to first order.
    const SeenVector shift(1e-3, -2e-3, 1.5e-3, 5e-3);
    Eigen::MatrixXd jacobian(static_cast<Eigen::Index>(response.size()), 4);
    Eigen::VectorXd expected(jacobian.rows());
    for (Eigen::Index i = 0; i < jacobian.rows(); ++i) {
        const auto bin = static_cast<std::size_t>(i);
        jacobian.row(i) << 2000.0 * gradient[bin].transpose(), 2000.0 * unit[bin];
        expected[i] = 50.0 + 2000.0 * unit[bin];
    }
    const Eigen::VectorXd innovation = jacobian * shift;
    std::vector<double> counts(response.size());
    for (std::size_t i = 0; i < counts.size(); ++i) {
        counts[i] =
            expected[static_cast<Eigen::Index>(i)] + innovation[static_cast<Eigen::Index>(i)];
    }
    const SeenMatrix posterior =
        (prior.inverse() + jacobian.transpose() * expected.cwiseInverse().asDiagonal() * jacobian)
            .inverse();
    const SeenVector moved =
        posterior * jacobian.transpose() * expected.cwiseInverse().asDiagonal() * innovation;

    const auto update = calib::update_jointly(
        response, {counts, background, weights}, {Gaussian{mean, prior}}, kAnywhere);
    const Eigen::VectorXd found = update.targets[0].mean - mean;
    EXPECT_LT((found - moved).norm(), 0.03 * moved.norm());
    EXPECT_LT((update.targets[0].covariance - posterior).norm(), 0.03 * posterior.norm());
}

// 200 targets drawn from the prior: squared errors over reported covariances follow chi-square,
// whose mean over 200 of 4 degrees of freedom lies between 3.3 and 4.8 but once in a thousand.
TEST(JointUpdate, ReportsItsErrors) {
    const auto response = test_support::response_of(test_support::small_sensor());
    SeenVector mean;
    mean << 0.1, -0.1, 0.8, std::log(200.0);
    SeenMatrix prior = SeenMatrix::Zero();
    prior.diagonal() << 1e-2, 1e-2, 1e-2, 0.04;
    const std::vector<double> background(response.size(), 2.0);
    const std::vector<double> weights(response.size(), 1.0);
    constexpr int kTargets = 200;
    double sum = 0.0;
    double spread = 0.0;
    for (int t = 0; t < kTargets; ++t) {
        core::Rng rng(7, static_cast<std::uint64_t>(t), 0);
        SeenVector truth = mean;
        for (int i = 0; i < 4; ++i) {
            const double normal = std::sqrt(-2.0 * std::log(1.0 - rng.uniform())) *
                                  std::cos(2.0 * core::kPi * rng.uniform());
            truth[i] += std::sqrt(prior(i, i)) * normal;
        }
        const auto counts = test_support::draw_counts(
            response, {truth.head<3>()}, std::exp(truth[3]), 2.0, static_cast<std::uint64_t>(t));
        const auto update = calib::update_jointly(
            response, {counts, background, weights}, {Gaussian{mean, prior}}, kAnywhere);
        const Eigen::VectorXd error = update.targets[0].mean - truth;
        sum += error.dot(update.targets[0].covariance.ldlt().solve(error));
        spread += update.targets[0].covariance(0, 0) / kTargets;
    }
    EXPECT_GT(sum / kTargets, 3.3);
    EXPECT_LT(sum / kTargets, 4.8);
    EXPECT_LT(spread, 0.5 * prior(0, 0));  // the frame says something
}

TEST(JointUpdate, EvidenceTellsATargetFromNone) {
    const auto response = test_support::response_of(test_support::small_sensor());
    SeenVector mean;
    mean << 0.1, -0.1, 0.8, std::log(200.0);
    SeenMatrix prior = SeenMatrix::Zero();
    prior.diagonal() << 1e-2, 1e-2, 1e-2, 0.04;
    const std::vector<double> background(response.size(), 2.0);
    const std::vector<double> weights(response.size(), 1.0);
    const auto evidence = [&](const std::vector<Vec3>& targets) {
        const auto counts = test_support::draw_counts(response, targets, 200.0, 2.0, 3);
        return calib::update_jointly(
                   response, {counts, background, weights}, {Gaussian{mean, prior}}, kAnywhere)
            .log_evidence[0];
    };
    EXPECT_GT(evidence({Vec3(0.1, -0.1, 0.8)}), 20.0);
    EXPECT_LT(evidence({}), -10.0);
}

}  // namespace
