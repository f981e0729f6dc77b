// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {

GeneratedScene make_traffic() {
    GeneratedScene scene{"traffic", {}, {}};
    const core::Vec3 origin(0.0, 0.0, 0.0);
    scene.add("road",
              make_quad({-1.0, -0.5, 0.05}, {1.0, -0.5, 0.05}, {1.0, -0.5, 2.2}, {-1.0, -0.5, 2.2}),
              origin,
              diffuse(0.3));
    scene
        .add("back_wall",
             make_quad({-1.0, -0.5, 2.2}, {1.0, -0.5, 2.2}, {1.0, 0.8, 2.2}, {-1.0, 0.8, 2.2}),
             origin,
             diffuse(0.5))
        .role = renderer::Role::BackWall;
    scene.add("approaching", make_ball(3, 0.2), {-0.42, -0.3, 1.0}, diffuse(0.8))
        .velocity_m_per_s = {0.0, 0.0, -3.0};
    scene.add("receding", make_ball(3, 0.2), {0.42, -0.3, 1.2}, diffuse(0.8)).velocity_m_per_s = {
        0.0, 0.0, 2.0};
    scene.add("crossing", make_box({0.3, 0.4, 0.2}), {0.0, -0.3, 1.7}, diffuse(0.8))
        .velocity_m_per_s = {2.5, 0.0, 0.0};
    return scene;
}

}  // namespace scenes
