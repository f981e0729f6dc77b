// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {

GeneratedScene make_traffic() {
    GeneratedScene scene{"traffic", {}, {}};
    auto& objects = scene.geometry.objects;
    const core::Vec3 origin(0.0, 0.0, 0.0);
    objects.push_back(
        place("road",
              make_quad({-1.0, -0.5, 0.05}, {1.0, -0.5, 0.05}, {1.0, -0.5, 2.2}, {-1.0, -0.5, 2.2}),
              origin,
              diffuse(0.3)));
    objects.push_back(
        place("back_wall",
              make_quad({-1.0, -0.5, 2.2}, {1.0, -0.5, 2.2}, {1.0, 0.8, 2.2}, {-1.0, 0.8, 2.2}),
              origin,
              diffuse(0.5)));
    objects.back().role = renderer::Role::BackWall;
    const auto move = [&](const core::Vec3& velocity_m_per_s) {
        objects.back().velocity_m_per_s = velocity_m_per_s;
    };
    const auto ball = [](double radius_m) {
        return make_radial_surface(3, [radius_m](const core::Vec3&) { return radius_m; });
    };
    objects.push_back(place("approaching", ball(0.2), {-0.42, -0.3, 1.0}, diffuse(0.8)));
    move({0.0, 0.0, -3.0});
    objects.push_back(place("receding", ball(0.2), {0.42, -0.3, 1.2}, diffuse(0.8)));
    move({0.0, 0.0, 2.0});
    objects.push_back(place("crossing", make_box({0.3, 0.4, 0.2}), {0.0, -0.3, 1.7}, diffuse(0.8)));
    move({2.5, 0.0, 0.0});
    return scene;
}

}  // namespace scenes
