// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {
namespace {

/// A rectangle around the origin that faces -z, towards the relay wall.
core::TriangleMesh make_plate(double width_m, double height_m) {
    const double x = width_m / 2.0;
    const double y = height_m / 2.0;
    return make_quad({x, -y, 0.0}, {-x, -y, 0.0}, {-x, y, 0.0}, {x, y, 0.0});
}

}  // namespace

GeneratedScene make_glossy() {
    GeneratedScene scene{"glossy", {}, {}};
    scene.add("ball", make_ball(4, 0.13), {0.2, 0.15, 0.65}, conductor("polished", 0.9, 0.3));
    scene.add("plate",
              rotated(make_plate(0.3, 0.3), core::Vec3::UnitY(), 15.0),
              {-0.22, 0.15, 0.75},
              conductor("brushed", 0.8, 0.6));
    renderer::Material sheet = diffuse(0.7);
    sheet.name = "retroreflective";
    sheet.model = renderer::model_of({.retroreflective = true});
    scene.add("sign",
              rotated(make_plate(0.24, 0.16), core::Vec3::UnitX(), 20.0),
              {0.0, -0.25, 0.6},
              sheet);
    return scene;
}

}  // namespace scenes
