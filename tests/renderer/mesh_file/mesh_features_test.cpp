// SPDX-License-Identifier: MIT
// Every feature of OBJ, PLY and STL that changes where surfaces are or how much light they return,
// in a file that uses it: it is applied, refused or named. Damaged files:
// mesh_file_faults_test.cpp.
#include "renderer/core/error.h"
#include "renderer/mesh_file/mesh_file.h"
#include "tests/renderer/mesh_file/mesh_texts.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace {

using namespace mesh_file_test;
using core::Vec3;

/// What is seen of a file: its area, the sum of its vertices by triangles, and its albedo.
struct MeshLook {
    double area_m2 = 2.0;
    Vec3 center{1.0, 0.5, 0.0};
    double albedo = 1.0;
};

struct MeshExample {
    std::string feature;
    std::string name;
    std::string bytes;
    MeshLook look{};
    std::string named{};    ///< a part of the warning; empty: it is applied, without a word
    std::string refused{};  ///< a part of the refusal
    std::string mtl{};      ///< of a.mtl beside it
};

/// By area, so that it does not depend on how a polygon is cut.
MeshLook look_of_mesh(const renderer::SceneGeometry& geometry) {
    MeshLook look{0.0, Vec3::Zero(), 0.0};
    for (const renderer::Object& object : geometry.objects) {
        for (const auto& triangle : object.mesh.triangles) {
            const auto corner = [&](std::size_t i) { return object.mesh.vertices[triangle[i]]; };
            const double area = core::triangle_area_vector(corner(0), corner(1), corner(2)).norm();
            look.area_m2 += area;
            look.center += area / 3.0 * (corner(0) + corner(1) + corner(2));
            look.albedo += area * object.material.albedo;
        }
    }
    look.center /= look.area_m2;
    look.albedo /= look.area_m2;
    return look;
}

void check(const std::vector<MeshExample>& examples) {
    for (const MeshExample& example : examples) {
        SCOPED_TRACE(example.name + ": " + example.feature);
        const test_support::TemporaryFolder folder;
        const std::string path = folder.file(example.name);
        test_support::write_file_bytes(path, example.bytes);
        test_support::write_file_bytes(folder.file("a.mtl"), "newmtl paint\n" + example.mtl);
        if (!example.refused.empty()) {
            EXPECT_ERROR_WITH(renderer::load_mesh_file(path, {}), example.refused);
            continue;
        }
        const renderer::SceneGeometry geometry = renderer::load_mesh_file(path, {});
        const MeshLook seen = look_of_mesh(geometry);
        EXPECT_NEAR(seen.area_m2, example.look.area_m2, 1e-9);
        EXPECT_LT((seen.center - example.look.center).norm(), 1e-6) << seen.center.transpose();
        EXPECT_NEAR(seen.albedo, example.look.albedo, 1e-9);
        if (example.named.empty()) {
            EXPECT_TRUE(geometry.warnings.empty()) << geometry.warnings[0];
        } else {
            ASSERT_EQ(geometry.warnings.size(), 1U);
            EXPECT_NE(geometry.warnings[0].find(example.named), std::string::npos)
                << geometry.warnings[0];
        }
    }
}

const std::string kVertices = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\n";

MeshExample obj(const char* feature,
                const std::string& text,
                const char* named = "",
                MeshLook look = {}) {
    return {feature, "a.obj", text, look, named};
}

/// The rectangle of a material with these lines.
MeshExample mtl(const char* feature,
                const char* lines,
                const char* named = "",
                MeshLook look = {}) {
    return {feature,
            "a.obj",
            "mtllib a.mtl\nusemtl paint\n" + kVertices + "f 1 2 3 4\n",
            look,
            named,
            "",
            lines};
}

TEST(MeshFeatures, OfObjAreAppliedRefusedOrNamed) {
    const std::string& v = kVertices;
    const std::string rectangle = v + "f 1 2 3 4\n";
    check({
        obj("v, f", v + "f 1 2 3\nf 1 3 4\n"),
        obj("polygons", rectangle),
        obj("dents", v + "v .5 .5 0\nf 1 2 3 5 4\n", "", {1.5, {1.0 + 1.0 / 18.0, 7.0 / 18.0, 0}}),
        obj("weights", "v 0 0 0\nv 2 0 0\nv 4 2 0 2\nv 0 1 0\nf 1 2 3 4\n"),
        obj("indices below 0", v + "f -4 -3 -2 -1\n"),
        obj("faces first", "f 1 2 3 4\n" + v),
        obj("leading dots, comments, a byte order mark",
            "\xef\xbb\xbfv .0 -.0 +.0 # a\nv 2. 0 0\nv 2 1 0 #b\nv 0 1 0\nf 1 2 3 4 # c\n"),
        obj("fo", v + "fo 1 2 3 4\n"),
        obj("o and g", v + "o a\nf 1 2 3\ng b\nf 1 3 4\n"),
        obj("vt, vn, s, l, p", rectangle + "vt 0 0\nvn 0 1 0\ns 1\nl 1 2\np 1\n"),
        obj("colours of vertices",
            "v 0 0 0 .5 .5 .5\nv 2 0 0 0 0 0\nv 2 1 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3 4\n",
            "the colours of its vertices are not modelled"),
        obj("curves", rectangle + "curv 0 1 1 2\n", "its lines of 'curv' are not modelled"),
        obj("surfaces", rectangle + "surf 0 1 0 1 1\n", "its lines of 'surf' are not modelled"),
        obj("usemap", rectangle + "usemap a.mpc\n", "its lines of 'usemap' are not modelled"),
        obj("mtllib that is missing", "mtllib b.mtl\n" + rectangle, "b.mtl is not beside it"),
        {"vertices that are not finite", "a.obj", rectangle + "v 0 nan 0\n", {}, "", "not finite"},
    });
}

