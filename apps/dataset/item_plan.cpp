// SPDX-License-Identifier: MIT
#include "apps/dataset/item_plan.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace apps {
namespace {

using core::Rng;
using core::Vec3;

constexpr int kMostMeshesTried = 1000;
constexpr int kMostPositionsTried = 200;
constexpr double kGap_m = 0.01;  // between an object and the wall, or another object

/// Shoemake's [Shoemake1992].
Eigen::Quaterniond draw_rotation(Rotation rotation, Rng& rng) {
    const double turn = 2.0 * std::numbers::pi * rng.uniform();
    if (rotation == Rotation::None) return Eigen::Quaterniond::Identity();
    if (rotation == Rotation::Upright) {
        return Eigen::Quaterniond(Eigen::AngleAxisd(turn, Vec3::UnitY()));
    }
    const double fraction = rng.uniform();
    const double other = 2.0 * std::numbers::pi * rng.uniform();
    const double near = std::sqrt(1.0 - fraction);
    const double far = std::sqrt(fraction);
    return {
        far * std::cos(other), near * std::sin(turn), near * std::cos(turn), far * std::sin(other)};
}

/// An object before it has its place.
struct DrawnObject {
    std::shared_ptr<const UnitMesh> mesh;
    Vec3 scale;
    Eigen::Quaterniond rotation;
    double radius_m;
};

std::shared_ptr<const UnitMesh> draw_mesh(MeshLibrary& meshes,
                                          Rng& rng,
                                          std::set<std::size_t>& broken) {
    const auto count = static_cast<double>(meshes.size());
    for (int tried = 0; tried < kMostMeshesTried; ++tried) {
        const auto index =
            std::min(static_cast<std::size_t>(rng.uniform() * count), meshes.size() - 1);
        if (auto mesh = meshes.mesh(index)) return mesh;
        broken.insert(index);
    }
    throw core::Error("meshes",
                      fmt::format("none can be used; for example {}",
                                  broken.empty() ? "" : meshes.why_broken(*broken.begin())),
                      "must hold surfaces");
}

DrawnObject draw_object(const ObjectDistributions& how,
                        MeshLibrary& meshes,
                        Rng& rng,
                        std::set<std::size_t>& broken) {
    DrawnObject object;
    object.mesh = draw_mesh(meshes, rng, broken);
    const double size_m = draw_number(how.size_m, rng);
    for (double& factor : object.scale) factor = draw_number(how.stretch, rng);
    Eigen::AlignedBox3d box;
    for (const Vec3& vertex : object.mesh->mesh.vertices) {
        box.extend(Vec3(object.scale.cwiseProduct(vertex)));
    }
    object.scale *= size_m / box.sizes().maxCoeff();
    object.radius_m = object.scale.maxCoeff() * object.mesh->radius;
    object.rotation = draw_rotation(how.rotation, rng);
    return object;
}

renderer::Material draw_material(const ObjectDistributions& how, Rng& rng) {
    renderer::Material material;
    material.albedo = draw_number(how.albedo, rng);
    const bool is_metal = rng.uniform() < draw_number(how.glossy, rng);
    const double roughness = draw_number(how.roughness, rng);
    if (is_metal) {
        material.model = renderer::model_of({.metallic = true});
        material.roughness = roughness;
    }
    return material;
}

struct Ball {
    Vec3 centre_m;  ///< in the wall's frame
    double radius_m;
};

/// A place in front of the wall and, if asked for, beside the others; nothing when none is found.
std::optional<Vec3> draw_position(const ObjectDistributions& how,
                                  double radius_m,
                                  const std::vector<Ball>& others,
                                  Rng& rng) {
    for (int tried = 0; tried < kMostPositionsTried; ++tried) {
        const Vec3 position(
            draw_number(how.x_m, rng), draw_number(how.y_m, rng), draw_number(how.z_m, rng));
        if (position.z() - radius_m < kGap_m) continue;
        const bool is_free = std::all_of(others.begin(), others.end(), [&](const Ball& other) {
            return (position - other.centre_m).norm() >= radius_m + other.radius_m + kGap_m;
        });
        if (is_free || !how.keep_apart) return position;
    }
    return std::nullopt;
}

core::Json describe(const PlacedObject& object, const DrawnObject& drawn, const Vec3& position) {
    const Eigen::Quaterniond& q = drawn.rotation;
    const renderer::Material& material = object.material;
    return {{"mesh", object.mesh->name},
            {"triangles", object.mesh->mesh.triangles.size()},
            {"frame", "wall"},
            {"position_m", core::write_value(position)},
            {"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
            {"scale_m", core::write_value(drawn.scale)},
            {"albedo", material.albedo},
            {"material", std::string(core::enum_name(material.model))},
            {"roughness", material.roughness}};
}

void place_objects(const Recipe& recipe, MeshLibrary& meshes, std::uint64_t item, ItemPlan& plan) {
    const ObjectDistributions& how = recipe.objects;
    Rng count_rng(recipe.seed, item, stream_of("objects.count"));
    const auto count = static_cast<int>(std::lround(draw_number(how.count, count_rng)));
    const core::Transform world_from_wall = plan.settings.scene.relay_wall.world_from_wall();
    std::vector<Ball> balls;
    int left_out = 0;
    for (int i = 0; i < count; ++i) {
        Rng rng(recipe.seed, item, stream_of(fmt::format("objects[{}]", i)));
        const DrawnObject drawn = draw_object(how, meshes, rng, plan.broken);
        PlacedObject object{drawn.mesh, core::Transform::Identity(), draw_material(how, rng)};
        const auto position = draw_position(how, drawn.radius_m, balls, rng);
        if (!position && balls.empty() && i + 1 == count) {
            throw core::Error("objects",
                              fmt::format("item {}: no object finds a place", item),
                              "must have sizes and places of which some lie in front of the wall");
        }
        if (!position) {
            ++left_out;
            continue;
        }
        object.world_from_mesh = world_from_wall * Eigen::Translation3d(*position) *
                                 drawn.rotation * Eigen::Scaling(drawn.scale);
        plan.parameters["objects"].push_back(describe(object, drawn, *position));
        plan.objects.push_back(std::move(object));
        balls.push_back({*position, drawn.radius_m});
    }
    plan.parameters["objects_left_out"] = left_out;
}

/// A seed of a number's own for each item; positive in any signed type.
std::uint64_t item_seed(const Recipe& recipe, std::uint64_t item, std::string_view name) {
    return Rng(recipe.seed, item, stream_of(name)).next_bits() >> 1U;
}

}  // namespace

ItemPlan plan_item(const Recipe& recipe, MeshLibrary& meshes, std::uint64_t item) {
    ItemPlan plan;
    plan.settings = recipe;
    plan.parameters = {{"item", item}, {"drawn", core::Json::object()}};
    core::Json& values = plan.parameters["drawn"];
    for (const auto& [key, distribution] : recipe.draw) {
        Rng rng(recipe.seed, item, stream_of(key));
        values[key] = draw(distribution, rng);
    }
    apply_values(values, plan.settings);
    renderer::validate(plan.settings.scene, fmt::format("item {}: scene.", item));
    plan.settings.scene.render.seed = item_seed(recipe, item, "render.seed");
    if (plan.settings.detector) {
        plan.settings.detector->seed = item_seed(recipe, item, "detector.seed");
    }
    place_objects(recipe, meshes, item, plan);
    return plan;
}

renderer::SceneGeometry geometry_of(const ItemPlan& plan) {
    renderer::SceneGeometry geometry;
    for (const PlacedObject& placed : plan.objects) {
        renderer::Object& object = geometry.objects.emplace_back();
        object.name = fmt::format("{}_{}", placed.mesh->name, geometry.objects.size() - 1);
        object.material = placed.material;
        object.world_from_node = placed.world_from_mesh;
        object.mesh.triangles = placed.mesh->mesh.triangles;
        for (const Vec3& vertex : placed.mesh->mesh.vertices) {
            object.mesh.vertices.push_back(placed.world_from_mesh * vertex);
        }
    }
    return geometry;
}

}  // namespace apps
