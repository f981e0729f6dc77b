// SPDX-License-Identifier: MIT
#include "tests/renderer/gltf/gltf_files.h"

#include <cmath>

namespace {

using core::Vec3;
using gltf_test::error_of;
using gltf_test::GltfFile;
using gltf_test::Json;
using gltf_test::kFloat;
using gltf_test::kUByte;
using Floats = std::vector<float>;

void expect_vertices(const renderer::Object& object, const std::vector<Vec3>& expected) {
    ASSERT_EQ(object.mesh.vertices.size(), expected.size());
    for (std::size_t v = 0; v < expected.size(); ++v) {
        EXPECT_LT((object.mesh.vertices[v] - expected[v]).norm(), 1e-6)
            << object.mesh.vertices[v].transpose();
    }
}

/// A square whose left edge belongs to one joint and whose right edge to another, which stands at
/// x = 1 and turns about y by a right angle; the node itself is moved, which does not count.
GltfFile skinned_file() {
    GltfFile file = gltf_test::square_file();
    auto& attributes = file.primitive()["attributes"];
    attributes["JOINTS_0"] = file.add_accessor(
        std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}, kUByte, "VEC4");
    attributes["WEIGHTS_0"] =
        file.add_accessor(Floats{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, kFloat, "VEC4");
    file.json["nodes"] = Json::parse(R"([
        {"mesh": 0, "skin": 0, "translation": [7, 7, 7]},
        {"children": [2], "translation": [0, 0, 3]},
        {"translation": [1, 0, 0], "rotation": [0, 0.70710678, 0, 0.70710678]}])");
    file.json["scenes"][0]["nodes"] = {0, 1};
    const int matrices = file.add_accessor(Floats{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                           kFloat,
                                           "MAT4");
    file.json["skins"] = Json::array({Json{{"joints", {1, 2}}, {"inverseBindMatrices", matrices}}});
    return file;
}

TEST(GltfPose, JointsCarryVerticesAndTheNodeDoesNot) {
    const auto geometry = skinned_file().load();
    expect_vertices(geometry.objects[0], {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}, {1, 1, 3}});
}

TEST(GltfPose, WithoutInverseBindMatricesVerticesAreInTheJointsFrames) {
    GltfFile file = skinned_file();
    file.json["skins"][0].erase("inverseBindMatrices");
    const auto geometry = file.load();
    // A right angle about y takes x to -z.
    expect_vertices(geometry.objects[0], {{0, 0, 3}, {1, 0, 2}, {0, 1, 3}, {1, 1, 2}});
}

TEST(GltfPose, WeightsBlendAndNeedNotAddUpToOne) {
    GltfFile file = skinned_file();
    file.json["skins"][0].erase("inverseBindMatrices");
    file.primitive()["attributes"]["JOINTS_0"] = file.add_accessor(
        std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, kUByte, "VEC4");
    file.primitive()["attributes"]["WEIGHTS_0"] = file.add_accessor(
        Floats{1, 1, 0, 0, 2, 2, 0, 0, 3, 1, 0, 0, 0.5f, 0.5f, 0, 0}, kFloat, "VEC4");
    const auto geometry = file.load();
    expect_vertices(geometry.objects[0], {{0.5, 0, 3}, {1, 0, 2.5}, {0.25, 1, 3}, {1, 1, 2.5}});
}

TEST(GltfPose, SkinsThatCannotBeAreRefused) {
    GltfFile far = skinned_file();
    far.json["scenes"][0]["nodes"] = {0};
    EXPECT_NE(error_of(far).find("skins[0].joints: names node 1, which is not in the scene"),
              std::string::npos);
    GltfFile few = skinned_file();
    few.json["skins"][0]["joints"] = {1};
    EXPECT_NE(error_of(few).find("nodes[0]: has a vertex of joint 1; its skin has 1 joints"),
              std::string::npos);
    GltfFile without = skinned_file();
    without.primitive()["attributes"].erase("WEIGHTS_0");
    EXPECT_NE(error_of(without).find("without JOINTS_0 and WEIGHTS_0"), std::string::npos);
    GltfFile index = skinned_file();
    index.json["nodes"][0]["skin"] = 1;
    EXPECT_NE(error_of(index).find("nodes[0].skin: found 1"), std::string::npos);
    GltfFile weightless = skinned_file();
    weightless.primitive()["attributes"]["WEIGHTS_0"] =
        weightless.add_accessor(Floats(16, 0.0f), kFloat, "VEC4");
    EXPECT_NE(error_of(weightless).find("belongs to no joint"), std::string::npos);
}

