// SPDX-License-Identifier: MIT
#include "renderer/scene_import/mitsuba_shape.h"

#include "renderer/core/error.h"
#include "renderer/scene_import/mitsuba_transform.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::array<const char*, 20> kShapes{
    "rectangle",    "cube",        "sphere",   "disk",       "cylinder",       "obj",    "ply",
    "stl",          "serialized",  "instance", "shapegroup", "linearcurve",    "hair",   "sdfgrid",
    "bsplinecurve", "heightfield", "merge",    "ellipsoids", "ellipsoidsmesh", "blender"};

/// From the unit cylinder to one from p0 to p1.
void stretch_cylinder(KeyReader& keys, core::Transform& to_world) {
    const Vec3 p0 = keys.get("p0", Vec3(Vec3::Zero()));
    const Vec3 axis = keys.get("p1", Vec3(Vec3::UnitZ())) - p0;
    const double radius = keys.get("radius", 1.0);
    if (!(axis.norm() > 0.0)) {
        throw core::Error(keys.where("p1"), "is p0", "must be another point");
    }
    const Vec3 hint = std::abs(axis.normalized().x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
    to_world.translate(p0);
    to_world.rotate(core::frame_from_normal(axis.normalized(), hint));
    to_world.scale(Vec3(radius, radius, axis.norm()));
}

}  // namespace

bool is_mitsuba_shape(const core::Json& plugin) {
    return std::find(kShapes.begin(), kShapes.end(), type_of(plugin)) != kShapes.end();
}

ForeignShape mitsuba_shape(KeyReader& keys, const std::string& key) {
    ForeignShape shape;
    shape.type = keys.get<std::string>("type", "");
    shape.name = keys.get<std::string>("id", key);
    shape.filename = keys.get<std::string>("filename", "");
    if (const core::Json* matrix = keys.find("to_world")) {
        shape.to_world = read_transform(*matrix, keys.where("to_world"));
    }
    if (shape.type == "sphere") {
        const Vec3 center = keys.get("center", Vec3(Vec3::Zero()));
        shape.to_world.translate(center).scale(keys.get("radius", 1.0));
    }
    if (shape.type == "cylinder") stretch_cylinder(keys, shape.to_world);
    keys.ignore({"flip_normals", "face_normals", "flip_tex_coords"});
    return shape;
}

}  // namespace renderer
