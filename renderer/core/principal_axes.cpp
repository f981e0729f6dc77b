// SPDX-License-Identifier: MIT
#include "renderer/core/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace core {

PrincipalAxes principal_axes(const std::vector<Vec3>& points_m) {
    PrincipalAxes result;
    if (points_m.empty()) return result;
    const auto count = static_cast<double>(points_m.size());
    for (const Vec3& p : points_m) result.center_m += p / count;
    Mat3 covariance = Mat3::Zero();
    for (const Vec3& p : points_m) {
        covariance += (p - result.center_m) * (p - result.center_m).transpose() / count;
    }
    const Eigen::SelfAdjointEigenSolver<Mat3> eigen(covariance);
    result.axes = eigen.eigenvectors();
    result.spread_m = eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    return result;
}

}  // namespace core
