// SPDX-License-Identifier: MIT
// Materials and textures of glTF files.
#include "renderer/core/settings/json_file.h"
#include "renderer/gltf/gltf.h"
#include "tests/renderer/gltf/gltf_files.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace {

using namespace gltf_test;
using renderer::SceneGeometry;

TEST(Gltf, MaterialsDecideAlbedoAndModel) {
    GltfFile file = square_file();
    EXPECT_EQ(file.load().objects[0].material.model, renderer::model_of({}));
    EXPECT_EQ(file.load().objects[0].material.albedo, 1.0);

    file.primitive()["material"] = 0;
    file.json["materials"] =
        Json::array({Json{{"name", "paint"},
                          {"pbrMetallicRoughness",
                           {{"baseColorFactor", {0.2, 0.4, 0.9, 1.0}}, {"metallicFactor", 0.0}}}}});
    const auto paint = file.load().objects[0].material;
    EXPECT_EQ(paint.name, "paint");
    EXPECT_EQ(paint.model, renderer::model_of({}));
    EXPECT_NEAR(paint.albedo, 0.5, 1e-15);

    auto& pbr = file.json["materials"][0]["pbrMetallicRoughness"];
    pbr["metallicFactor"] = 0.5;
    pbr["roughnessFactor"] = 0.3;
    EXPECT_EQ(file.load().objects[0].material.model, renderer::model_of({.metallic = true}));
    EXPECT_EQ(file.load().objects[0].material.roughness, 0.3);

    EXPECT_EQ(file.load().warnings,
              std::vector<std::string>{
                  "material paint: a metallicFactor between 0 and 1 is taken as metal"});

    file.json["materials"][0] = Json::object();
    ASSERT_EQ(file.load().warnings.size(), 1U);
    EXPECT_NE(file.load().warnings[0].find("a rough metal by glTF's defaults"), std::string::npos);
    EXPECT_EQ(file.load().objects[0].material.model, renderer::model_of({.metallic = true}))
        << "metallicFactor is 1 by default";
    EXPECT_EQ(file.load().objects[0].material.roughness, 1.0);
}

TEST(Gltf, WhatIsNotModelledIsNamed) {
    GltfFile file = square_file();
    EXPECT_TRUE(file.load().warnings.empty());
    file.primitive()["material"] = 0;
    file.json["materials"] = Json::parse(R"([{"name": "glass",
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.1},
        "alphaMode": "BLEND", "emissiveFactor": [0, 0.5, 0],
        "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}}])");
    file.json["extensionsUsed"] = {"KHR_materials_transmission"};
    const SceneGeometry geometry = file.load();
    EXPECT_EQ(geometry.warnings,
              (std::vector<std::string>{
                  "material glass: its emission is not modelled",
                  "material glass: its transparency is not modelled: it is opaque",
                  "material glass: its extension KHR_materials_transmission is not modelled"}));
    EXPECT_EQ(geometry.objects[0].material.roughness, 0.1);
}

/// A PNG of two pixels: red, and a grey of code 188, which is 0.5029 linear.
const std::string kRedAndGreyPng =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mP4z8CwZ88eAAppAzSJw3cB"
    "AAAAAElFTkSuQmCC";

/// The square with the two pixels side by side, through the texture coordinates of set 1.
GltfFile textured_file() {
    GltfFile file = square_file();
    file.primitive()["attributes"]["TEXCOORD_0"] =
        file.add_accessor(std::vector<float>{9, 9, 9, 9, 9, 9, 9, 9}, kFloat, "VEC2");
    file.primitive()["attributes"]["TEXCOORD_1"] =
        file.add_accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 1}, kFloat, "VEC2");
    file.primitive()["material"] = 0;
    file.json["materials"] = Json::parse(R"([{"pbrMetallicRoughness": {"metallicFactor": 0,
        "baseColorFactor": [1, 0.5, 0, 1], "baseColorTexture": {"index": 0, "texCoord": 1}}}])");
    file.json["textures"] = Json::parse(R"([{"source": 0, "sampler": 0}])");
    file.json["samplers"] = Json::parse(R"([{"wrapS": 33071, "wrapT": 33648}])");
    file.json["images"] = Json::array({Json{{"uri", kRedAndGreyPng}}});
    return file;
}

TEST(Gltf, TexturesMultiplyTheAlbedoChannelByChannel) {
    const auto object = textured_file().load().objects[0];
    EXPECT_EQ(object.uv[3], core::Vec2(1, 1)) << "set 1 is used";
    const renderer::Texture& texture = *object.material.albedo_texture;
    EXPECT_EQ(texture.wrap_u, renderer::TextureWrap::ClampToEdge);
    EXPECT_EQ(texture.wrap_v, renderer::TextureWrap::MirroredRepeat);
    const auto albedo = [&](double u) { return object.material.albedo * texture.lookup({u, 0.5}); };
    const double grey = renderer::linear_from_srgb(188.0 / 255.0);
    EXPECT_NEAR(albedo(0.25), 1.0 / 3.0, 1e-7) << "red only passes the red factor";
    EXPECT_NEAR(albedo(0.75), (1.0 + 0.5) / 3.0 * grey, 1e-7);
}

TEST(Gltf, TexturesThatCannotBeUsedAreRefused) {
    GltfFile file = textured_file();
    file.primitive()["attributes"].erase("TEXCOORD_1");
    EXPECT_NE(error_of(file).find("has no TEXCOORD_1"), std::string::npos);

    file = textured_file();
    file.json["accessors"][2]["count"] = 3;
    EXPECT_NE(error_of(file).find("has 4 positions and 3 texture coordinates"), std::string::npos);

    file = textured_file();
    file.json["samplers"][0]["wrapS"] = 1;
    EXPECT_NE(error_of(file).find("samplers[0]: found wrap mode 1"), std::string::npos);

    file = textured_file();
    file.json["images"][0]["uri"] = "data:image/png;base64,AAAA";
    EXPECT_NE(error_of(file).find("images[0]: cannot be decoded"), std::string::npos);

    // The size that a PNG or a JPEG file gives is enough to tell.
    for (const char* large :
         {"iVBORw0KGgoAAAANSUhEUgABAAAAAQAACAIAAAA=", "/9j/4AAEAAD/wAARCP////8DASIAAhEBAxEB"}) {
        file = textured_file();
        file.json["images"][0]["uri"] = std::string("data:image/png;base64,") + large;
        EXPECT_NE(error_of(file).find("must have at most 67108864"), std::string::npos)
            << error_of(file);
    }

    file = textured_file();
    file.json["images"][0]["uri"] = "no_such_image.png";
    EXPECT_NE(error_of(file).find("images[0]: 'no_such_image.png' cannot be read"),
              std::string::npos);
}

}  // namespace
