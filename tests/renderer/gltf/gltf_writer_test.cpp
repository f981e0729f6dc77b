// SPDX-License-Identifier: MIT
#include "tests/renderer/gltf/gltf_files.h"
#include "tests/support/surface_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace {

using namespace gltf_test;
using core::Vec3;
using renderer::Object;
using renderer::SceneGeometry;
using renderer::Texture;
using renderer::TextureWrap;

/// Everything that an object can say.
SceneGeometry full_geometry() {
    Object plain;
    plain.name = "plain";
    plain.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0.25}};
    plain.mesh.triangles = {{0, 1, 2}};
    plain.material.name = "paint";
    plain.material.albedo = 0.7;

    Object moved = plain;
    moved.name = "moved \"quoted\" näme";
    moved.role = renderer::Role::BackWall;
    moved.ellipsoidal_exclude = true;
    moved.velocity_m_per_s = {0.1, -2, 1.0 / 3.0};
    moved.material.model = renderer::model_of({.metallic = true});
    moved.material.roughness = 0.35;
    moved.world_from_node.translation() = Vec3(1000.1, -3, 2000.2);
    moved.world_from_node.linear() =
        Eigen::AngleAxisd(0.3, Vec3(1, 2, 2) / 3.0).toRotationMatrix() * 1e-3;
    for (Vec3& vertex : moved.mesh.vertices) vertex = moved.world_from_node * vertex;

    Object mirror = plain;
    mirror.name = "mirror";
    mirror.material.model = renderer::model_of({.retroreflective = true});
    mirror.role = renderer::Role::RelayWall;
    mirror.uv = {{0, 0}, {1, 0}, {0.25, -3}};
    auto texture = std::make_shared<Texture>();
    texture->width = 3;
    texture->height = 2;
    texture->wrap_u = TextureWrap::MirroredRepeat;
    texture->wrap_v = TextureWrap::ClampToEdge;
    for (const int code : {0, 10, 100, 128, 200, 255}) {
        texture->luminance.push_back(static_cast<float>(renderer::linear_from_srgb(code / 255.0)));
    }
    mirror.material.albedo_texture = texture;

    SceneGeometry geometry;
    geometry.objects = {plain, moved, mirror};
    for (const renderer::Material& material : test_support::materials_of_all_models(0.6, 0.45)) {
        geometry.objects.push_back(plain);
        geometry.objects.back().name = material.name;
        geometry.objects.back().material = material;
    }
    renderer::Camera camera;
    camera.name = "eye";
    camera.position = {1, 2, 3};
    camera.forward = Vec3(0.6, 0, 0.8);
    camera.up = Vec3::UnitY();
    camera.fov_y_rad = 0.7;
    geometry.cameras = {camera};
    return geometry;
}

void expect_equal(const Object& a, const Object& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.role, b.role);
    EXPECT_EQ(a.ellipsoidal_exclude, b.ellipsoidal_exclude);
    EXPECT_EQ(a.velocity_m_per_s, b.velocity_m_per_s);
    EXPECT_EQ(a.world_from_node.matrix(), b.world_from_node.matrix());
    EXPECT_EQ(a.material.name, b.material.name);
    EXPECT_EQ(a.material.model, b.material.model);
    EXPECT_NEAR(a.material.albedo, b.material.albedo, 1e-15);
    EXPECT_EQ(a.material.roughness, b.material.roughness);
    EXPECT_EQ(a.uv, b.uv);
    EXPECT_EQ(a.mesh.triangles, b.mesh.triangles);
    ASSERT_EQ(a.mesh.vertices.size(), b.mesh.vertices.size());
    const double scale = a.world_from_node.linear().norm();
    for (std::size_t i = 0; i < a.mesh.vertices.size(); ++i) {
        EXPECT_LT((a.mesh.vertices[i] - b.mesh.vertices[i]).norm(), 1e-7 * scale + 1e-12);
    }
}

