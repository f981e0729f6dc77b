// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/scene_model.h"

#include <Eigen/Dense>

#include <vector>

namespace calib {

/// A state's free numbers as blocks that a solver changes; rotations are quaternions w, x, y, z.
class StateVector {
 public:
    /// model   must outlive this
    StateVector(const SceneModel& model, const SceneState& state);

    /// The state with the present values.
    SceneState state() const;
    double* block(std::size_t index) { return values_[index].data(); }
    std::vector<double*> blocks();

    static int ambient_size(const ParameterBlock& block);
    /// d turn / d quaternion (3, 4): the world-frame turn that a change of the quaternion makes.
    static Eigen::Matrix<double, 3, 4> turn_by_quaternion(const double* wxyz);

 private:
    const SceneModel& model_;
    SceneState base_;
    std::vector<std::vector<double>> values_;
};

/// Moves a state by a step in the columns of the Jacobian.
SceneState moved_by(const SceneModel& model, const SceneState& state, const Eigen::VectorXd& step);

/// The step that moves one state to another: moved_by(model, from, difference(model, from, to)) is
/// `to` as far as the free parameters go.
Eigen::VectorXd difference(const SceneModel& model, const SceneState& from, const SceneState& to);

}  // namespace calib
