// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/recipe.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace test_support {

/// A recipe whose items take milliseconds, with `changes` merged into it.
inline core::Json tiny_recipe(const core::Json& changes = core::Json::object()) {
    core::Json recipe = {
        {"items", 10},
        {"items_per_shard", 4},
        {"seed", 5},
        {"meshes", {{"shapes", {"plate", "box"}}}},
        {"objects", {{"count", {{"integers", {1, 2}}}}}},
        {"scene",
         {{"scan", {{"sensing_points", {4, 4}}}},
          {"time_axis", {{"opl_start_m", 0.6}, {"bin_width_m", 0.03}, {"num_bins", 96}}},
          {"render", {{"target_error", 0.1}}},
          {"ground_truth", {{"depth_resolution", {8, 8}}}}}},
        {"detector", {{"photons_per_point", 200}}},
        {"draw", {{"scene.relay_wall.albedo", {{"uniform", {0.4, 0.9}}}}}},
        {"truths", {"depth", "normals", "albedo", "mask", "object_ids", "poses", "clean"}}};
    recipe.merge_patch(changes);
    return recipe;
}

inline apps::Recipe read(const TemporaryFolder& folder, const core::Json& recipe) {
    test_support::write_file_bytes(folder.file("recipe_in.json"), recipe.dump());
    return apps::read_recipe(folder.file("recipe_in.json"), {});
}

}  // namespace test_support
