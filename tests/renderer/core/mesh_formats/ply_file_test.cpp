// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/mesh_formats/ply_writer.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace core {
namespace {

using test_support::TemporaryFolder;

TriangleMesh example_mesh() {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.25, -2}};
    mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
    return mesh;
}

TriangleMesh read_text(const std::string& text) {
    const TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("a.ply"), text);
    return read_mesh_file(folder.file("a.ply")).mesh;
}

TEST(PlyFile, PointCloudsSurviveTheRoundTrip) {
    const TemporaryFolder folder;
    PointCloud points{example_mesh().vertices, example_mesh().normals};
    write_ply(folder.file("a.ply"), points);
    TriangleMesh read = read_mesh_file(folder.file("a.ply")).mesh;
    EXPECT_EQ(read.vertices, points.positions);
    EXPECT_EQ(read.normals, points.normals);
    EXPECT_TRUE(read.triangles.empty());

    points.normals.clear();
    write_ply(folder.file("a.ply"), points);
    read = read_mesh_file(folder.file("a.ply")).mesh;
    EXPECT_EQ(read.vertices, points.positions);
    EXPECT_TRUE(read.normals.empty());
}

TEST(PlyFile, MeshesSurviveTheRoundTrip) {
    const TemporaryFolder folder;
    write_ply(folder.file("a.ply"), example_mesh());
    const TriangleMesh read = read_mesh_file(folder.file("a.ply")).mesh;
    EXPECT_EQ(read.vertices, example_mesh().vertices);
    EXPECT_EQ(read.normals, example_mesh().normals);
    EXPECT_EQ(read.triangles, example_mesh().triangles);
}

TEST(PlyFile, PlacesFarFromTheOriginSurviveTheRoundTrip) {
    TriangleMesh mesh = example_mesh();
    for (auto& vertex : mesh.vertices) vertex += core::Vec3(1e6 / 3.0, -1e6, 7e5);
    const TemporaryFolder folder;
    write_ply(folder.file("a.ply"), mesh);
    EXPECT_EQ(read_mesh_file(folder.file("a.ply")).mesh.vertices, mesh.vertices);
}

TEST(PlyFile, EmptyCloudsSurviveTheRoundTrip) {
    const TemporaryFolder folder;
    write_ply(folder.file("a.ply"), PointCloud{});
    EXPECT_TRUE(read_mesh_file(folder.file("a.ply")).mesh.vertices.empty());
}

TEST(PlyFile, TextFilesWithPolygonsAndOtherPropertiesAreRead) {
    const TriangleMesh mesh = read_text(
        "ply\r\nformat ascii 1.0\r\ncomment by hand\r\nelement vertex 4\r\nproperty double x\r\n"
        "property uchar red\r\nproperty double y\r\nproperty float32 z\r\nelement extra 1\r\n"
        "property list uchar int numbers\r\nelement face 1\r\nproperty list uint8 int32 "
        "vertex_index\r\n"
        "property float quality\r\nend_header\r\n"
        "0 255 0 1\r\n1 255 0 1\r\n1 255 1 1\r\n-1e-1 255 1 1\r\n3 7 8 9\r\n4 0 1 2 3 0.5\r\n");
    ASSERT_EQ(mesh.vertices.size(), 4U);
    EXPECT_EQ(mesh.vertices[3], Vec3(-0.1, 1, 1));
    const std::vector<std::array<std::uint32_t, 3>> fan{{0, 1, 2}, {0, 2, 3}};
    EXPECT_EQ(mesh.triangles, fan);
}

TEST(PlyFile, BinaryDoublesAreRead) {
    const double vertex[]{0.1, 0.2, 0.3};
    const std::string body(reinterpret_cast<const char*>(vertex), sizeof(vertex));
    const TriangleMesh mesh = read_text(
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\n"
        "property double y\nproperty double z\nend_header\n" +
        body);
    EXPECT_EQ(mesh.vertices.at(0), Vec3(0.1, 0.2, 0.3));
}

TEST(PlyFile, NormalsThatAreNotFiniteAreLeftOut) {
    const TriangleMesh mesh = read_text(
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
        "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
        "0 0 0 0 0 1\n1 0 0 nan nan nan\n");
    EXPECT_EQ(mesh.vertices.size(), 2U);
    EXPECT_TRUE(mesh.normals.empty());
}

TEST(PlyFile, DamagedFilesAreNamed) {
    const std::string vertex = "element vertex 1\nproperty float x\nproperty float y\n";
    const std::string head = "ply\nformat ascii 1.0\n" + vertex;
    EXPECT_ERROR_WITH(read_mesh_file("/no/such.ply"), "/no/such.ply: cannot be opened");
    EXPECT_ERROR_WITH(read_text("hello\n"), "is no PLY file");
    EXPECT_ERROR_WITH(read_text("ply\nformat ascii 1.0\n"), "is cut short");
    EXPECT_ERROR_WITH(read_text("ply\nformat binary 1.0\nend_header\n"), "has format 'binary'");
    EXPECT_ERROR_WITH(read_text("ply\nelement vertex 1\nend_header\n"), "does not say its format");
    EXPECT_ERROR_WITH(read_text(head + "end_header\n0 0\n"), "without x, y, z");
    EXPECT_ERROR_WITH(read_text(head + "property half z\nend_header\n"), "unknown type 'half'");
    EXPECT_ERROR_WITH(read_text(head + "property float z\nend_header\n0 0\n"), "is cut short");
    EXPECT_ERROR_WITH(read_text(head + "property float z\nend_header\n0 nan 0\n"), "not finite");
    EXPECT_ERROR_WITH(read_text(head + "property float z\nend_header\n0 a 0\n"), "no number");
    EXPECT_ERROR_WITH(read_text(head + "property float z\nelement face 1\nproperty list uchar int "
                                       "vertex_indices\nend_header\n0 0 0\n3 0 0 1\n"),
                      "has a face with vertex 1");
    EXPECT_ERROR_WITH(read_text("ply\nformat binary_little_endian 1.0\nelement vertex "
                                "9000000000000000000\nproperty float x\nproperty float y\n"
                                "property float z\nend_header\n"),
                      "is cut short");
}

TEST(PlyFile, EveryTruncationIsReported) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.ply");
    write_ply(path, example_mesh());
    const std::string bytes = test_support::file_bytes(path);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        test_support::write_file_bytes(path, bytes.substr(0, length));
        EXPECT_ERROR_WITH(read_mesh_file(path), path) << length;
    }
}

}  // namespace
}  // namespace core
