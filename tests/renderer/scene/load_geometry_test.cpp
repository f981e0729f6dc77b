// SPDX-License-Identifier: MIT
#include "renderer/scene/load_geometry.h"

#include "renderer/core/settings/json_file.h"
#include "renderer/gltf/gltf.h"
#include "renderer/render.h"
#include "tests/renderer/mesh_file/mesh_texts.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using namespace mesh_file_test;
using test_support::TemporaryFolder;
using test_support::write_file_bytes;

/// A folder with one mesh in every format, and scenes that name them.
class LoadGeometry : public testing::Test {
 protected:
    LoadGeometry() {
        const core::TriangleMesh mesh = example_mesh();
        renderer::SceneGeometry geometry;
        geometry.objects.emplace_back();
        geometry.objects[0].name = "roof";
        geometry.objects[0].mesh = mesh;
        renderer::write_gltf(folder_.file("a.glb"), geometry);
        write_file_bytes(folder_.file("a.obj"), "o roof\n" + obj_text(mesh));
        write_file_bytes(folder_.file("a.ply"), ply_bytes(mesh, true));
        write_file_bytes(folder_.file("a.stl"), stl_bytes(mesh, true));
    }

    renderer::SceneDescription describe(core::Json scene) const {
        scene["scan"]["sensing_points"] = {4, 4};
        scene["time_axis"] = {{"opl_start_m", 0.8}, {"bin_width_m", 0.02}, {"num_bins", 64}};
        write_file_bytes(folder_.file("scene.json"), scene.dump());
        return renderer::read_scene_description(folder_.file("scene.json"), {});
    }

    std::vector<float> render(const core::Json& json) const {
        const renderer::SceneDescription description = describe(json);
        const core::Scan scan = renderer::make_scan(description);
        const renderer::Scene scene = renderer::load_scene(description, scan);
        const auto result = renderer::render(
            scene, scan, {description.time_axis, {}}, description.render, core::Progress());
        const auto values = result.capture.transient.values();
        return {values.begin(), values.end()};
    }

    const TemporaryFolder folder_;
};

TEST_F(LoadGeometry, EveryFormatRendersAsGltfDoes) {
    const std::vector<float> expected = render({{"geometry", "a.glb"}});
    const float largest = *std::max_element(expected.begin(), expected.end());
    ASSERT_GT(largest, 0.0f);
    for (const char* name : {"a.obj", "a.ply", "a.stl"}) {
        const std::vector<float> values = render({{"geometry", name}});
        ASSERT_EQ(values.size(), expected.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            ASSERT_NEAR(values[i], expected[i], 1e-6f * largest) << name;
        }
    }
}

TEST_F(LoadGeometry, MillimetresWithZUpRenderAsMetresWithYUp) {
    core::TriangleMesh mesh = example_mesh();
    for (core::Vec3& v : mesh.vertices) v = 1000.0 * core::Vec3(v.x(), -v.z(), v.y());
    write_file_bytes(folder_.file("cad.stl"), stl_bytes(mesh, true));
    const std::vector<float> expected = render({{"geometry", "a.glb"}});
    const std::vector<float> values =
        render({{"geometry", "cad.stl"}, {"geometry_unit_m", 0.001}, {"geometry_up", "z"}});
    const float largest = *std::max_element(expected.begin(), expected.end());
    for (std::size_t i = 0; i < values.size(); ++i) {
        ASSERT_NEAR(values[i], expected[i], 1e-5f * largest);
    }
}

TEST_F(LoadGeometry, ImplausibleSizesNameTheUnit) {
    const auto warnings = [&](double scale, core::Json scene) {
        core::TriangleMesh mesh = example_mesh();
        for (core::Vec3& v : mesh.vertices) v *= scale;
        write_file_bytes(folder_.file("scaled.obj"), obj_text(mesh));
        scene["geometry"] = "scaled.obj";
        return renderer::load_geometry(describe(scene)).warnings;
    };
    EXPECT_TRUE(warnings(1.0, {}).empty());
    EXPECT_TRUE(warnings(1000.0, {{"geometry_unit_m", 1.0}}).empty());
    for (const double scale : {1000.0, 100.0, 0.001}) {
        ASSERT_EQ(warnings(scale, {}).size(), 1U) << scale;
        EXPECT_NE(warnings(scale, {})[0].find("geometry_unit_m"), std::string::npos);
    }
}

