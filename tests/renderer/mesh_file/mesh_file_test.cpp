// SPDX-License-Identifier: MIT
#include "renderer/mesh_file/mesh_file.h"

#include "renderer/core/error.h"
#include "tests/renderer/mesh_file/mesh_texts.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace {

using namespace mesh_file_test;
using core::Vec3;
using renderer::FileAxis;
using test_support::TemporaryFolder;
using test_support::write_file_bytes;

renderer::SceneGeometry load_text(const std::string& name,
                                  const std::string& bytes,
                                  const renderer::MeshFrame& frame = {}) {
    const TemporaryFolder folder;
    write_file_bytes(folder.file(name), bytes);
    return renderer::load_mesh_file(folder.file(name), frame);
}

/// An OBJ file of one triangle with a material.
renderer::SceneGeometry load_with_material(const std::string& material) {
    const TemporaryFolder folder;
    write_file_bytes(folder.file("a.obj"),
                     "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\n");
    write_file_bytes(folder.file("a.mtl"), "newmtl paint\n" + material);
    return renderer::load_mesh_file(folder.file("a.obj"), {});
}

/// Each format, and the same mesh in it.
std::vector<std::pair<std::string, std::string>> examples() {
    const core::TriangleMesh mesh = example_mesh();
    return {{"a.obj", obj_text(mesh)},
            {"text.ply", ply_bytes(mesh, false)},
            {"binary.ply", ply_bytes(mesh, true)},
            {"text.stl", stl_bytes(mesh, false)},
            {"binary.STL", stl_bytes(mesh, true)}};
}

TEST(MeshFile, EveryFormatGivesTheSameTrianglesAndSharedVertices) {
    const core::TriangleMesh expected = example_mesh();
    for (const auto& [name, bytes] : examples()) {
        const auto geometry = load_text(name, bytes);
        ASSERT_EQ(geometry.objects.size(), 1U) << name;
        const renderer::Object& object = geometry.objects[0];
        EXPECT_EQ(object.mesh.vertices.size(), expected.vertices.size()) << name;
        ASSERT_EQ(object.mesh.triangles.size(), expected.triangles.size()) << name;
        for (std::size_t t = 0; t < expected.triangles.size(); ++t) {
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_EQ(object.mesh.vertices[object.mesh.triangles[t][c]],
                          expected.vertices[expected.triangles[t][c]])
                    << name;
            }
        }
        EXPECT_EQ(object.role, renderer::Role::Hidden);
        EXPECT_EQ(object.material.albedo, 1.0) << name;
        EXPECT_TRUE(geometry.warnings.empty()) << name;
        EXPECT_EQ(object.world_from_node.translation(), Vec3(0.0, 0.125, 0.625)) << name;
    }
}

TEST(MeshFile, UnitAndUpAxisPlaceTheFile) {
    const std::string triangle = "v 0 0 0\nv 1000 2000 3000\nv 1000 0 0\nf 1 2 3\n";
    const std::pair<FileAxis, Vec3> cases[]{{FileAxis::Y, {1, 2, 3}},
                                            {FileAxis::MinusY, {1, -2, -3}},
                                            {FileAxis::Z, {1, 3, -2}},
                                            {FileAxis::MinusZ, {1, -3, 2}},
                                            {FileAxis::X, {-2, 1, 3}},
                                            {FileAxis::MinusX, {2, -1, 3}}};
    for (const auto& [up, expected] : cases) {
        const auto geometry = load_text("a.obj", triangle, {0.001, up});
        EXPECT_LT((geometry.objects.at(0).mesh.vertices.at(1) - expected).norm(), 1e-6)
            << core::enum_name(up);
    }
}

