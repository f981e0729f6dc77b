// SPDX-License-Identifier: MIT
#include "tests/renderer/gltf/gltf_feature_examples.h"

#include <algorithm>

namespace gltf_test {
namespace {

using core::Vec3;
using renderer::GltfHandling;

using Floats = std::vector<float>;

void set_material(GltfFile& file, const char* json) {
    file.primitive()["material"] = 0;
    file.json["materials"] = Json::array({Json::parse(json)});
}

/// A paint that is no metal, with more keys.
void paint(GltfFile& file, const char* keys) {
    Json material = Json::parse(R"({"name": "m", "pbrMetallicRoughness": {"metallicFactor": 0}})");
    material.merge_patch(Json::parse(keys));
    set_material(file, material.dump().c_str());
}

/// A PNG of two pixels.
const char* const kBlackAndWhitePng =
    "data:image/png;base64,"
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAAAAADRSSBWAAAAC0lEQVR4nGNg+A8AAQIBAEK+vGgAAAAASUVORK5C"
    "YII=";

/// Two texels, black and white, over the square's width.
void paint_texture(GltfFile& file, const char* keys = "{}") {
    file.primitive()["attributes"]["TEXCOORD_0"] =
        file.add_accessor(Floats{0, 0, 1, 0, 0, 1, 1, 1}, gltf_test::kFloat, "VEC2");
    Json texture = Json::parse(R"({"index": 0})");
    texture.merge_patch(Json::parse(keys));
    Json pbr{{"metallicFactor", 0}, {"baseColorTexture", texture}};
    set_material(file, Json{{"pbrMetallicRoughness", pbr}}.dump().c_str());
    file.json["textures"] = Json::parse(R"([{"source": 0, "sampler": 0}])");
    file.json["samplers"] = Json::parse(R"([{"wrapS": 33071, "wrapT": 33071}])");
    file.json["images"] = Json::array({Json{{"uri", kBlackAndWhitePng}}});
}

void add_indices(GltfFile& file, int mode, const std::vector<std::uint16_t>& indices) {
    file.primitive()["mode"] = mode;
    file.primitive()["indices"] = file.add_accessor(indices, gltf_test::kUShort, "SCALAR");
}

void add_morph(GltfFile& file) {
    const int ways =
        file.add_accessor(Floats{0, 0, 2, 0, 0, 2, 0, 0, 2, 0, 0, 2}, gltf_test::kFloat, "VEC3");
    file.primitive()["targets"] = Json::array({Json{{"POSITION", ways}}});
}

void add_skin(GltfFile& file) {
    auto& attributes = file.primitive()["attributes"];
    attributes["JOINTS_0"] =
        file.add_accessor(std::vector<std::uint8_t>(16), gltf_test::kUByte, "VEC4");
    attributes["WEIGHTS_0"] = file.add_accessor(
        Floats{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, gltf_test::kFloat, "VEC4");
    file.json["nodes"][0]["skin"] = 0;
    file.json["nodes"].push_back(Json::parse(R"({"translation": [0, 0, 3]})"));
    file.json["scenes"][0]["nodes"] = {0, 1};
    file.json["skins"] = Json::parse(R"([{"joints": [1]}])");
}

void add_instances(GltfFile& file) {
    const int ways = file.add_accessor(Floats{0, 0, 1, 0, 0, 5}, gltf_test::kFloat, "VEC3");
    file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {
        {"attributes", {{"TRANSLATION", ways}}}};
    file.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
}

void add_sparse_corner(GltfFile& file) {
    const int index = file.add_view(std::vector<std::uint8_t>{3});
    const int value = file.add_view(Floats{2, 1, 0});
    file.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", index}, {"componentType", 5121}}},
        {"values", {{"bufferView", value}}}};
}

void quantize(GltfFile& file) {
    const int view = file.add_view(
        std::vector<std::uint8_t>{0, 0, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 255, 255, 0, 0});
    file.json["bufferViews"][1]["byteStride"] = 4;
    file.json["accessors"][0].update(
        {{"bufferView", view}, {"componentType", 5121}, {"normalized", true}});
    file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
}

/// A second square beside the first, in a node with these keys.
void add_node(GltfFile& file, const char* keys) {
    Json node = Json::parse(keys);
    node["mesh"] = 0;
    file.json["nodes"].push_back(node);
    file.json["scenes"][0]["nodes"] = {0, 1};
}

void extend(Json& owner, const char* name) {
    owner["extensions"][name] = Json::object();
}

}  // namespace

std::vector<Example> geometry_examples() {
    constexpr auto kApplied = GltfHandling::Applied;
    constexpr auto kRefused = GltfHandling::Refused;
    constexpr auto kNamed = GltfHandling::Named;
    return {
        {"nothing", kApplied, [](GltfFile&) {}},
        {"indices",
         kApplied,
         [](GltfFile& f) {
             add_indices(f, 4, {0, 1, 2, 1, 3, 2});
         }},
        {"triangle strip",
         kApplied,
         [](GltfFile& f) {
             add_indices(f, 5, {0, 1, 2, 3});
         }},
        {"triangle fan",
         kApplied,
         [](GltfFile& f) {
             add_indices(f, 6, {0, 1, 3, 2});
         }},
        {"points and lines",
         kNamed,
         [](GltfFile& f) {
             Json lines = f.primitive();
             lines["mode"] = 3;
             f.json["meshes"][0]["primitives"].push_back(lines);
         },
         {},
         "points and lines are left out"},
        {"sparse accessors", kApplied, add_sparse_corner, {1.5, {0.75, 0.5, 0.0}}},
        {"KHR_mesh_quantization", kApplied, quantize},
        {"translation",
         kApplied,
         [](GltfFile& f) {
             f.json["nodes"][0]["translation"] = {1, 2, 3};
         },
         {1.0, {1.5, 2.5, 3.0}}},
        {"rotation",
         kApplied,
         [](GltfFile& f) {
             f.json["nodes"][0]["rotation"] = {0, 0, 1, 0};
         },
         {1.0, {-0.5, -0.5, 0.0}}},
        {"scale",
         kApplied,
         [](GltfFile& f) {
             f.json["nodes"][0]["scale"] = {2, 3, 1};
         },
         {6.0, {1.0, 1.5, 0.0}}},
        {"matrix",
         kApplied,
         [](GltfFile& f) {
             f.json["nodes"][0]["matrix"] = {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 1, 1, 1};
         },
         {2.0, {2.0, 1.5, 1.0}}},
        {"children",
         kApplied,
         [](GltfFile& f) {
             f.json["nodes"].push_back(Json::parse(R"({"children": [0], "scale": [2, 2, 2]})"));
             f.json["scenes"][0]["nodes"] = {1};
         },
         {4.0, {1.0, 1.0, 0.0}}},
        {"scene",
         kApplied,
         [](GltfFile& f) {
             f.json["nodes"].push_back(Json::parse(R"({"mesh": 0, "translation": [5, 0, 0]})"));
             f.json["scenes"].push_back(Json::parse(R"({"nodes": [1]})"));
             f.json["scene"] = 1;
         },
         {1.0, {5.5, 0.5, 0.0}}},
        {"instances",
         kApplied,
         [](GltfFile& f) { add_node(f, R"({"translation": [0, 0, 2]})"); },
         {2.0, {0.5, 0.5, 1.0}}},
        {"weights of a mesh",
         kApplied,
         [](GltfFile& f) {
             add_morph(f);
             f.json["meshes"][0]["weights"] = {0.5};
         },
         {1.0, {0.5, 0.5, 1.0}}},
        {"weights of a node",
         kApplied,
         [](GltfFile& f) {
             add_morph(f);
             f.json["meshes"][0]["weights"] = {0.5};
             f.json["nodes"][0]["weights"] = {0.25};
         },
         {1.0, {0.5, 0.5, 0.5}}},
        {"weights of 0", kApplied, add_morph},
        {"skins", kApplied, add_skin, {1.0, {0.5, 0.5, 3.0}}},
        {"EXT_mesh_gpu_instancing", kApplied, add_instances, {2.0, {0.5, 0.5, 3.0}}},
        {"KHR_node_visibility",
         kApplied,
         [](GltfFile& f) {
             add_node(f, R"({"translation": [0, 0, 2],
                             "extensions": {"KHR_node_visibility": {"visible": false}}})");
         }},
        {"animations",
         kNamed,
         [](GltfFile& f) {
             f.json["animations"] = Json::parse(R"([{"channels": [], "samplers": []}])");
         },
         {},
         "its animations are not played"},
        {"KHR_draco_mesh_compression",
         kRefused,
         [](GltfFile& f) {
             extend(f.primitive(), "KHR_draco_mesh_compression");
             f.json["accessors"][0].erase("bufferView");
         },
         {},
         "without compression (KHR_draco_mesh_compression)"},
        {"KHR_draco_mesh_compression, required",
         kRefused,
         [](GltfFile& f) { f.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
         {},
         "extensionsRequired: found \"KHR_draco_mesh_compression\""},
        {"EXT_meshopt_compression, required",
         kRefused,
         [](GltfFile& f) { f.json["extensionsRequired"] = {"EXT_meshopt_compression"}; },
         {},
         "extensionsRequired: found \"EXT_meshopt_compression\""},
        {"an unknown extension of a mesh",
         kNamed,
         [](GltfFile& f) { extend(f.primitive(), "EXT_of_tomorrow"); },
         {},
         "mesh 0: its extension EXT_of_tomorrow is not modelled"},
        {"an unknown extension of a node",
         kNamed,
         [](GltfFile& f) { extend(f.json["nodes"][0], "EXT_of_tomorrow"); },
         {},
         "node 0: its extension EXT_of_tomorrow is not modelled"},
    };
}

std::vector<Example> reflectance_examples() {
    constexpr auto kApplied = GltfHandling::Applied;
    constexpr auto kNamed = GltfHandling::Named;
    constexpr auto kBeside = GltfHandling::Beside;
    const Vec3 middle(0.5, 0.5, 0.0);
    const auto named_paint = [](const char* feature, const char* keys, const char* says) {
        return Example{feature, kNamed, [keys](GltfFile& f) { paint(f, keys); }, {}, says};
    };
    return {
        {"baseColorFactor",
         kApplied,
         [](GltfFile& f) {
             paint(f, R"({"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.6, 1]}})");
         },
         {1.0, middle, 0.4}},
        {"baseColorTexture", kApplied, [](GltfFile& f) { paint_texture(f); }, {1.0, middle, 0.5}},
        {"KHR_texture_transform",
         kApplied,
         [](GltfFile& f) {
             paint_texture(f, R"({"extensions": {"KHR_texture_transform": {"offset": [1, 0]}}})");
         },
         {1.0, middle, 1.0}},
        {"nearest texels",
         kNamed,
         [](GltfFile& f) {
             paint_texture(f);
             f.json["samplers"][0]["magFilter"] = 9728;
         },
         {1.0, middle, 0.5},
         "its texture is interpolated"},
        {"COLOR_0, one",
         kApplied,
         [](GltfFile& f) {
             f.primitive()["attributes"]["COLOR_0"] =
                 f.add_accessor(Floats(12, 0.25f), gltf_test::kFloat, "VEC3");
         },
         {1.0, middle, 0.25}},
        {"COLOR_0, several",
         kApplied,
         [](GltfFile& f) {
             paint(f, R"({"pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.4, 0, 1]}})");
             std::vector<std::uint8_t> colours{255, 0, 0, 255, 255, 0, 0, 255};
             colours.insert(colours.end(), {0, 255, 0, 0, 0, 255, 255, 255});
             f.primitive()["attributes"]["COLOR_0"] =
                 f.add_accessor(colours, gltf_test::kUByte, "VEC4");
             f.json["accessors"].back()["normalized"] = true;
         },
         {1.0, middle, 0.2}},
        {"morph targets of looks",
         kNamed,
         [](GltfFile& f) {
             add_morph(f);
             f.primitive()["targets"][0]["COLOR_0"] = 0;
         },
         {},
         "its morph targets of colours"},
        named_paint("metallicFactor",
                    R"({"pbrMetallicRoughness": {"metallicFactor": 0.5}})",
                    "a metallicFactor between 0 and 1 is taken as metal"),
        {"metal by default",
         kNamed,
         [](GltfFile& f) { set_material(f, "{}"); },
         {},
         "a rough metal by glTF's defaults"},
        named_paint("metallicRoughnessTexture",
                    R"({"pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}}})",
                    "its metallic-roughness texture is not modelled"),
        named_paint("normalTexture",
                    R"({"normalTexture": {"index": 0}})",
                    "its normal map is not modelled"),
        named_paint(
            "emission", R"({"emissiveFactor": [0, 0, 0.1]})", "its emission is not modelled"),
        named_paint("alphaMode", R"({"alphaMode": "MASK"})", "its transparency is not modelled"),
        named_paint("KHR_materials_transmission",
                    R"({"extensions": {"KHR_materials_transmission": {}}})",
                    "its extension KHR_materials_transmission is not modelled"),
        named_paint("KHR_materials_pbrSpecularGlossiness",
                    R"({"extensions": {"KHR_materials_pbrSpecularGlossiness": {}}})",
                    "its extension KHR_materials_pbrSpecularGlossiness is not modelled"),
        {"doubleSided", kBeside, [](GltfFile& f) { paint(f, R"({"doubleSided": false})"); }},
        {"occlusionTexture",
         kBeside,
         [](GltfFile& f) { paint(f, R"({"occlusionTexture": {"index": 0}})"); }},
        {"NORMAL",
         kBeside,
         [](GltfFile& f) {
             f.primitive()["attributes"]["NORMAL"] =
                 f.add_accessor(Floats(12, 0.0f), gltf_test::kFloat, "VEC3");
         }},
        {"KHR_lights_punctual",
         kBeside,
         [](GltfFile& f) { extend(f.json["nodes"][0], "KHR_lights_punctual"); }},
        {"KHR_materials_variants",
         kBeside,
         [](GltfFile& f) { extend(f.primitive(), "KHR_materials_variants"); }},
    };
}

}  // namespace gltf_test
