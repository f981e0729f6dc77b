// SPDX-License-Identifier: MIT
#include "calib/model/state_vector.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

// Calls visit(value) for the numbers of a block that are not a rotation.
template <class State, class Visit>
void for_each_value(State& state, const ParameterBlock& block, Visit&& visit) {
    switch (block.kind) {
        case ParameterKind::Translation:
            for (int a = 0; a < 3; ++a) visit(state.bodies[block.item].position_m[a]);
            break;
        case ParameterKind::Rotation:
            break;
        case ParameterKind::Size:
            visit(state.bodies[block.item].log_size);
            break;
        case ParameterKind::Albedo:
            visit(state.bodies[block.item].log_albedo);
            break;
        case ParameterKind::Heights:
            for (auto& height : state.bodies[block.item].heights_m) visit(height);
            break;
        case ParameterKind::PointPosition:
            for (int a = 0; a < 3; ++a) visit(state.points[block.item].position_m[a]);
            break;
        case ParameterKind::PointAlbedo:
            visit(state.points[block.item].log_albedo);
            break;
        case ParameterKind::TimeZero:
            visit(state.time_zero_m);
            break;
        case ParameterKind::Ambient:
            visit(state.log_ambient);
            break;
        case ParameterKind::ResponseWidth:
            visit(state.log_width);
            break;
        case ParameterKind::WallBow:
            visit(state.bow_m);
            break;
        case ParameterKind::WallScale:
            visit(state.log_wall_scale);
            break;
        case ParameterKind::Scale:
            visit(state.log_scale);
            break;
    }
}

}  // namespace

StateVector::StateVector(const SceneModel& model, const SceneState& state)
    : model_(model), base_(state) {
    for (const ParameterBlock& block : model.blocks()) {
        auto& list = values_.emplace_back();
        if (block.kind == ParameterKind::Rotation) {
            const auto& q = state.bodies[block.item].rotation;
            list = {q.w(), q.x(), q.y(), q.z()};
        } else {
            for_each_value(state, block, [&](double value) { list.push_back(value); });
        }
    }
}

SceneState StateVector::state() const {
    SceneState state = base_;
    for (std::size_t b = 0; b < values_.size(); ++b) {
        const ParameterBlock& block = model_.blocks()[b];
        const auto& list = values_[b];
        if (block.kind == ParameterKind::Rotation) {
            state.bodies[block.item].rotation =
                Eigen::Quaterniond(list[0], list[1], list[2], list[3]).normalized();
        } else {
            std::size_t i = 0;
            for_each_value(state, block, [&](double& value) { value = list[i++]; });
        }
    }
    return state;
}

std::vector<double*> StateVector::blocks() {
    std::vector<double*> result;
    for (auto& list : values_) result.push_back(list.data());
    return result;
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
            for_each_value(moved, block, [&](double& value) { value += part[i++]; });
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
            Eigen::Index i = 0;
            for_each_value(to, block, [&](double value) { part[i++] = value; });
            i = 0;
            for_each_value(from, block, [&](double value) { part[i++] -= value; });
        }
    }
    return step;
}

}  // namespace calib
