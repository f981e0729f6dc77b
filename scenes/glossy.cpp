// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

namespace scenes {
namespace {

renderer::Material glossy(const std::string& name, double albedo, double roughness) {
    renderer::Material material;
    material.name = name;
    material.model = renderer::SurfaceModel::Ggx;
    material.albedo = albedo;
    material.roughness = roughness;
    return material;
}

/// A rectangle around the origin that faces -z, towards the relay wall.
core::TriangleMesh make_plate(double width_m, double height_m) {
    const double x = width_m / 2.0;
    const double y = height_m / 2.0;
    return make_quad({x, -y, 0.0}, {-x, -y, 0.0}, {-x, y, 0.0}, {x, y, 0.0});
}

}  // namespace

GeneratedScene make_glossy() {
    GeneratedScene scene{"glossy", {}, {}};
    auto& objects = scene.geometry.objects;
    objects.push_back(place("ball",
                            make_radial_surface(4, [](const core::Vec3&) { return 0.13; }),
                            {0.2, 0.15, 0.65},
                            glossy("polished", 0.9, 0.3)));
    objects.push_back(place("plate",
                            rotated(make_plate(0.3, 0.3), core::Vec3::UnitY(), 15.0),
                            {-0.22, 0.15, 0.75},
                            glossy("brushed", 0.8, 0.6)));
    renderer::Material sheet = diffuse(0.7);
    sheet.name = "retroreflective";
    sheet.model = renderer::SurfaceModel::Retroreflective;
    objects.push_back(place("sign",
                            rotated(make_plate(0.24, 0.16), core::Vec3::UnitX(), 20.0),
                            {0.0, -0.25, 0.6},
                            sheet));
    return scene;
}

}  // namespace scenes
