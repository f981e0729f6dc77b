// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

inline const Parameter kTranslation{
    .name = "translation",
    .owner = Owner::Body,
    .effect = Effect::Translates,
    .group = "pose",
    .columns = {"x", "y", "z"},
    .storage =
        [](SceneState& state, std::size_t body) {
            return std::span<double>(state.bodies[body].position_m.data(), 3);
        },
    .start_body =
        [](const ModelBody& body, bool, BodyState& state) { state.position_m = body.origin_m; },
    .move_facet =
        [](const FacetPosition& at, FacetMotion& motion) {
            for (int a = 0; a < 3; ++a) {
                const core::Vec3 axis = core::Vec3::Unit(a);
                motion.add(at.column + a, {axis, axis, axis});
            }
        },
    .report_body =
        [](const BodyPosition& at, std::span<const double> sigma, FittedObject& object) {
            object.position_m = at.state.position_m;
            object.position_sigma_m = {sigma[0], sigma[1], sigma[2]};
        }};

}  // namespace calib