TEST(MeshFile, ObjectsGroupsAndSolidsKeepTheirNames) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    const auto obj = load_text("a.obj", corners + "o chair\nf 1 2 3\ng table\nf 1 3 2\n");
    ASSERT_EQ(obj.objects.size(), 2U);
    EXPECT_EQ(obj.objects[0].name, "chair");
    EXPECT_EQ(obj.objects[1].name, "table");
    EXPECT_EQ(load_text("lamp.obj", corners + "f 1 2 3\n").objects.at(0).name, "lamp");
    EXPECT_EQ(load_text("a.ply", ply_bytes(example_mesh(), true)).objects.at(0).name, "a");
    EXPECT_EQ(load_text("a.stl", stl_bytes(example_mesh(), false)).objects.at(0).name, "roof");
    EXPECT_EQ(load_text("b.stl", stl_bytes(example_mesh(), true)).objects.at(0).name, "b");
}

TEST(MeshFile, NamesEndBeforeCommentsAndGoOnWithTheirObject) {
    const auto names = [](const std::string& text) {
        std::string all;
        for (const auto& object :
             load_text("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + text).objects) {
            all += object.name + ";";
        }
        return all;
    };
    EXPECT_EQ(names("o chair # a\nf 1 2 3\ng left leg # b\nf 1 2 3\n"), "chair;left leg;");
    EXPECT_EQ(names("o a\nf 1 2 3\no b\nf 1 2 3\no a\nf 1 2 3\n"), "a;b;a;");
    EXPECT_EQ(names("o a\ng x\nf 1 2 3\no b\ng x\nf 1 2 3\n"), "x;b;");
}

TEST(MeshFile, PolygonsBecomeTrianglesAndPointsAndLinesAreLeftOut) {
    const auto geometry = load_text("a.obj",
                                    "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.5 0\nv 0 2 0\n"
                                    "f 1 2 3 4 5\np 1\nl 1 2\n");
    const core::TriangleMesh& mesh = geometry.objects.at(0).mesh;
    EXPECT_EQ(mesh.triangles.size(), 3U);
    double area = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        area +=
            core::triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]).z();
    }
    EXPECT_NEAR(area, 2.5, 1e-6);  // the corner at (1, 0.5) points inwards
}

TEST(MeshFile, TrianglesWithoutAreaAreDropped) {
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\n";
    EXPECT_EQ(load_text("a.obj", corners + "f 1 2 3\nf 1 2 4\nf 1 1 2\n")
                  .objects.at(0)
                  .mesh.triangles.size(),
              1U);
    EXPECT_ERROR_WITH(load_text("a.obj", corners + "f 1 2 4\n"), "no triangles with an area");
    EXPECT_ERROR_WITH(load_text("a.obj", corners), "a.obj: ");
}

TEST(MeshFile, DiffuseColoursAreLinearAndCountAsTheirMean) {
    const auto painted = load_with_material("Kd 0.75 0.5 0.25\n").objects.at(0).material;
    EXPECT_EQ(painted.name, "paint");
    EXPECT_EQ(painted.model, renderer::model_of({}));
    EXPECT_EQ(painted.albedo, 0.5);
    EXPECT_EQ(load_with_material("Kd 0 0 0\n").objects.at(0).material.albedo, 0.0);

    const auto metal = load_with_material("Kd 0.5 0.5 0.5\nPm 1\nPr 0.25\n").objects.at(0).material;
    EXPECT_EQ(metal.model, renderer::model_of({.metallic = true}));
    EXPECT_EQ(metal.roughness, 0.25);

    EXPECT_EQ(load_with_material("\tKd\t.5 # grey\n").objects.at(0).material.albedo, 0.5);

    EXPECT_ERROR_WITH(load_with_material("Kd spectral a.rfl\n"), "a.mtl: line 2 has 'spectral'");
    EXPECT_ERROR_WITH(load_with_material("Kd nan 0 0\n"), "material paint: has the diffuse colour");
    EXPECT_ERROR_WITH(load_with_material("Kd 2 0 0\n"), "material paint: has the diffuse colour 2");
}

