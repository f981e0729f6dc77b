// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {

GeneratedScene make_corner() {
    // The corner of a room: x up to the side wall, y from the floor, z up to the back wall.
    const double left = -0.8;
    const double side = 0.6;
    const double floor = -0.5;
    const double top = 0.7;
    const double front = 0.15;  // stops short of the relay wall at z = 0
    const double back = 1.2;
    const core::Vec3 origin(0.0, 0.0, 0.0);
    const renderer::Material paint = diffuse(0.9);

    GeneratedScene scene{"corner", {}, {}};
    scene
        .add("back_wall",
             make_quad(
                 {side, floor, back}, {left, floor, back}, {left, top, back}, {side, top, back}),
             origin,
             paint)
        .role = renderer::Role::BackWall;
    scene
        .add("side_wall",
             make_quad(
                 {side, floor, front}, {side, floor, back}, {side, top, back}, {side, top, front}),
             origin,
             paint)
        .ellipsoidal_exclude = true;
    scene
        .add("floor",
             make_quad({left, floor, front},
                       {left, floor, back},
                       {side, floor, back},
                       {side, floor, front}),
             origin,
             paint)
        .ellipsoidal_exclude = true;

    const double box_height = 0.3;
    const double gap = 0.005;  // the box hovers: faces that coincide with the floor are ambiguous
    scene
        .add("box",
             rotated(make_box({0.22, box_height, 0.22}), core::Vec3::UnitY(), 30.0),
             {-0.25, floor + gap + box_height / 2.0, 0.75},
             diffuse(0.8))
        .velocity_m_per_s = {0.0, 0.0, -0.8};
    scene.add("ball", make_ball(3, 0.13), {0.2, -0.1, 0.65}, diffuse(0.85)).velocity_m_per_s = {
        0.6, 0.0, 0.0};
    return scene;
}

}  // namespace scenes
