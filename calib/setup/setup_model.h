// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <array>
#include <string>

namespace calib {

/// Parameters of a set-up, in this order.
enum SetupParameter { kDistance, kTiltX, kTiltY, kSpin, kFootX, kFootY, kZero, kGainX, kGainY };
inline constexpr int kNumSetupParameters = 9;
inline const std::array<std::string, kNumSetupParameters> kSetupNames{"wall_distance_m",
                                                                      "wall_tilt_x_rad",
                                                                      "wall_tilt_y_rad",
                                                                      "spin_rad",
                                                                      "foot_x_m",
                                                                      "foot_y_m",
                                                                      "time_zero_m",
                                                                      "galvo_gain_x",
                                                                      "galvo_gain_y"};
using SetupValues = std::array<double, kNumSetupParameters>;

// For numbers or automatic derivatives. The wall is the plane z = 0, its normal +z towards the
// device. Command (u, v) sends the beam along (tan gain_x u, tan gain_y v, -1) in the device's
// frame.

/// Device frame in the wall's: spin about the normal, then tilts about x and y.
template <class T>
Eigen::Matrix<T, 3, 1> rotated(const T* p, const Eigen::Matrix<T, 3, 1>& d) {
    using std::cos;
    using std::sin;
    const T x = cos(p[kSpin]) * d[0] - sin(p[kSpin]) * d[1];
    const T y = sin(p[kSpin]) * d[0] + cos(p[kSpin]) * d[1];
    const T y2 = cos(p[kTiltX]) * y - sin(p[kTiltX]) * d[2];
    const T z = sin(p[kTiltX]) * y + cos(p[kTiltX]) * d[2];
    return {T(cos(p[kTiltY]) * x + sin(p[kTiltY]) * z),
            y2,
            T(-sin(p[kTiltY]) * x + cos(p[kTiltY]) * z)};
}

template <class T>
Eigen::Matrix<T, 3, 1> device_of(const T* p) {
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector forward = rotated<T>(p, Vector(T(0.0), T(0.0), T(-1.0)));
    return Vector(p[kFootX], p[kFootY], T(0.0)) - p[kDistance] * forward;
}

/// Where a command's beam meets the wall, and its length.
template <class T>
Eigen::Matrix<T, 3, 1> spot_of(const T* p, const std::array<double, 2>& command, T& length) {
    using std::tan;
    using Vector = Eigen::Matrix<T, 3, 1>;
    const Vector beam =
        rotated<T>(p, Vector(tan(p[kGainX] * command[0]), tan(p[kGainY] * command[1]), T(-1.0)));
    const Vector device = device_of(p);
    const T fraction = -device[2] / beam[2];
    length = fraction * beam.norm();
    return device + fraction * beam;
}

}  // namespace calib
