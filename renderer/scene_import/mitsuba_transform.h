// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"
#include "renderer/core/types.h"

#include <array>
#include <string>
#include <vector>

namespace renderer {

// The steps of Mitsuba's transforms, as 4 x 4 matrices that act on columns.
Eigen::Matrix4d translation(const std::array<double, 3>& offset);
Eigen::Matrix4d scaling(const std::array<double, 3>& factors);
/// Right-handed, in degrees; the identity about an axis of length 0.
Eigen::Matrix4d rotation(const std::array<double, 3>& axis, double degrees);
/// +z looks from the origin to the target, y leans towards `up`.
Eigen::Matrix4d look_at(const core::Vec3& origin, const core::Vec3& target, const core::Vec3& up);

/// A matrix from its 16 numbers, or the 9 of a linear map, by rows.
/// throws   core::Error naming `where` for another count
Eigen::Matrix4d matrix_of(const std::vector<double>& values, const std::string& where);

/// Matrices as lists of rows.
core::Json to_json(const Eigen::Matrix4d& matrix);

/// Reads a matrix from lists of rows or one list of 16 numbers; it has to be affine and finite.
/// throws   core::Error naming `where`
core::Transform read_transform(const core::Json& json, const std::string& where);

/// Numbers separated by commas or blanks. Throws std::invalid_argument for anything else.
std::vector<double> numbers_in(const std::string& text);

}  // namespace renderer