TEST(MeshFile, WhatMaterialsSayBeyondThatIsNamed) {
    const auto warnings = [](const std::string& material) {
        std::string all;
        for (const std::string& text : load_with_material(material).warnings) all += text + "\n";
        return all;
    };
    EXPECT_EQ(warnings("Kd 0.5 0.5 0.5\n"), "");
    EXPECT_NE(warnings("map_Kd a.png\n").find("material paint: its texture"), std::string::npos);
    EXPECT_NE(warnings("d 0.5\n").find("transparency"), std::string::npos);
    EXPECT_NE(warnings("Ke 1 1 1\n").find("emission"), std::string::npos);
}

TEST(MeshFile, MaterialsWithoutAColourAreWhite) {
    const auto missing =
        load_text("a.obj", "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\n");
    EXPECT_EQ(missing.objects.at(0).material.albedo, 1.0);
    ASSERT_EQ(missing.warnings.size(), 1U);
    EXPECT_NE(missing.warnings[0].find("gone.mtl is not beside it"), std::string::npos);
    EXPECT_EQ(load_with_material("newmtl other\nKd 0 0 0\n").objects.at(0).material.albedo, 1.0);
}

TEST(MeshFile, PipesAndFilesElsewhereAreNotOpened) {
    const TemporaryFolder folder;
    const TemporaryFolder elsewhere;
    ASSERT_EQ(::mkfifo(folder.file("pipe.mtl").c_str(), 0600), 0);
    write_file_bytes(elsewhere.file("other.mtl"), "newmtl paint\nKd 0 0 0\n");
    for (const std::string& name :
         {std::string("pipe.mtl"), elsewhere.file("other.mtl"), std::string("/dev/stdin")}) {
        write_file_bytes(folder.file("a.obj"),
                         "mtllib " + name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl paint\nf 1 2 3\n");
        const auto geometry = renderer::load_mesh_file(folder.file("a.obj"), {});
        EXPECT_EQ(geometry.objects.at(0).material.albedo, 1.0) << name;
    }
}

TEST(MeshFile, ColoursOfVerticesAreNamed) {
    const auto geometry = load_text("a.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                                    "property float y\nproperty float z\nproperty uchar red\n"
                                    "property uchar green\nproperty uchar blue\nelement face 1\n"
                                    "property list uchar int vertex_indices\nend_header\n"
                                    "0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2\n");
    ASSERT_EQ(geometry.warnings.size(), 1U);
    EXPECT_NE(geometry.warnings[0].find("colours of its vertices"), std::string::npos);
}

/// The file is accepted or refused in one line, and nothing else.
void expect_one_line(const std::string& path) {
    try {
        renderer::load_mesh_file(path, {});
    } catch (const core::Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    } catch (const core::Failure&) {  // a size that does not fit in memory
    }
}

TEST(MeshFile, FilesCutShortAreReadInPartOrRefusedInOneLine) {
    for (const auto& [name, bytes] : examples()) {
        const TemporaryFolder folder;
        constexpr std::size_t kPositions = 50;
        for (std::size_t i = 0; i < kPositions; ++i) {
            write_file_bytes(folder.file(name), bytes.substr(0, i * bytes.size() / kPositions));
            expect_one_line(folder.file(name));
        }
    }
}

TEST(MeshFile, FilesThatAreNoneAreNamed) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(renderer::load_mesh_file(folder.file("a.obj"), {}),
                      "a.obj: cannot be opened");
    ASSERT_EQ(::mkfifo(folder.file("pipe.stl").c_str(), 0600), 0);
    EXPECT_ERROR_WITH(renderer::load_mesh_file(folder.file("pipe.stl"), {}), "is no regular file");
    EXPECT_ERROR_WITH(load_text("a.ply", "hello\n"), "a.ply: is no PLY file");
    EXPECT_ERROR_WITH(load_text("a.stl", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "a.stl: ");
}

}  // namespace
