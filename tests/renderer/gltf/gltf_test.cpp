// SPDX-License-Identifier: MIT
// Geometry, nodes, extras and cameras of glTF files.
#include "renderer/gltf/gltf.h"

#include "renderer/core/settings/json_file.h"
#include "tests/renderer/gltf/gltf_files.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace gltf_test;
using core::Vec3;
using renderer::SceneGeometry;

TEST(Gltf, BinaryAndTextFilesAgree) {
    const GltfFile file = square_file();
    const std::string path = temporary_path("scene.glb");
    write_bytes(path, file.binary());
    const SceneGeometry binary = renderer::load_gltf(path);
    const SceneGeometry text = file.load();
    ASSERT_EQ(binary.objects.size(), 1u);
    EXPECT_EQ(binary.objects[0].mesh.vertices, text.objects[0].mesh.vertices);
    EXPECT_EQ(binary.objects[0].mesh.triangles, text.objects[0].mesh.triangles);
}

TEST(Gltf, BuffersMayBeFilesBesideTheScene) {
    GltfFile file = square_file();
    file.json["buffers"] =
        Json::array({Json{{"byteLength", file.bytes.size()}, {"uri", "my%20buffer.bin"}}});
    write_bytes(temporary_path("my buffer.bin"), file.bytes);
    const std::string path = temporary_path("scene.gltf");
    write_bytes(path, file.json.dump());
    EXPECT_NEAR(total_area(renderer::load_gltf(path).objects[0].mesh), 1.0, 1e-12);
}

TEST(Gltf, StripsFansAndListsBecomeTheSameSquare) {
    GltfFile strip = square_file();
    const auto from_strip = strip.load().objects[0].mesh;
    EXPECT_EQ(from_strip.triangles.size(), 2u);
    EXPECT_NEAR(total_area(from_strip), 1.0, 1e-12);
    for (const auto& [a, b, c] : from_strip.triangles) {
        EXPECT_GT(core::triangle_area_vector(
                      from_strip.vertices[a], from_strip.vertices[b], from_strip.vertices[c])
                      .z(),
                  0.0);
    }

    GltfFile fan = square_file();
    fan.primitive()["mode"] = 6;
    fan.primitive()["indices"] =
        fan.add_accessor(std::vector<std::uint16_t>{0, 1, 3, 2}, kUShort, "SCALAR");
    EXPECT_EQ(fan.load().objects[0].mesh.triangles.size(), 2u);
    EXPECT_NEAR(total_area(fan.load().objects[0].mesh), 1.0, 1e-12);

    GltfFile list = square_file();
    list.primitive().erase("mode");
    list.primitive()["indices"] =
        list.add_accessor(std::vector<std::uint8_t>{0, 1, 2, 2, 1, 3}, kUByte, "SCALAR");
    EXPECT_NEAR(total_area(list.load().objects[0].mesh), 1.0, 1e-12);
}

TEST(Gltf, IndicesComeInThreeSizes) {
    for (const ComponentType type : {kUByte, kUShort, kUInt}) {
        GltfFile file = square_file();
        file.primitive()["mode"] = 4;
        if (type == kUByte) {
            file.primitive()["indices"] =
                file.add_accessor(std::vector<std::uint8_t>{1, 3, 2}, type, "SCALAR");
        } else if (type == kUShort) {
            file.primitive()["indices"] =
                file.add_accessor(std::vector<std::uint16_t>{1, 3, 2}, type, "SCALAR");
        } else {
            file.primitive()["indices"] =
                file.add_accessor(std::vector<std::uint32_t>{1, 3, 2}, type, "SCALAR");
        }
        const auto mesh = file.load().objects[0].mesh;
        ASSERT_EQ(mesh.triangles.size(), 1u);
        EXPECT_EQ(mesh.vertices.size(), 3u) << "the unused vertex is left out";
        EXPECT_EQ(mesh.vertices[mesh.triangles[0][0]], Vec3(1, 0, 0));
        EXPECT_EQ(mesh.vertices[mesh.triangles[0][1]], Vec3(1, 1, 0));
        EXPECT_EQ(mesh.vertices[mesh.triangles[0][2]], Vec3(0, 1, 0));
    }
}

