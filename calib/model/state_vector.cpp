// SPDX-License-Identifier: MIT
#include "calib/model/state_vector.h"

namespace calib {
namespace {

bool is_turn(const ParameterBlock& block) {
    return block.row->effect == Effect::Rotates;
}

}  // namespace

StateVector::StateVector(const SceneModel& model, const SceneState& state)
    : model_(model), state_(state) {
    quaternions_wxyz_.reserve(model.blocks().size());  // blocks_ points into it
    for (const ParameterBlock& block : model.blocks()) {
        if (is_turn(block)) {
            const auto& q = state.bodies[block.item].rotation;
            quaternions_wxyz_.emplace_back(q.w(), q.x(), q.y(), q.z());
            blocks_.push_back(quaternions_wxyz_.back().data());
        } else {
            blocks_.push_back(block.row->numbers(state_, block.item).data());
        }
    }
}

SceneState StateVector::state() const {
    SceneState state = state_;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
        const ParameterBlock& block = model_.blocks()[b];
        if (!is_turn(block)) continue;
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
    return is_turn(block) ? 4 : block.columns;
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
        if (is_turn(block)) {
            const core::Vec3 turn = part;
            const double angle = turn.norm();
            if (angle == 0.0) continue;
            auto& rotation = moved.bodies[block.item].rotation;
            rotation = (Eigen::AngleAxisd(angle, turn / angle) * rotation).normalized();
        } else {
            Eigen::Index i = 0;
            for (double& number : block.row->numbers(moved, block.item)) number += part[i++];
        }
    }
    return moved;
}

Eigen::VectorXd difference(const SceneModel& model, const SceneState& from, const SceneState& to) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(model.num_columns());
    for (const ParameterBlock& block : model.blocks()) {
        auto part = step.segment(block.first_column, block.columns);
        if (is_turn(block)) {
            Eigen::Quaterniond turn =
                to.bodies[block.item].rotation * from.bodies[block.item].rotation.conjugate();
            if (turn.w() < 0.0) turn.coeffs() *= -1.0;
            const Eigen::AngleAxisd angle_axis(turn);
            part = angle_axis.angle() * angle_axis.axis();
        } else {
            const auto before = block.row->numbers(from, block.item);
            const auto after = block.row->numbers(to, block.item);
            for (std::size_t i = 0; i < after.size(); ++i) {
                part[static_cast<Eigen::Index>(i)] = after[i] - before[i];
            }
        }
    }
    return step;
}

}  // namespace calib
