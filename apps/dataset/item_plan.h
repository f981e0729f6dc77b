// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/mesh_library.h"
#include "apps/dataset/recipe.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/material/scene_geometry.h"

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

namespace apps {

/// A surface where an item has it.
struct PlacedObject {
    std::shared_ptr<const UnitMesh> mesh;
    core::Transform world_from_mesh = core::Transform::Identity();  ///< scale and stretch included
    renderer::Material material;
};

/// What an item is, before anything is computed.
struct ItemPlan {
    ItemSettings settings;  ///< with everything drawn
    std::vector<PlacedObject> objects;
    core::Json parameters;         ///< what was drawn, for people and for learning
    std::set<std::size_t> broken;  ///< meshes that were drawn and cannot be used
};

/// Draws item `item` of a recipe: the same for the same recipe and meshes, whatever else is drawn.
///
/// Objects that find no place are left out, at most all but the first; `objects_left_out` of the
/// parameters counts them.
///
/// throws   core::Error when no mesh can be used, or the first object never stands in front of the
///          wall
ItemPlan plan_item(const Recipe& recipe, MeshLibrary& meshes, std::uint64_t item);

/// The objects of a plan as a scene's geometry, in its order.
renderer::SceneGeometry geometry_of(const ItemPlan& plan);

}  // namespace apps
