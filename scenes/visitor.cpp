// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {

GeneratedScene make_visitor() {
    GeneratedScene scene{"visitor", {}, {}};
    scene
        .add("back_wall",
             make_quad({1.5, -1.0, 2.5}, {-1.5, -1.0, 2.5}, {-1.5, 1.2, 2.5}, {1.5, 1.2, 2.5}),
             {0.0, 0.0, 0.0},
             diffuse(0.5))
        .role = renderer::Role::BackWall;
    renderer::Material vest = diffuse(0.6);
    vest.model = renderer::model_of({.retroreflective = true});
    scene.add("visitor", make_box({0.45, 0.6, 0.25}), {-1.1, 0.1, 1.2}, vest).velocity_m_per_s = {
        0.8, 0.0, 0.1};
    return scene;
}

}  // namespace scenes