TEST(GltfWriter, WrittenFilesReadBackTheSame) {
    const SceneGeometry written = full_geometry();
    const std::string path = temporary_path("scene.glb");
    renderer::write_gltf(path, written);
    const SceneGeometry read = renderer::load_gltf(path);

    ASSERT_EQ(read.objects.size(), written.objects.size());
    for (std::size_t i = 0; i < read.objects.size(); ++i) {
        expect_equal(written.objects[i], read.objects[i]);
    }
    const Texture& texture = *read.objects[2].material.albedo_texture;
    const Texture& expected = *written.objects[2].material.albedo_texture;
    EXPECT_EQ(texture.width, expected.width);
    EXPECT_EQ(texture.height, expected.height);
    EXPECT_EQ(texture.wrap_u, expected.wrap_u);
    EXPECT_EQ(texture.wrap_v, expected.wrap_v);
    for (std::size_t i = 0; i < expected.luminance.size(); ++i) {
        EXPECT_NEAR(texture.luminance[i], expected.luminance[i], 1e-7);
    }
    ASSERT_EQ(read.cameras.size(), 1u);
    EXPECT_EQ(read.cameras[0].name, "eye");
    EXPECT_EQ(read.cameras[0].position, written.cameras[0].position);
    EXPECT_LT((read.cameras[0].forward - written.cameras[0].forward).norm(), 1e-12);
    EXPECT_LT((read.cameras[0].up - written.cameras[0].up).norm(), 1e-12);
    EXPECT_EQ(read.cameras[0].fov_y_rad, 0.7);
}

TEST(GltfWriter, WritingWhatWasReadGivesTheSameBytes) {
    const std::string first = temporary_path("1.glb");
    const std::string second = temporary_path("2.glb");
    renderer::write_gltf(first, full_geometry());
    renderer::write_gltf(second, renderer::load_gltf(first));
    EXPECT_TRUE(read_bytes(first) == read_bytes(second));
}

TEST(GltfWriter, GroupsStayAboveTheirObjects) {
    renderer::NodeGroup chair{"chair", core::Transform::Identity()};
    chair.world_from_node.translate(core::Vec3(1, 2, 3))
        .rotate(Eigen::AngleAxisd(0.7, core::Vec3(1, 2, 2).normalized()));
    renderer::NodeGroup legs{"legs", chair.world_from_node};
    legs.world_from_node.translate(core::Vec3(0, -0.5, 0));
    renderer::SceneGeometry geometry;
    for (const char* name : {"seat", "left", "right", "lamp"}) {
        renderer::Object& object = geometry.objects.emplace_back();
        object.name = name;
        object.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        object.mesh.triangles = {{0, 1, 2}};
    }
    geometry.objects[0].groups = {chair};
    geometry.objects[1].groups = {chair, legs};
    geometry.objects[2].groups = {chair, legs};
    const test_support::TemporaryFolder folder;
    renderer::write_gltf(folder.file("a.glb"), geometry);
    const auto read = renderer::load_gltf(folder.file("a.glb"));
    ASSERT_EQ(read.objects.size(), 4U);
    for (const renderer::Object& object : geometry.objects) {
        const auto found =
            std::find_if(read.objects.begin(), read.objects.end(), [&](const auto& other) {
                return other.name == object.name;
            });
        ASSERT_NE(found, read.objects.end());
        ASSERT_EQ(found->groups.size(), object.groups.size()) << object.name;
        for (std::size_t i = 0; i < object.groups.size(); ++i) {
            EXPECT_EQ(found->groups[i].name, object.groups[i].name);
            EXPECT_TRUE(
                found->groups[i].world_from_node.isApprox(object.groups[i].world_from_node, 1e-12));
        }
        EXPECT_LT((found->mesh.vertices[1] - object.mesh.vertices[1]).norm(), 1e-6);
    }
}

