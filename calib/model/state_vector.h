// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/scene_model.h"

#include <Eigen/Dense>

#include <vector>

namespace calib {

/// A state's free numbers as parameter blocks for a solver; rotations are quaternions w, x, y, z.
class StateVector {
 public:
    /// model   must outlive this
    StateVector(const SceneModel& model, const SceneState& state);
    StateVector(const StateVector&) = delete;
    StateVector& operator=(const StateVector&) = delete;

    /// The state with the present values.
    SceneState state() const;
    /// One pointer per block of the model, into this object.
    const std::vector<double*>& blocks() const { return blocks_; }
    /// The present numbers of all blocks, one block after the other.
    std::vector<double> numbers() const;

    static int ambient_size(const ParameterBlock& block);
    /// d turn / d quaternion (3, 4): the world-frame turn that a change of the quaternion makes.
    static Eigen::Matrix<double, 3, 4> turn_by_quaternion(const double* wxyz);

 private:
    const SceneModel& model_;
    SceneState state_;                               ///< its rotations are those of the start
    std::vector<Eigen::Vector4d> quaternions_wxyz_;  ///< of the blocks that are rotations
    std::vector<double*> blocks_;
};

/// Moves a state by a step in the columns of the Jacobian.
SceneState moved_by(const SceneModel& model, const SceneState& state, const Eigen::VectorXd& step);

/// The step that moves one state to another: moved_by(model, from, difference(model, from, to)) is
/// `to` as far as the free parameters go.
Eigen::VectorXd difference(const SceneModel& model, const SceneState& from, const SceneState& to);

}  // namespace calib