TEST(Gltf, PrimitivesWithoutIndicesMayBeLists) {
    GltfFile file = square_file();
    file.primitive()["mode"] = 4;
    file.primitive()["attributes"]["POSITION"] =
        file.add_accessor(std::vector<float>{0, 0, 1, 2, 0, 1, 0, 2, 1}, kFloat, "VEC3");
    EXPECT_NEAR(total_area(file.load().objects[0].mesh), 2.0, 1e-12);
}

TEST(Gltf, InterleavedVerticesUseTheStride) {
    GltfFile file = square_file();
    std::vector<float> interleaved;
    const std::vector<float> positions = square_positions();
    for (std::size_t i = 0; i < 4; ++i) {
        interleaved.insert(interleaved.end(), {9.0f, 9.0f});
        interleaved.insert(
            interleaved.end(), positions.begin() + 3 * i, positions.begin() + 3 * i + 3);
    }
    const int view = file.add_view(interleaved);
    file.json["bufferViews"][view]["byteStride"] = 20;
    file.json["accessors"][0]["bufferView"] = view;
    file.json["accessors"][0]["byteOffset"] = 8;
    EXPECT_NEAR(total_area(file.load().objects[0].mesh), 1.0, 1e-12);
}

TEST(Gltf, QuantizedPositionsAndCoordinatesAreDecoded) {
    GltfFile file = square_file();
    file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    // Shorts, normalised: 32767 is 1. Two bytes of padding per vertex.
    const int view = file.add_view(std::vector<std::int16_t>{
        0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0, -32768, -32767, 0, 0});
    file.json["bufferViews"][view]["byteStride"] = 8;
    file.json["accessors"][0].update(
        {{"bufferView", view}, {"componentType", 5122}, {"normalized", true}});
    const int uv =
        file.add_accessor(std::vector<std::uint8_t>{0, 0, 255, 0, 0, 51, 255, 255}, kUByte, "VEC2");
    file.json["accessors"][uv]["normalized"] = true;
    file.primitive()["attributes"]["TEXCOORD_0"] = uv;
    const auto object = file.load().objects[0];
    EXPECT_EQ(object.mesh.vertices[1], Vec3(1, 0, 0));
    EXPECT_EQ(object.mesh.vertices[3], Vec3(-1, -1, 0)) << "the lowest value is clamped to -1";
    ASSERT_EQ(object.uv.size(), 4u);
    EXPECT_NEAR(object.uv[2].y(), 0.2, 1e-15);
}

TEST(Gltf, SparseAccessorsReplaceElements) {
    GltfFile file = square_file();
    const int indices = file.add_view(std::vector<std::uint16_t>{3, 1});
    const int values = file.add_view(std::vector<float>{2, 2, 0, 2, 0, 0});
    file.json["accessors"][0]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
        {"values", {{"bufferView", values}}}};
    // Corners (0,0) (2,0) (0,1) (2,2): triangles of area 1 and 2.
    EXPECT_NEAR(total_area(file.load().objects[0].mesh), 3.0, 1e-12);

    file.json["accessors"][0].erase("bufferView");
    file.json["accessors"][0]["sparse"]["count"] = 1;
    EXPECT_NE(error_of(file).find("no triangle with an area"), std::string::npos)
        << "without a view the others are zero";
}

TEST(Gltf, NodeTransformsNest) {
    GltfFile file = square_file();
    const double h = std::sqrt(0.5);
    file.json["nodes"] = Json::array(
        {Json{{"children", {1}}, {"translation", {10, 0, 0}}, {"rotation", {0, 0, h, h}}},
         Json{{"children", {2}}, {"scale", {2, 3, 1}}},
         Json{{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 5, 1}}}});
    const auto object = file.load().objects[0];
    // Corner (0,0,0): matrix to (1,0,5), scale to (2,0,5), quarter turn about z to (0,2,5).
    EXPECT_LT((object.mesh.vertices[0] - Vec3(10, 2, 5)).norm(), 1e-12);
    EXPECT_LT((object.world_from_node * Vec3(0, 1, 0) - Vec3(7, 2, 5)).norm(), 1e-12);
    EXPECT_NEAR(total_area(object.mesh), 6.0, 1e-12);
}

