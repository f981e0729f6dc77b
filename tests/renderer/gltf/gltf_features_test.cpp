// SPDX-License-Identifier: MIT
// Every feature of glTF 2.0 that changes where surfaces are or how much light they return, in a
// file that uses it: it is applied, refused or named.
#include "renderer/gltf/gltf_features.h"

#include "tests/renderer/gltf/gltf_feature_examples.h"

#include <set>

namespace {

using core::Vec3;
using gltf_test::Example;
using gltf_test::geometry_examples;
using gltf_test::GltfFile;
using gltf_test::Look;
using gltf_test::reflectance_examples;
using renderer::GltfHandling;
using renderer::SceneGeometry;

Look look_of(const SceneGeometry& geometry) {
    Look look{0.0, Vec3::Zero(), 0.0};
    double vertices = 0.0;
    for (const renderer::Object& object : geometry.objects) {
        look.area_m2 += gltf_test::total_area(object.mesh);
        for (std::size_t v = 0; v < object.mesh.vertices.size(); ++v) {
            double albedo = object.material.albedo;
            if (!object.vertex_albedo.empty()) albedo *= object.vertex_albedo[v];
            if (object.material.albedo_texture) {
                albedo *= object.material.albedo_texture->lookup(object.uv[v]);
            }
            look.center += object.mesh.vertices[v];
            look.albedo += albedo;
            vertices += 1.0;
        }
    }
    look.center /= vertices;
    look.albedo /= vertices;
    return look;
}

void expect_look(const Look& seen, const Look& expected) {
    EXPECT_NEAR(seen.area_m2, expected.area_m2, 1e-6);
    EXPECT_LT((seen.center - expected.center).norm(), 1e-6) << seen.center.transpose();
    EXPECT_NEAR(seen.albedo, expected.albedo, 1e-3);
}

void check(const Example& example) {
    SCOPED_TRACE(example.feature);
    GltfFile file = gltf_test::square_file();
    example.use(file);
    if (example.handling == GltfHandling::Refused) {
        EXPECT_NE(gltf_test::error_of(file).find(example.says), std::string::npos)
            << gltf_test::error_of(file);
        return;
    }
    const SceneGeometry geometry = file.load();
    expect_look(look_of(geometry), example.look);
    if (example.handling == GltfHandling::Named) {
        ASSERT_EQ(geometry.warnings.size(), 1U);
        EXPECT_NE(geometry.warnings[0].find(example.says), std::string::npos)
            << geometry.warnings[0];
    } else {
        EXPECT_TRUE(geometry.warnings.empty()) << geometry.warnings[0];
    }
}

TEST(GltfFeatures, WhatMovesSurfacesIsAppliedRefusedOrNamed) {
    for (const Example& example : geometry_examples()) check(example);
}

TEST(GltfFeatures, WhatChangesReflectanceIsAppliedRefusedOrNamed) {
    for (const Example& example : reflectance_examples()) check(example);
}

TEST(GltfFeatures, EveryRowHasAnExample) {
    std::set<std::string> shown;
    for (const auto& examples : {geometry_examples(), reflectance_examples()}) {
        for (const Example& example : examples) shown.insert(example.feature);
    }
    for (const renderer::GltfFeature& row : renderer::gltf_features()) {
        if (row.handling == GltfHandling::Beside) continue;
        const bool is_shown =
            shown.contains(row.name) || shown.contains(std::string(row.name) + ", required");
        EXPECT_TRUE(is_shown) << row.name;
    }
}

}  // namespace