TEST_F(LoadGeometry, WhatIsAssumedOfAFileIsSaid) {
    const auto said = [&](const core::Json& scene) {
        std::string all;
        for (const std::string& line : renderer::describe_frame(describe(scene)))
            all += line + "\n";
        return all;
    };
    EXPECT_EQ(said({{"geometry", "a.glb"}}), "");
    EXPECT_NE(said({{"geometry", "a.obj"}}).find("unit: 1 m (assumed"), std::string::npos);
    EXPECT_EQ(said({{"geometry", "a.obj"}, {"geometry_unit_m", 0.01}, {"geometry_up", "-z"}}),
              "unit: 0.01 m\nup: -z\n");
}

TEST_F(LoadGeometry, ObjectsTakeWhatTheSceneSaysOfThem) {
    const auto geometry = renderer::load_geometry(describe(
        {{"geometry", "a.obj"},
         {"objects",
          {{"roof",
            {{"role", "back_wall"}, {"albedo", 0.25}, {"velocity_m_per_s", {0, 0, 2}}}}}}}));
    const renderer::Object& roof = geometry.objects.at(0);
    EXPECT_EQ(roof.role, renderer::Role::BackWall);
    EXPECT_EQ(roof.material.albedo, 0.25);
    EXPECT_EQ(roof.velocity_m_per_s, core::Vec3(0, 0, 2));
    EXPECT_ERROR_WITH(renderer::load_geometry(describe(
                          {{"geometry", "a.obj"}, {"objects", {{"rof", {{"albedo", 1}}}}}})),
                      "objects.rof: is not in");
}

TEST_F(LoadGeometry, KeysOfMeshFilesAreChecked) {
    EXPECT_ERROR_WITH(describe({{"geometry", "a.glb"}, {"geometry_unit_m", 0.001}}),
                      "geometry_unit_m: found together with a.glb");
    EXPECT_ERROR_WITH(describe({{"geometry", "a.glb"}, {"geometry_up", "z"}}),
                      "geometry_up: found together with a.glb");
    EXPECT_ERROR_WITH(describe({{"geometry", "a.obj"}, {"geometry_unit_m", 0}}),
                      "geometry_unit_m: found 0; must be above 0");
    EXPECT_ERROR_WITH(describe({{"geometry", "a.obj"}, {"geometry_up", "up"}}), "x|-x|y|-y|z|-z");
    EXPECT_ERROR_WITH(describe({{"geometry", "a.obj"}, {"objects", {{"roof", {{"colour", 1}}}}}}),
                      "objects.roof.colour: found an unknown key");
    EXPECT_ERROR_WITH(describe({{"geometry", "a.obj"}, {"objects", {{"roof", {{"albedo", 2}}}}}}),
                      "objects.roof.albedo: found 2");
}

TEST_F(LoadGeometry, MeshesArePlacedByScaleThenRotationThenTranslation) {
    core::TriangleMesh mesh = example_mesh();
    for (core::Vec3& v : mesh.vertices) v *= 100.0;
    write_file_bytes(folder_.file("centimetres.obj"), "o a\n" + obj_text(mesh));
    const core::Json placed = {{"scale", 0.01},
                               {"rotation_deg", {90, 0, 90}},
                               {"translation_m", {0.1, 0.2, 0.3}},
                               {"mesh", "centimetres.obj"},
                               {"name", "chair"}};
    const auto geometry = renderer::load_geometry(describe({{"objects", {placed}}}));
    ASSERT_EQ(geometry.objects.size(), 1U);
    EXPECT_EQ(geometry.objects[0].name, "chair");
    const core::TriangleMesh original = example_mesh();
    for (std::size_t i = 0; i < original.vertices.size(); ++i) {
        const core::Vec3& v = original.vertices[i];
        // About x, y goes to z and z to -y; about z, x goes to y and y to -x.
        const core::Vec3 about_x(v.x(), -v.z(), v.y());
        const core::Vec3 about_z(-about_x.y(), about_x.x(), about_x.z());
        EXPECT_LT(
            (geometry.objects[0].mesh.vertices[i] - about_z - core::Vec3(0.1, 0.2, 0.3)).norm(),
            1e-6);  // the file's digits
    }
}

TEST_F(LoadGeometry, PlacedMeshesOfEveryFormatRenderAsOneGeometryDoes) {
    const std::vector<float> expected = render({{"geometry", "a.glb"}});
    const float largest = *std::max_element(expected.begin(), expected.end());
    for (const char* name : {"a.glb", "a.obj", "a.ply", "a.stl"}) {
        const std::vector<float> values = render({{"objects", {{{"mesh", name}}}}});
        ASSERT_EQ(values.size(), expected.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            ASSERT_NEAR(values[i], expected[i], 1e-6f * largest) << name;
        }
    }
}