TEST(Gltf, FarTranslationsKeepSmallTriangles) {
    GltfFile file = square_file();
    file.json["nodes"][0]["translation"] = {1000000.25, -2000.5, 1000.125};
    file.json["nodes"][0]["scale"] = {1e-4, 1e-4, 1e-4};
    const auto object = file.load().objects[0];
    const auto& vertices = object.mesh.vertices;
    EXPECT_EQ(object.mesh.triangles.size(), 2u);
    EXPECT_EQ(vertices[0], Vec3(1000000.25, -2000.5, 1000.125));
    EXPECT_NEAR((vertices[1] - vertices[0]).norm(), 1e-4, 1e-9);
}

TEST(Gltf, MirroringTransformsKeepFrontFacesInFront) {
    GltfFile file = square_file();
    file.json["nodes"][0]["scale"] = {-1, 1, 1};
    const auto mesh = file.load().objects[0].mesh;
    for (const auto& [a, b, c] : mesh.triangles) {
        EXPECT_GT(
            core::triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]).z(),
            0.0);
    }
}

TEST(Gltf, InstancesBecomeObjects) {
    GltfFile file = square_file();
    file.json["nodes"] = Json::array({Json{{"mesh", 0}, {"name", "a"}},
                                      Json{{"mesh", 0}, {"name", "b"}, {"translation", {0, 0, 2}}},
                                      Json{{"mesh", 0}, {"name", "not in the scene"}}});
    file.json["scenes"][0]["nodes"] = {0, 1};
    const SceneGeometry geometry = file.load();
    ASSERT_EQ(geometry.objects.size(), 2u);
    EXPECT_EQ(geometry.objects[0].name, "a");
    EXPECT_EQ(geometry.objects[1].name, "b");
    EXPECT_EQ(geometry.objects[1].mesh.vertices[0].z(), 2.0);
}

TEST(Gltf, WithoutScenesAllRootsAreRead) {
    GltfFile file = square_file();
    file.json.erase("scenes");
    file.json.erase("scene");
    file.json["nodes"] = Json::array({Json{{"mesh", 0}, {"translation", {0, 0, 1}}},
                                      Json{{"children", {0}}},
                                      Json{{"mesh", 0}}});
    EXPECT_EQ(file.load().objects.size(), 2u);
}

TEST(Gltf, PointsAndLinesAreLeftOut) {
    GltfFile file = square_file();
    Json points = file.primitive();
    for (const int mode : {0, 1, 2, 3}) {
        points["mode"] = mode;
        file.json["meshes"][0]["primitives"].push_back(points);
    }
    EXPECT_EQ(file.load().objects.size(), 1u);
}

TEST(Gltf, TrianglesWithoutAreaAreDropped) {
    GltfFile file = square_file();
    file.primitive()["mode"] = 4;
    file.primitive()["indices"] =
        file.add_accessor(std::vector<std::uint16_t>{0, 1, 1, 0, 1, 2, 3, 3, 3}, kUShort, "SCALAR");
    EXPECT_EQ(file.load().objects[0].mesh.triangles.size(), 1u);
}

TEST(Gltf, ExtrasThatLookLikeOursAreRefused) {
    for (const auto& [found, wanted] : {std::pair{"velocity", "nlos_velocity_m_per_s"},
                                        std::pair{"velocity_m_per_s", "nlos_velocity_m_per_s"},
                                        std::pair{"nlos_velocity", "nlos_velocity_m_per_s"},
                                        std::pair{"role", "nlos_role"},
                                        std::pair{"retroreflective", "nlos_retroreflective"}}) {
        GltfFile file = square_file();
        file.json["nodes"][0]["extras"] = {{found, {1, 0, 0}}};
        const std::string error = error_of(file);
        EXPECT_NE(error.find(std::string("found ") + found), std::string::npos) << error;
        EXPECT_NE(error.find(std::string("must be ") + wanted), std::string::npos) << error;
    }
}

