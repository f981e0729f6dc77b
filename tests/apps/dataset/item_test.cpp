// SPDX-License-Identifier: MIT
#include "apps/dataset/item.h"

#include "apps/dataset/generate.h"
#include "nlos/formats/capture_arrays.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/render.h"
#include "tests/apps/dataset/tiny_recipe.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace {

using apps::Dataset;
using apps::Recipe;
using test_support::read;
using test_support::TemporaryFolder;
using test_support::tiny_recipe;

TEST(DatasetItem, ItemsAreWhatTheRendererAndTheDetectorGiveForTheirPlan) {
    const TemporaryFolder folder;
    const Recipe recipe = read(folder, tiny_recipe());
    apps::MeshLibrary meshes(recipe);
    for (const std::uint64_t number : {0, 3, 7}) {
        const apps::Item item = apps::make_item(recipe, meshes, number, {});
        const apps::ItemPlan plan = apps::plan_item(recipe, meshes, number);
        const renderer::SceneDescription& description = plan.settings.scene;
        const double albedo = item.parameters["drawn"]["scene.relay_wall.albedo"];
        EXPECT_EQ(description.relay_wall.albedo, albedo);
        const core::Scan scan = renderer::make_scan(description);
        const renderer::Scene scene =
            renderer::make_scene(apps::geometry_of(plan), description, scan);
        const core::Capture clean =
            renderer::render(
                scene, scan, {description.time_axis, std::nullopt}, description.render, {})
                .capture;
        const core::Capture counts = nlos::detect(clean, *plan.settings.detector);
        std::vector<float> expected(clean.transient.values().size());
        nlos::copy_rows(clean.transient, 0, 96, expected.data());
        const auto bytes_of = [&](const char* name) {
            for (const apps::ItemArray& array : item.arrays) {
                if (array.name == name) return array.bytes;
            }
            return std::string();
        };
        const auto as_bytes = [&] {
            return std::string(reinterpret_cast<const char*>(expected.data()),
                               expected.size() * sizeof(float));
        };
        EXPECT_EQ(bytes_of("clean"), as_bytes());
        nlos::copy_rows(counts.transient, 0, 96, expected.data());
        EXPECT_EQ(bytes_of("H"), as_bytes());
    }
}

TEST(DatasetItem, ObjectsStandApartInFrontOfTheWallAndFillTheirBoxes) {
    const TemporaryFolder folder;
    const Recipe recipe = read(folder,
                               tiny_recipe({{"objects",
                                             {{"count", 3},
                                              {"size_m", {{"uniform", {0.1, 0.4}}}},
                                              {"z_m", {{"uniform", {0.1, 0.8}}}},
                                              {"stretch", {{"uniform", {0.5, 1.0}}}}}}}));
    apps::MeshLibrary meshes(recipe);
    for (std::uint64_t number = 0; number < 50; ++number) {
        const apps::ItemPlan plan = apps::plan_item(recipe, meshes, number);
        const renderer::SceneGeometry geometry = apps::geometry_of(plan);
        const auto left_out = plan.parameters["objects_left_out"].get<std::size_t>();
        EXPECT_EQ(geometry.objects.size() + left_out, 3u);
        for (const renderer::Object& a : geometry.objects) {
            for (const core::Vec3& p : a.mesh.vertices) EXPECT_GT(p.z(), 0.0);
            for (const renderer::Object& b : geometry.objects) {
                if (&a == &b) continue;
                for (const core::Vec3& p : a.mesh.vertices) {
                    for (const core::Vec3& q : b.mesh.vertices) ASSERT_GT((p - q).norm(), 0.009);
                }
            }
        }
        for (const core::Json& object : plan.parameters["objects"]) {
            double longest = 0.0;
            for (const core::Json& side : object["scale_m"]) {
                longest = std::max(longest, side.get<double>());
            }
            EXPECT_GE(longest, 0.1 - 1e-12);
        }
    }
}

TEST(DatasetItem, DarkItemsHoldWhatIsNotSignal) {
    const TemporaryFolder folder;
    const Recipe recipe =
        read(folder,
             tiny_recipe({{"scene", {{"time_axis", {{"opl_start_m", 50.0}}}}},
                          {"detector", {{"photons_per_point", 100}, {"ambient", 3.0}}}}));
    apps::MeshLibrary meshes(recipe);
    const apps::Item item = apps::make_item(recipe, meshes, 0, {});
    EXPECT_TRUE(item.is_dark);
    std::vector<float> counts(96 * 16);
    ASSERT_EQ(item.arrays.front().bytes.size(), counts.size() * sizeof(float));
    std::memcpy(counts.data(), item.arrays.front().bytes.data(), item.arrays.front().bytes.size());
    double sum = 0.0;
    for (const float count : counts) sum += count;
    const double mean = sum / static_cast<double>(counts.size());
    EXPECT_NEAR(mean, 3.0, 5.0 * std::sqrt(3.0 / static_cast<double>(counts.size())));
}

TEST(DatasetItem, HalvesKeepElevenBitsOfRadianceAndCountsAreClipped) {
    const TemporaryFolder folder;
    core::Json recipe = tiny_recipe({{"storage", {{"histograms", "float16"}}}});
    recipe["detector"] = nullptr;
    Dataset halves(read(folder, recipe), folder.file("halves"));
    const apps::Item item = apps::make_item(halves.recipe(), halves.meshes(), 2, {});
    std::vector<Eigen::half> stored;
    std::vector<float> clean;
    float scale = 0.0F;
    const auto copy = [](const apps::ItemArray& array, auto& values) {
        values.resize(array.bytes.size() / sizeof(values[0]));
        std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
    };
    for (const apps::ItemArray& array : item.arrays) {
        if (array.name == "H") copy(array, stored);
        if (array.name == "clean") copy(array, clean);
        if (array.name == "H_scale") std::memcpy(&scale, array.bytes.data(), sizeof(scale));
    }
    ASSERT_EQ(stored.size(), clean.size());
    const float most = *std::max_element(clean.begin(), clean.end());
    ASSERT_GT(most, 0.0F);
    for (std::size_t i = 0; i < clean.size(); ++i) {
        const float back = static_cast<float>(stored[i]) * scale;
        EXPECT_NEAR(back, clean[i], 0.0005F * clean[i] + 1e-9F * most);
    }
    const Recipe bright = read(folder,
                               tiny_recipe({{"storage", {{"histograms", "uint8"}}},
                                            {"detector", {{"photons_per_point", 1e5}}}}));
    apps::MeshLibrary meshes(bright);
    EXPECT_GT(apps::make_item(bright, meshes, 0, {}).clipped_counts, 0u);
}

}  // namespace
