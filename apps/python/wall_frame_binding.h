// SPDX-License-Identifier: MIT
#pragma once

#include "apps/python/arrays.h"

namespace python {

/// A transform as an array (4, 4) of its own, for properties by rv_policy::reference.
Array<double> matrix_of(const core::Transform& transform);

/// Places in a wall's frame as places in the world, (..., 3) [m].
///
/// x_m, y_m, depth_m   numbers or arrays, which are broadcast against one another [m]
/// throws              core::Error naming what is no number
Array<double> world_places(const core::Transform& world_from_wall,
                           nanobind::handle x_m,
                           nanobind::handle y_m,
                           nanobind::handle depth_m);

/// Adds what leads from a class's wall to the world: world_from_wall and to_world().
///
/// pose_of   an object's world_from_wall
template <class T, class PoseOf>
void bind_wall_frame(nanobind::class_<T>& binding, const PoseOf& pose_of) {
    namespace nb = nanobind;
    binding
        .def_prop_ro(
            "world_from_wall",
            [pose_of](const T& self) { return matrix_of(pose_of(self)); },
            nb::rv_policy::reference,
            "(4, 4) float64: from wall x, wall y and depth to the world's x, y and z [m]")
        .def(
            "to_world",
            [pose_of](const T& self, nb::handle x_m, nb::handle y_m, nb::handle depth_m) {
                return world_places(pose_of(self), x_m, y_m, depth_m);
            },
            nb::arg("x_m"),
            nb::arg("y_m"),
            nb::arg("depth_m"),
            nb::rv_policy::reference,
            "Places in the wall's frame as (..., 3) float64 in the world [m]; the three are "
            "broadcast. Of a surface, (X, Y, 3): r.to_world(r.x_m[:, None], r.y_m, r.depth_m).");
}

}  // namespace python