TEST(GltfPose, MorphTargetsAddUpBeforeTheNodeMovesThem) {
    GltfFile file = gltf_test::square_file();
    const int up = file.add_accessor(Floats{0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0}, kFloat, "VEC3");
    const int wide = file.add_accessor(Floats{0, 0, 0, 2, 0, 0, 0, 0, 0, 2, 0, 0}, kFloat, "VEC3");
    file.primitive()["targets"] = Json::array({Json{{"POSITION", up}}, Json{{"POSITION", wide}}});
    file.json["nodes"][0]["weights"] = {0.5, 0.25};
    file.json["nodes"][0]["scale"] = {1, 1, 2};
    const auto geometry = file.load();
    expect_vertices(geometry.objects[0], {{0, 0, 1}, {1.5, 0, 1}, {0, 1, 0}, {1.5, 1, 0}});
}

TEST(GltfPose, InstancesAreScaledTurnedAndMovedWithinTheirNode) {
    GltfFile file = gltf_test::square_file();
    const auto half = static_cast<float>(std::sqrt(0.5));
    const auto list = [&](const char* name) -> Json& {
        return file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][name];
    };
    list("TRANSLATION") = file.add_accessor(Floats{0, 0, 0, 0, 0, 4}, kFloat, "VEC3");
    list("ROTATION") = file.add_accessor(Floats{0, 0, 0, 1, 0, 0, half, half}, kFloat, "VEC4");
    list("SCALE") = file.add_accessor(Floats{1, 1, 1, 3, 1, 1}, kFloat, "VEC3");
    file.json["nodes"][0]["translation"] = {10, 0, 0};
    const auto geometry = file.load();
    ASSERT_EQ(geometry.objects.size(), 2U);
    expect_vertices(geometry.objects[0], {{10, 0, 0}, {11, 0, 0}, {10, 1, 0}, {11, 1, 0}});
    expect_vertices(geometry.objects[1], {{10, 0, 4}, {10, 3, 4}, {9, 0, 4}, {9, 3, 4}});

    list("SCALE") = file.add_accessor(Floats{1, 1, 1}, kFloat, "VEC3");
    EXPECT_NE(error_of(file).find("must be as many"), std::string::npos);
}

TEST(GltfPose, HiddenNodesHideThoseBelowThem) {
    GltfFile file = gltf_test::square_file();
    file.json["nodes"] = Json::parse(R"([
        {"children": [1], "extensions": {"KHR_node_visibility": {"visible": false}}},
        {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}},
        {"mesh": 0, "name": "seen"}])");
    file.json["scenes"][0]["nodes"] = {0, 2};
    const auto geometry = file.load();
    ASSERT_EQ(geometry.objects.size(), 1U);
    EXPECT_EQ(geometry.objects[0].name, "seen");
}

TEST(GltfPose, ColoursOfVerticesAreWrittenAndReadAgain) {
    GltfFile file = gltf_test::square_file();
    file.primitive()["attributes"]["COLOR_0"] = file.add_accessor(
        Floats{1, 1, 1, 0.5f, 0.5f, 0.5f, 0.25f, 0.25f, 0.25f, 0, 0, 0}, kFloat, "VEC3");
    const auto geometry = file.load();
    const std::vector<double> expected{1.0, 0.5, 0.25, 0.0};
    EXPECT_EQ(geometry.objects[0].vertex_albedo, expected);
    const std::string path = gltf_test::temporary_path("colours.glb");
    renderer::write_gltf(path, geometry);
    EXPECT_EQ(renderer::load_gltf(path).objects[0].vertex_albedo, expected);
}

}  // namespace