TEST_F(LoadGeometry, PlacedMeshesStandBesideTheGeometry) {
    const auto geometry = renderer::load_geometry(describe(
        {{"geometry", "a.glb"},
         {"objects",
          {{{"mesh", "a.obj"}, {"translation_m", {0, 1, 0}}},
           {{"mesh", "a.obj"}, {"material", {{"surface", "ggx conductor"}, {"roughness", 0.3}}}},
           {{"name", "roof"}, {"albedo", 0.25}}}}}));
    ASSERT_EQ(geometry.objects.size(), 3U);
    EXPECT_EQ(geometry.objects[0].name, "roof");
    EXPECT_EQ(geometry.objects[0].material.albedo, 0.25);
    EXPECT_EQ(geometry.objects[1].name, "a");
    EXPECT_EQ(geometry.objects[2].name, "a_2");
    EXPECT_EQ(geometry.objects[2].material.model, renderer::model_of({.metallic = true}));
    EXPECT_EQ(geometry.objects[2].material.roughness, 0.3);
    const core::Vec3 apart =
        geometry.objects[1].mesh.vertices[0] - geometry.objects[2].mesh.vertices[0];
    EXPECT_LT((apart - core::Vec3(0, 1, 0)).norm(), 1e-12);
}

TEST_F(LoadGeometry, PlacedMeshesWithoutScaleNameAnImplausibleSize) {
    core::TriangleMesh mesh = example_mesh();
    for (core::Vec3& v : mesh.vertices) v *= 1000.0;
    write_file_bytes(folder_.file("scaled.obj"), obj_text(mesh));
    const auto warnings = [&](core::Json object) {
        object["mesh"] = "scaled.obj";
        return renderer::load_geometry(describe({{"objects", {object}}})).warnings;
    };
    EXPECT_TRUE(warnings({{"scale", 1.0}}).empty());
    ASSERT_EQ(warnings(core::Json::object()).size(), 1U);
    EXPECT_NE(warnings(core::Json::object())[0].find("scale gives another"), std::string::npos);
}

TEST_F(LoadGeometry, KeysOfPlacedMeshesAreChecked) {
    const auto load = [&](const core::Json& objects) {
        return renderer::load_geometry(describe({{"geometry", "a.glb"}, {"objects", objects}}));
    };
    const core::Json mesh = {{"mesh", "a.obj"}};
    const auto with = [&](const char* key, const core::Json& value) {
        core::Json object = mesh;
        object[key] = value;
        return core::Json::array({object});
    };
    EXPECT_ERROR_WITH(load(core::Json::array({{{"albedo", 1}}})),
                      "objects[0]: found no mesh and no name");
    EXPECT_ERROR_WITH(load({1}), "objects[0]");
    EXPECT_ERROR_WITH(load(core::Json::array({{{"name", "x"}}, {{"name", "x"}}})),
                      "objects[1].name: found \"x\" for the second time");
    EXPECT_ERROR_WITH(load(with("name", 3)), "objects[0].name");
    EXPECT_ERROR_WITH(load(with("name", "roof")), "objects.roof: has the name of an object");
    EXPECT_ERROR_WITH(load(with("scale", 0)), "objects.a.scale: found 0; must be above 0");
    EXPECT_ERROR_WITH(load(with("colour", 1)), "objects[0].colour: found an unknown key");
    EXPECT_ERROR_WITH(load(with("material", {{"albedo", 2}})),
                      "objects.a.material.albedo: found 2");
    EXPECT_ERROR_WITH(load(with("mesh", "nothing.obj")), "nothing.obj");
    EXPECT_ERROR_WITH(load({{"roof", {{"scale", 2}}}}), "objects.roof.scale: found without mesh");
    EXPECT_ERROR_WITH(load({{"b", {{"mesh", "a.glb"}, {"up", "z"}}}}), "objects.b.up: found with");
    EXPECT_ERROR_WITH(describe(core::Json::object()), "geometry: found nothing");
    EXPECT_ERROR_WITH(describe({{"objects", {{"roof", {{"albedo", 1}}}}}}),
                      "geometry: found nothing");
    EXPECT_ERROR_WITH(describe({{"objects", {mesh}}, {"geometry_up", "z"}}),
                      "geometry_up: found without geometry");
}

}  // namespace
