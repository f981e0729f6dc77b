// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"

#include "renderer/core/settings/json_file.h"
#include "renderer/gltf/gltf.h"
#include "tests/renderer/gltf/gltf_files.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace {

using core::Vec3;
using gltf_test::read_bytes;

const std::string kScenes = std::string(NLOS_SOURCE_DIR) + "/scenes";

TEST(GeneratedScenes, CommittedFilesAreWhatTheGeneratorWrites) {
    for (const auto& scene : scenes::generated_scenes()) {
        const std::string folder = gltf_test::temporary_path("scenes");
        std::filesystem::create_directories(folder + "/" + scene.name);
        scenes::write_scene(scene, folder);
        for (const char* file : {"/scene.glb", "/scene.json"}) {
            const std::string written = folder + "/" + scene.name + file;
            if (!std::filesystem::exists(written)) continue;
            EXPECT_TRUE(read_bytes(written) == read_bytes(kScenes + "/" + scene.name + file))
                << written << " differs; run generate_scenes";
        }
    }
}

TEST(GeneratedScenes, TwoRunsGiveTheSameBytes) {
    for (const std::string run : {"first", "second"}) {
        const std::string folder = gltf_test::temporary_path(run);
        std::filesystem::create_directories(folder + "/bars");
        scenes::write_scene(scenes::make_bars(), folder);
    }
    EXPECT_TRUE(read_bytes(gltf_test::temporary_path("first") + "/bars/scene.glb") ==
                read_bytes(gltf_test::temporary_path("second") + "/bars/scene.glb"));
}

TEST(GeneratedScenes, FilesHoldExactlyTheGeneratedGeometry) {
    for (const auto& scene : scenes::generated_scenes()) {
        const auto read = renderer::load_gltf(kScenes + "/" + scene.name + "/scene.glb");
        ASSERT_EQ(read.objects.size(), scene.geometry.objects.size()) << scene.name;
        for (std::size_t i = 0; i < read.objects.size(); ++i) {
            EXPECT_EQ(read.objects[i].mesh.vertices, scene.geometry.objects[i].mesh.vertices);
            EXPECT_EQ(read.objects[i].mesh.triangles, scene.geometry.objects[i].mesh.triangles);
            EXPECT_EQ(read.objects[i].role, scene.geometry.objects[i].role);
        }
        EXPECT_LT(std::filesystem::file_size(kScenes + "/" + scene.name + "/scene.glb"), 500000u);
    }
}

TEST(GeneratedScenes, TheLetterFacesTheWallAndReadsFromThere) {
    const auto letter = scenes::make_letter().geometry.objects.at(0);
    double area = 0.0;
    double right_of_centre_above = 0.0;
    for (const auto& [a, b, c] : letter.mesh.triangles) {
        const auto& v = letter.mesh.vertices;
        const Vec3 area_vector = core::triangle_area_vector(v[a], v[b], v[c]);
        EXPECT_LT(area_vector.z(), 0.0);
        area += area_vector.norm();
        const Vec3 centre = (v[a] + v[b] + v[c]) / 3.0;
        EXPECT_NEAR(centre.z(), 0.7, 1e-12);
        // Seen from the wall, right is -x: the arms of an F stand out to the right, above.
        if (centre.x() < 0.0 && centre.y() > 0.0) right_of_centre_above += area_vector.norm();
        EXPECT_FALSE(centre.x() < 0.0 && centre.y() < -0.1);
    }
    EXPECT_NEAR(area, 0.12 * 0.6 + 0.28 * 0.12 + 0.2 * 0.12, 1e-6);
    EXPECT_GT(right_of_centre_above, 0.02);
}

TEST(GeneratedScenes, TheBarsHideAClosedFineMesh) {
    const auto animal = scenes::make_bars().geometry.objects.at(0);
    EXPECT_GE(animal.mesh.triangles.size(), 5000u);
    Vec3 sum = Vec3::Zero();
    double volume = 0.0;
    for (const auto& [a, b, c] : animal.mesh.triangles) {
        const auto& v = animal.mesh.vertices;
        const Vec3 origin = animal.world_from_node.translation();
        sum += core::triangle_area_vector(v[a], v[b], v[c]);
        volume += (v[a] - origin).dot((v[b] - origin).cross(v[c] - origin)) / 6.0;
    }
    EXPECT_LT(sum.norm(), 1e-9) << "area vectors of a closed surface cancel";
    EXPECT_GT(volume, 4.0 / 3.0 * core::kPi * 0.1 * 0.1 * 0.1) << "facing outwards";
}

TEST(GeneratedScenes, CurvedSensingPointsLieOnTheWallsFacets) {
    const auto description = core::read_json_file(kScenes + "/curved/scene.json");
    const auto& points = description["scan"]["sensing_points_m"];
    const auto& normals = description["scan"]["sensing_normals"];
    ASSERT_EQ(points.size(), 1024u);
    ASSERT_EQ(normals.size(), 1024u);
    const auto wall = renderer::load_gltf(kScenes + "/curved/scene.glb").objects.at(0);
    ASSERT_EQ(wall.role, renderer::Role::RelayWall);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 point(points[i][0], points[i][1], points[i][2]);
        const Vec3 normal(normals[i][0], normals[i][1], normals[i][2]);
        int facets = 0;
        for (const auto& [a, b, c] : wall.mesh.triangles) {
            const auto& v = wall.mesh.vertices;
            const Vec3 facet_normal = core::triangle_area_vector(v[a], v[b], v[c]).normalized();
            const bool inside = (v[b] - v[a]).cross(point - v[a]).dot(facet_normal) > 1e-6 &&
                                (v[c] - v[b]).cross(point - v[b]).dot(facet_normal) > 1e-6 &&
                                (v[a] - v[c]).cross(point - v[c]).dot(facet_normal) > 1e-6;
            if (!inside) continue;
            ++facets;
            EXPECT_LT(std::abs((point - v[a]).dot(facet_normal)), 1e-15);
            EXPECT_LT((normal - facet_normal).norm(), 1e-14);
            EXPECT_GT(normal.z(), 0.0) << "towards the hidden side";
        }
        EXPECT_EQ(facets, 1) << "point " << i;
    }
}

}  // namespace
