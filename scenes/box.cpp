// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

#include <cmath>

namespace scenes {
namespace {

const core::Vec3 kBallVelocity(0.5, 0.0, 0.25);  ///< [m/s]

// A room 1 m wide and high and 1.2 m deep, open towards the camera on the +z side.
GeneratedScene make_room(const std::string& name) {
    constexpr double kHalf = 0.5;
    constexpr double kBack = -1.2;
    const core::Vec3 origin(0.0, 0.0, 0.0);
    // Corners by side: left or right, bottom or top, front or back.
    const core::Vec3 lbf(-kHalf, -kHalf, 0.0);
    const core::Vec3 rbf(kHalf, -kHalf, 0.0);
    const core::Vec3 ltf(-kHalf, kHalf, 0.0);
    const core::Vec3 rtf(kHalf, kHalf, 0.0);
    const core::Vec3 lbb(-kHalf, -kHalf, kBack);
    const core::Vec3 rbb(kHalf, -kHalf, kBack);
    const core::Vec3 ltb(-kHalf, kHalf, kBack);
    const core::Vec3 rtb(kHalf, kHalf, kBack);

    GeneratedScene scene{name, {}, {}};
    scene.add("back_wall", make_quad(lbb, rbb, rtb, ltb), origin, diffuse(0.75)).role =
        renderer::Role::BackWall;
    scene.add("floor", make_quad(lbf, rbf, rbb, lbb), origin, diffuse(0.7));
    scene.add("ceiling", make_quad(ltf, ltb, rtb, rtf), origin, diffuse(0.75));
    scene.add("left_wall", make_quad(lbf, lbb, ltb, ltf), origin, diffuse(0.35));
    scene.add("right_wall", make_quad(rbf, rtf, rtb, rbb), origin, diffuse(0.55));
    return scene;
}

core::TriangleMesh make_block() {
    return rotated(make_box({0.26, 0.5, 0.26}), core::Vec3::UnitY(), 20.0);
}

}  // namespace

GeneratedScene make_box_room() {
    GeneratedScene scene = make_room("box");
    scene
        .add("mirror_ball",
             make_ball(4, 0.17),
             {-0.2, -0.33, -0.75},
             conductor("polished", 0.95, 0.15))
        .velocity_m_per_s = kBallVelocity;
    scene.add("glossy_block", make_block(), {0.22, -0.25, -0.55}, conductor("brushed", 0.8, 0.5));
    return scene;
}

GeneratedScene make_diffuse_room() {
    GeneratedScene scene = make_room("room");
    const auto wavy = [](const core::Vec3& direction) {
        return 0.17 + 0.02 * std::sin(9.0 * direction.x()) * std::sin(7.0 * direction.y());
    };
    scene.add("ball", make_radial_surface(3, wavy), {-0.2, -0.25, -0.7}, diffuse(0.7))
        .velocity_m_per_s = kBallVelocity;
    scene.add("block", make_block(), {0.22, -0.25, -0.55}, diffuse(0.7));
    return scene;
}

}  // namespace scenes
