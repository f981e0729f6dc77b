// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene_import/foreign_file.h"

#include <fmt/core.h>

#include <charconv>
#include <stdexcept>

namespace renderer {

using core::Vec3;

Eigen::Matrix4d translation(const std::array<double, 3>& offset) {
    return core::Transform(Eigen::Translation3d(offset[0], offset[1], offset[2])).matrix();
}

Eigen::Matrix4d scaling(const std::array<double, 3>& factors) {
    return Eigen::Vector4d(factors[0], factors[1], factors[2], 1.0).asDiagonal();
}

Eigen::Matrix4d rotation(const std::array<double, 3>& axis, double degrees) {
    const Vec3 direction(axis[0], axis[1], axis[2]);
    if (!(direction.norm() > 0.0)) return Eigen::Matrix4d::Identity();
    const Eigen::AngleAxisd turn(degrees / core::kDegreesPerRadian, direction.normalized());
    return core::Transform(turn).matrix();
}

Eigen::Matrix4d look_at(const Vec3& origin, const Vec3& target, const Vec3& up) {
    core::Transform transform = core::Transform::Identity();
    const Vec3 z = (target - origin).normalized();
    const Vec3 x = up.cross(z).normalized();
    transform.linear().col(0) = x;
    transform.linear().col(1) = z.cross(x);
    transform.linear().col(2) = z;
    transform.translation() = origin;
    return transform.matrix();
}

Eigen::Matrix4d matrix_of(const std::vector<double>& values, const std::string& where) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    if (values.size() == 16) {
        matrix = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
    } else if (values.size() == 9) {
        matrix.topLeftCorner<3, 3>() =
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
    } else {
        throw core::Error(where,
                          fmt::format("found a matrix of {} numbers", values.size()),
                          "must have 16, or 9 for a linear map");
    }
    return matrix;
}

core::Json to_json(const Eigen::Matrix4d& matrix) {
    core::Json rows = core::Json::array();
    for (int row = 0; row < 4; ++row) {
        rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
    }
    return rows;
}

core::Transform read_transform(const core::Json& json, const std::string& where) {
    std::vector<double> values;
    if (json.is_array() && !json.empty() && json[0].is_array()) {
        for (const core::Json& row : json) {
            std::vector<double> numbers;
            core::read_value(row, where, numbers);
            values.insert(values.end(), numbers.begin(), numbers.end());
        }
    } else {
        core::read_value(json, where, values);
    }
    core::Transform transform = core::Transform::Identity();
    transform.matrix() = matrix_of(values, where);
    if (!transform.matrix().allFinite() ||
        transform.matrix().row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
        throw core::Error(where, "is not affine", "must be finite, with a last row of 0 0 0 1");
    }
    return transform;
}

std::vector<double> numbers_in(const std::string& text) {
    std::vector<double> values;
    const char* at = text.data();
    const char* const end = at + text.size();
    while (at != end) {
        if (*at == ',' || *at == ' ' || *at == '\t' || *at == '\n' || *at == '\r') {
            ++at;
            continue;
        }
        if (*at == '+') ++at;
        double value = 0.0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc()) throw std::invalid_argument(text);
        values.push_back(value);
        at = next;
    }
    if (values.empty()) throw std::invalid_argument(text);
    return values;
}

}  // namespace renderer
