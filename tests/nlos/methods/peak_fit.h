// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/volume.h"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>

namespace nlos_test {

/// Where a volume peaks, between voxels, in the wall's frame: the vertex of the quadratic that fits
/// the logarithms of the 27 voxels around the brightest, which must not lie on a face. Weights are
/// squared values, those of equal errors of the values themselves.
inline core::Vec3 fitted_peak(const nlos::Volume& volume) {
    const std::size_t ny = volume.axes.y_m.size();
    const std::size_t nz = volume.axes.z_m.size();
    const auto brightest = static_cast<std::size_t>(
        std::max_element(volume.values.begin(), volume.values.end()) - volume.values.begin());
    const std::size_t ix = brightest / (ny * nz);
    const std::size_t iy = brightest / nz % ny;
    const std::size_t iz = brightest % nz;
    Eigen::Matrix<double, 27, 10> terms;
    Eigen::Matrix<double, 27, 1> logs;
    for (int n = 0; n < 27; ++n) {
        const int x = n / 9 - 1;
        const int y = n / 3 % 3 - 1;
        const int z = n % 3 - 1;
        const auto at = [](std::size_t i, int step) {
            return static_cast<std::size_t>(static_cast<int>(i) + step);
        };
        const double value =
            static_cast<double>(volume.values[volume.index(at(ix, x), at(iy, y), at(iz, z))] /
                                volume.values[brightest]);
        const double weight = value > 0.0 ? value * value + 1e-9 : 1e-9;
        terms.row(n) << 1, x, y, z, 0.5 * x * x, 0.5 * y * y, 0.5 * z * z, x * y, x * z, y * z;
        terms.row(n) *= weight;
        logs[n] = weight * std::log(std::max(value, 1e-3));
    }
    const Eigen::Matrix<double, 10, 1> c = terms.colPivHouseholderQr().solve(logs);
    core::Mat3 curvature;
    curvature << c[4], c[7], c[8], c[7], c[5], c[9], c[8], c[9], c[6];
    const core::Vec3 gradient(c[1], c[2], c[3]);
    const core::Vec3 vertex = (-curvature.inverse() * gradient).cwiseMax(-1.0).cwiseMin(1.0);
    const auto& axes = volume.axes;
    return {axes.x_m[ix] + vertex.x() * (axes.x_m[1] - axes.x_m[0]),
            axes.y_m[iy] + vertex.y() * (axes.y_m[1] - axes.y_m[0]),
            axes.z_m[iz] + vertex.z() * (axes.z_m[1] - axes.z_m[0])};
}

}  // namespace nlos_test