TEST(GltfWriter, ManyVerticesNeedLongIndices) {
    Object object;
    object.name = "long";
    for (int i = 0; i < 70000; ++i) {
        object.mesh.vertices.emplace_back(i % 2, i / 2, i % 3);
        const auto last = static_cast<std::uint32_t>(i);
        if (i >= 2) object.mesh.triangles.push_back({last - 2, last - 1, last});
    }
    const std::string path = temporary_path("scene.glb");
    renderer::write_gltf(path, {{object}, {}});
    EXPECT_EQ(renderer::load_gltf(path).objects[0].mesh.triangles, object.mesh.triangles);
}

TEST(GltfWriter, WhatCannotBeWrittenLeavesTheOldFile) {
    const std::string path = temporary_path("scene.glb");
    write_bytes(path, "old");
    const auto refused = [&](SceneGeometry geometry) {
        EXPECT_THROW(renderer::write_gltf(path, geometry), core::Error);
        EXPECT_EQ(read_bytes(path), "old");
    };
    refused({});
    SceneGeometry geometry = full_geometry();
    geometry.objects[0].mesh.triangles.clear();
    refused(geometry);
    geometry = full_geometry();
    geometry.objects[1].material.albedo = 1.5;
    refused(geometry);
    geometry = full_geometry();
    geometry.objects[0].mesh.vertices[0].x() = std::nan("");
    refused(geometry);
    geometry = full_geometry();
    geometry.objects[1].world_from_node.linear().setZero();
    refused(geometry);
    geometry = full_geometry();
    geometry.objects[2].uv.clear();
    refused(geometry);
}

TEST(Texture, LookupInterpolatesBetweenTexelCentres) {
    Texture texture;
    texture.width = 2;
    texture.height = 2;
    texture.luminance = {0.0f, 1.0f, 0.5f, 0.25f};
    texture.wrap_u = texture.wrap_v = TextureWrap::ClampToEdge;
    EXPECT_EQ(texture.lookup({0.25, 0.25}), 0.0) << "upper left";
    EXPECT_EQ(texture.lookup({0.75, 0.25}), 1.0);
    EXPECT_EQ(texture.lookup({0.25, 0.75}), 0.5);
    EXPECT_NEAR(texture.lookup({0.5, 0.5}), 1.75 / 4.0, 1e-15);
    EXPECT_NEAR(texture.lookup({0.375, 0.25}), 0.25, 1e-15);
}

TEST(Texture, WrapModesDecideWhatLiesOutside) {
    Texture texture;
    texture.width = 4;
    texture.height = 1;
    texture.luminance = {0.0f, 0.25f, 0.5f, 1.0f};
    const auto texel = [&](int i) { return texture.lookup({(i + 0.5) / 4.0, 0.5}); };
    texture.wrap_u = TextureWrap::Repeat;
    EXPECT_EQ(texel(-1), 1.0);
    EXPECT_EQ(texel(5), 0.25);
    texture.wrap_u = TextureWrap::ClampToEdge;
    EXPECT_EQ(texel(-3), 0.0);
    EXPECT_EQ(texel(9), 1.0);
    texture.wrap_u = TextureWrap::MirroredRepeat;
    EXPECT_EQ(texel(-1), 0.0);
    EXPECT_EQ(texel(-2), 0.25);
    EXPECT_EQ(texel(4), 1.0);
    EXPECT_EQ(texel(5), 0.5);
    EXPECT_EQ(texel(8), 0.0);
    EXPECT_GE(texture.lookup({1e300, -1e300}), 0.0) << "far outside is no crash";
}

TEST(Texture, SrgbAndLinearAreInverse) {
    EXPECT_NEAR(renderer::linear_from_srgb(0.5), 0.21404114, 1e-8);
    for (int code = 0; code < 256; ++code) {
        const double encoded = code / 255.0;
        EXPECT_NEAR(renderer::srgb_from_linear(renderer::linear_from_srgb(encoded)), encoded, 1e-6);
    }
}

}  // namespace
