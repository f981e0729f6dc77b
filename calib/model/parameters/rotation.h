// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

inline const Parameter kRotation{
    .name = "rotation",
    .owner = Owner::Body,
    .effect = Effect::Rotates,
    .group = "pose",
    .columns = {"rotation_x", "rotation_y", "rotation_z"},
    .storage =
        [](SceneState& state, std::size_t body) {
            return std::span<double>(state.bodies[body].rotation.coeffs().data(), 4);
        },
    .move_facet =
        [](const FacetPosition& at, FacetMotion& motion) {
            for (int a = 0; a < 3; ++a) {
                std::array<core::Vec3, 3> turned;
                for (std::size_t i = 0; i < 3; ++i) {
                    turned[i] = core::Vec3::Unit(a).cross(motion.corners[i] - at.state.position_m);
                }
                motion.add(at.column + a, turned);
            }
        },
    .report_body =
        [](const BodyPosition& at, std::span<const double> sigma, FittedObject& object) {
            object.rotation = (at.state.rotation * Eigen::Quaterniond(at.body.turn)).normalized();
            if (object.rotation.w() < 0.0) object.rotation.coeffs() *= -1.0;
            object.rotation_sigma_deg =
                core::kDegreesPerRadian * core::Vec3(sigma[0], sigma[1], sigma[2]);
        }};

}  // namespace calib