TEST(MeshFeatures, OfMtlAreAppliedOrNamed) {
    const Vec3 middle = MeshLook().center;
    check({
        mtl("Kd", "Kd 0.2 0.4 0.6\n", "", {2.0, middle, 0.4}),
        mtl("Pm, Pr", "Kd 0.5\nPm 1\nPr 0.3\n", "", {2.0, middle, 0.5}),
        mtl("Ka, Ni, illum", "Ka 1 1 1\nNi 1.5\nillum 2\nd 1\nTr 0\nKs 0 0 0\nKe 0 0 0\nNs 9\n"),
        mtl("Ks", "Ks 0.5 0.5 0.5\n", "its highlight (Ks) is not modelled"),
        mtl("map_Ks", "map_Ks a.png\n", "its highlight (Ks) is not modelled"),
        mtl("Ke", "Ke 0 0 1\n", "its emission is not modelled"),
        mtl("map_Ke", "map_Ke a.png\n", "its emission is not modelled"),
        mtl("d", "d 0.5\n", "its transparency is not modelled"),
        mtl("Tr", "Tr 0.5\n", "its transparency is not modelled"),
        mtl("map_d", "map_d a.png\n", "its transparency is not modelled"),
        mtl("map_Kd", "map_Kd a.png\n", "its texture is not modelled"),
        mtl("map_Pr", "map_Pr a.png\n", "roughness and metal are not modelled"),
        mtl("map_Bump", "map_Bump -bm 1 a.png\n", "its bumps are not modelled"),
        mtl("norm", "norm a.png\n", "its bumps are not modelled"),
        mtl("Pc", "Pc 1\n", "its coat or sheen is not modelled"),
        mtl("Ps", "Ps 1\n", "its coat or sheen is not modelled"),
    });
}

MeshExample ply(const char* feature,
                const std::string& vertex_properties,
                const std::string& vertex_values,
                const std::string& faces,
                const std::string& face_values,
                const char* named = "") {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\n" +
        vertex_properties + faces + "end_header\n";
    for (const char* corner : {"0 0 0", "2 0 0", "2 1 0", "0 1 0"}) {
        text += corner + vertex_values + "\n";
    }
    return {feature, "a.ply", text + face_values, {}, named};
}

TEST(MeshFeatures, OfPlyAreAppliedOrNamed) {
    const std::string list = "property list uchar int vertex_indices\n";
    const std::string faces = "element face 1\n" + list;
    const std::string red = "property uchar red\n";
    check({
        ply("faces", "", "", faces, "4 0 1 2 3\n"),
        ply("tristrips", "", "", "element tristrips 1\n" + list, "9 0 1 3 -1 1 2 3 -1 0\n"),
        ply("vertex_index",
            "",
            "",
            "element face 1\nproperty list int uint vertex_index\n",
            "4 0 1 2 3\n"),
        ply("normals, texture coordinates",
            "property float nx\nproperty float ny\nproperty float nz\nproperty float s\n",
            " 0 0 1 .5",
            faces,
            "4 0 1 2 3\n"),
        ply("edges", "", "", faces + "element edge 1\nproperty int vertex1\n", "4 0 1 2 3\n1\n"),
        ply("colours of vertices",
            red,
            " 9",
            faces,
            "4 0 1 2 3\n",
            "the colours of its vertices are not modelled"),
        ply("colours of faces",
            "",
            "",
            faces + red,
            "4 0 1 2 3 9\n",
            "the colours of its faces are not modelled"),
        ply("a texture",
            "",
            "",
            "comment TextureFile a.png\n" + faces,
            "4 0 1 2 3\n",
            "its texture is not modelled"),
    });
}

std::string stl_of_two(const char* header, unsigned attributes) {
    core::TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    std::string bytes = stl_bytes(mesh, true);
    bytes.replace(0, std::strlen(header), header);
    bytes[bytes.size() - 1] = static_cast<char>(attributes >> 8);
    return bytes;
}

TEST(MeshFeatures, OfStlAreAppliedOrNamed) {
    const char* const colours = "the colours of its vertices are not modelled";
    std::string text = "solid a\n";
    for (const char* corners :
         {"vertex 0 0 0 vertex 2 0 0 vertex 2 1 0", "vertex 0 0 0 vertex 2 1 0 vertex 0 1 0"}) {
        text += std::string("facet normal 0 0 1 outer loop ") + corners + " endloop endfacet\n";
    }
    check({
        {"binary", "a.stl", stl_of_two("", 0)},
        {"text", "a.stl", text + "endsolid a\n"},
        {"colours of facets", "a.stl", stl_of_two("", 0x8000), {}, colours},
        {"a colour of all", "a.stl", stl_of_two("COLOR=abcd", 0), {}, colours},
    });
}

}  // namespace
