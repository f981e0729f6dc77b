// SPDX-License-Identifier: MIT
#include "calib/model/state_vector.h"

#include <span>
#include <type_traits>

namespace calib {
namespace {

// The numbers of a block, which lie side by side in the state; a rotation has none of this kind.
template <class State>
auto numbers_of(State& state, const ParameterBlock& block) {
    using Number = std::conditional_t<std::is_const_v<State>, const double, double>;
    const auto one = [](Number& number) { return std::span<Number>(&number, 1); };
    switch (block.kind) {
        case ParameterKind::Translation:
            return std::span<Number>(state.bodies[block.item].position_m.data(), 3);
        case ParameterKind::Size:
            return one(state.bodies[block.item].log_size);
        case ParameterKind::Albedo:
            return one(state.bodies[block.item].log_albedo);
        case ParameterKind::Heights:
            return std::span<Number>(state.bodies[block.item].heights_m);
        case ParameterKind::PointPosition:
            return std::span<Number>(state.points[block.item].position_m.data(), 3);
        case ParameterKind::PointAlbedo:
            return one(state.points[block.item].log_albedo);
        case ParameterKind::TimeZero:
            return one(state.time_zero_m);
        case ParameterKind::Ambient:
            return one(state.log_ambient);
        case ParameterKind::ResponseWidth:
            return one(state.log_width);
        case ParameterKind::WallBow:
            return one(state.bow_m);
        case ParameterKind::WallScale:
            return one(state.log_wall_scale);
        case ParameterKind::Scale:
            return one(state.log_scale);
        case ParameterKind::Rotation:
            break;
    }
    return std::span<Number>();
}

}  // namespace

StateVector::StateVector(const SceneModel& model, const SceneState& state)
    : model_(model), state_(state) {
    quaternions_wxyz_.reserve(model.blocks().size());  // blocks_ points into it
    for (const ParameterBlock& block : model.blocks()) {
        if (block.kind == ParameterKind::Rotation) {
            const auto& q = state.bodies[block.item].rotation;
            quaternions_wxyz_.emplace_back(q.w(), q.x(), q.y(), q.z());
            blocks_.push_back(quaternions_wxyz_.back().data());
        } else {
            blocks_.push_back(numbers_of(state_, block).data());
        }
    }
}

SceneState StateVector::state() const {
    SceneState state = state_;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const ParameterBlock& block = model_.blocks()[b];
        if (block.kind != ParameterKind::Rotation) continue;
        const double* wxyz = blocks_[b];
        state.bodies[block.item].rotation =
            Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized();
    }
    return state;
}

std::vector<double> StateVector::numbers() const {
    std::vector<double> numbers;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        numbers.insert(numbers.end(), blocks_[b], blocks_[b] + ambient_size(model_.blocks()[b]));
    }
    return numbers;
}

int StateVector::ambient_size(const ParameterBlock& block) {
    return block.kind == ParameterKind::Rotation ? 4 : block.columns;
}

// A turn w before q gives dq = (0, w/2) q, hence w = 2 vec(dq q*).
Eigen::Matrix<double, 3, 4> StateVector::turn_by_quaternion(const double* wxyz) {
    const core::Vec3 v(wxyz[1], wxyz[2], wxyz[3]);
    core::Mat3 cross;
    cross << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    Eigen::Matrix<double, 3, 4> result;
    result.col(0) = -2.0 * v;
    result.rightCols<3>() = 2.0 * (wxyz[0] * core::Mat3::Identity() + cross);
    return result;
}

SceneState moved_by(const SceneModel& model, const SceneState& state, const Eigen::VectorXd& step) {
    SceneState moved = state;
    for (const ParameterBlock& block : model.blocks()) {
        const auto part = step.segment(block.first_column, block.columns);
        if (block.kind == ParameterKind::Rotation) {
            const core::Vec3 turn = part;
            const double angle = turn.norm();
            if (angle == 0.0) continue;
            auto& rotation = moved.bodies[block.item].rotation;
            rotation = (Eigen::AngleAxisd(angle, turn / angle) * rotation).normalized();
        } else {
            Eigen::Index i = 0;
            for (double& number : numbers_of(moved, block)) number += part[i++];
        }
    }
    return moved;
}

Eigen::VectorXd difference(const SceneModel& model, const SceneState& from, const SceneState& to) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(model.num_columns());
    for (const ParameterBlock& block : model.blocks()) {
        auto part = step.segment(block.first_column, block.columns);
        if (block.kind == ParameterKind::Rotation) {
            Eigen::Quaterniond turn =
                to.bodies[block.item].rotation * from.bodies[block.item].rotation.conjugate();
            if (turn.w() < 0.0) turn.coeffs() *= -1.0;
            const Eigen::AngleAxisd angle_axis(turn);
            part = angle_axis.angle() * angle_axis.axis();
        } else {
            const auto before = numbers_of(from, block);
            const auto after = numbers_of(to, block);
            for (std::size_t i = 0; i < after.size(); ++i) {
                part[static_cast<Eigen::Index>(i)] = after[i] - before[i];
            }
        }
    }
    return step;
}

}  // namespace calib
