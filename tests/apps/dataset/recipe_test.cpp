// SPDX-License-Identifier: MIT
#include "apps/dataset/recipe.h"

#include "renderer/core/settings/json_file.h"
#include "tests/apps/dataset/tiny_recipe.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

namespace {

using test_support::read;
using test_support::TemporaryFolder;
using test_support::tiny_recipe;

TEST(Recipe, ErrorsNameKeyAndWhatIsAllowed) {
    const TemporaryFolder folder;
    const auto expect = [&](const core::Json& changes, const char* part) {
        EXPECT_ERROR_WITH(read(folder, tiny_recipe(changes)), part);
    };
    expect({{"items", 0}}, "items: found 0");
    expect({{"item", 5}}, "items_per_shard");
    expect({{"meshes", {{"shapes", {"cube"}}}}}, "sphere|box");
    expect({{"meshes", {{"shapes", core::Json::array()}}}}, "meshes: found no source");
    expect({{"objects", {{"albedo", {{"uniform", {0.5, 1.5}}}}}}}, "objects.albedo: found 1.5");
    expect({{"objects", {{"count", 0}}}}, "objects.count: found 0");
    expect({{"scene", {{"geometry", "x.glb"}}}}, "scene.geometry");
    expect({{"scene", {{"time_axis", "auto"}}}}, "scene.time_axis");
    expect({{"scene", {{"camera", {{"fov_y_deg", 40}}}}}}, "scene.camera");
    expect({{"draw", {{"scene.wall", 1}}}}, "draw.scene.wall");
    expect({{"draw", {{"scene.relay_wall.albedo", {{"uniform", {0.5, 2.0}}}}}}},
           "draw.scene.relay_wall.albedo");
    expect({{"draw", {{"scene.scan.sensing_points", {{"choices", {{4, 4}, {8, 8}}}}}}}},
           "format webdataset");
    expect({{"detector", {{"photons_per_point", nullptr}}}}, "amount of light");
    expect({{"detector", {{"photons_per_point", -1}}}}, "detector.photons_per_point");
    expect({{"detector", nullptr}, {"storage", {{"histograms", "uint8"}}}}, "float32 or float16");
    expect({{"truths", {"depth", "depth"}}}, "depth twice");
    expect({{"meshes", {{"folder", "nowhere"}}}, {"seed", -1}}, "seed");
    expect({{"items", 1e13}}, "items");
    expect({{"items", 100000000}, {"items_per_shard", 1}}, "items_per_shard: found 1");
    expect({{"objects", {{"count", 1.5}}}}, "whole numbers");
    expect({{"objects", {{"count", {{"integers", nullptr}, {"uniform", {1, 3}}}}}}},
           "whole numbers");
    expect({{"objects", {{"count", 1000000}}}}, "objects.count");
    expect({{"objects", {{"size_m", 1e-300}}}}, "objects.size_m");
    expect({{"scene", {{"render", {{"seconds", 1}, {"target_error", nullptr}}}}}},
           "render.seconds");
    expect({{"scene", {{"render", {{"variance", true}}}}}}, "render.variance");
    expect({{"draw", {{"scene.frames", {{"choices", {{{"count", 2}}}}}}}}}, "draw.scene.frames");
    expect({{"draw", {{"scene.relay_wall", {{"choices", {{{"albedo", 0.5}}}}}}}}},
           "found beside scene.relay_wall");
    expect({{"draw", {{"detector.expected", {{"choices", {true}}}}}},
            {"storage", {{"histograms", "uint16"}}}},
           "draw.detector.expected: storage.histograms");
}

}  // namespace
