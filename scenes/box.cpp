// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

#include <cmath>

namespace scenes {
namespace {

renderer::Material conductor(const std::string& name, double albedo, double roughness) {
    renderer::Material material;
    material.name = name;
    material.model = renderer::SurfaceModel::Ggx;
    material.albedo = albedo;
    material.roughness = roughness;
    return material;
}

// A room 1 m wide and high and 1.2 m deep, open towards the camera on the +z side.
std::vector<renderer::Object> make_walls() {
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

    std::vector<renderer::Object> objects;
    objects.push_back(place("back_wall", make_quad(lbb, rbb, rtb, ltb), origin, diffuse(0.75)));
    objects.back().role = renderer::Role::BackWall;
    objects.push_back(place("floor", make_quad(lbf, rbf, rbb, lbb), origin, diffuse(0.7)));
    objects.push_back(place("ceiling", make_quad(ltf, ltb, rtb, rtf), origin, diffuse(0.75)));
    objects.push_back(place("left_wall", make_quad(lbf, lbb, ltb, ltf), origin, diffuse(0.35)));
    objects.push_back(place("right_wall", make_quad(rbf, rtf, rtb, rbb), origin, diffuse(0.55)));
    return objects;
}

core::TriangleMesh make_block() {
    return rotated(make_box({0.26, 0.5, 0.26}), core::Vec3::UnitY(), 20.0);
}

}  // namespace

GeneratedScene make_box_room() {
    GeneratedScene scene{"box", {make_walls(), {}}, {}};
    auto& objects = scene.geometry.objects;
    objects.push_back(place("mirror_ball",
                            make_radial_surface(4, [](const core::Vec3&) { return 0.17; }),
                            {-0.2, -0.33, -0.75},
                            conductor("polished", 0.95, 0.15)));
    objects.back().velocity_m_per_s = core::Vec3(0.5, 0.0, 0.25);
    objects.push_back(
        place("glossy_block", make_block(), {0.22, -0.25, -0.55}, conductor("brushed", 0.8, 0.5)));
    return scene;
}

GeneratedScene make_diffuse_room() {
    GeneratedScene scene{"room", {make_walls(), {}}, {}};
    auto& objects = scene.geometry.objects;
    const auto wavy = [](const core::Vec3& direction) {
        return 0.17 + 0.02 * std::sin(9.0 * direction.x()) * std::sin(7.0 * direction.y());
    };
    objects.push_back(
        place("ball", make_radial_surface(3, wavy), {-0.2, -0.25, -0.7}, diffuse(0.7)));
    objects.back().velocity_m_per_s = core::Vec3(0.5, 0.0, 0.25);
    objects.push_back(place("block", make_block(), {0.22, -0.25, -0.55}, diffuse(0.7)));
    return scene;
}

}  // namespace scenes