TEST(Gltf, ExtrasOfNodesWinOverThoseOfMaterials) {
    GltfFile file = square_file();
    file.primitive()["material"] = 0;
    file.json["materials"] = Json::array({Json{{"extras",
                                                {{"nlos_role", "back_wall"},
                                                 {"nlos_retroreflective", true},
                                                 {"nlos_ellipsoidal_exclude", true},
                                                 {"blender", 1}}}}});
    auto object = file.load().objects[0];
    EXPECT_EQ(object.role, renderer::Role::BackWall);
    EXPECT_EQ(object.material.model, renderer::model_of({.retroreflective = true}));
    EXPECT_TRUE(object.ellipsoidal_exclude);
    EXPECT_EQ(object.velocity_m_per_s, Vec3(0, 0, 0));

    file.json["nodes"][0]["extras"] = {{"nlos_role", "relay_wall"},
                                       {"nlos_retroreflective", false},
                                       {"nlos_velocity_m_per_s", {1, 2.5, -3}}};
    object = file.load().objects[0];
    EXPECT_EQ(object.role, renderer::Role::RelayWall);
    EXPECT_EQ(object.material.model, renderer::model_of({.metallic = true}));
    EXPECT_TRUE(object.ellipsoidal_exclude);
    EXPECT_EQ(object.velocity_m_per_s, Vec3(1, 2.5, -3));

    file.json["materials"][0]["extras"]["nlos_surface_model"] = "ggx dielectric";
    object = file.load().objects[0];
    EXPECT_EQ(object.material.model, renderer::model_of({.specular = true}));
    file.json["nodes"][0]["extras"]["nlos_surface_model"] = "velvet";
    const std::string error = error_of(file);
    EXPECT_NE(error.find("nlos_surface_model"), std::string::npos) << error;
    EXPECT_NE(error.find("ggx dielectric"), std::string::npos) << error;
}

TEST(Gltf, ExtrasReachDescendantsUntilOverridden) {
    GltfFile file = square_file();
    file.json["nodes"] =
        Json::array({Json{{"children", {1, 2}}, {"extras", {{"nlos_velocity_m_per_s", {0, 0, 1}}}}},
                     Json{{"mesh", 0}},
                     Json{{"mesh", 0}, {"extras", {{"nlos_velocity_m_per_s", {0, 0, 0}}}}}});
    const SceneGeometry geometry = file.load();
    EXPECT_EQ(geometry.objects[0].velocity_m_per_s, Vec3(0, 0, 1));
    EXPECT_EQ(geometry.objects[1].velocity_m_per_s, Vec3(0, 0, 0));
}

TEST(Gltf, PerspectiveCamerasAreRead) {
    GltfFile file = square_file();
    const double h = std::sqrt(0.5);
    file.json["cameras"] = Json::array(
        {Json{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.1}}}},
         Json{{"type", "orthographic"},
              {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 1}}}}});
    file.json["nodes"].push_back(
        {{"camera", 0}, {"name", "view"}, {"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}});
    file.json["nodes"].push_back({{"camera", 1}});
    file.json["scenes"][0]["nodes"] = {0, 1, 2};
    const SceneGeometry geometry = file.load();
    ASSERT_EQ(geometry.cameras.size(), 1u);
    EXPECT_EQ(geometry.cameras[0].name, "view");
    EXPECT_EQ(geometry.cameras[0].position, Vec3(1, 2, 3));
    EXPECT_LT((geometry.cameras[0].forward - Vec3(-1, 0, 0)).norm(), 1e-12);
    EXPECT_LT((geometry.cameras[0].up - Vec3(0, 1, 0)).norm(), 1e-12);
    EXPECT_EQ(geometry.cameras[0].fov_y_rad, 0.8);
}

}  // namespace
