// SPDX-License-Identifier: MIT
#include "renderer/core/random.h"
#include "tests/renderer/gltf/gltf_files.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace {

using namespace gltf_test;

/// Loads what may be any bytes: the file is accepted or refused in one line, and nothing else.
void expect_no_crash(const std::string& path) {
    try {
        renderer::load_gltf(path);
    } catch (const core::Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
}

TEST(GltfBadInput, MissingFilesAndFoldersAreRefused) {
    EXPECT_NE(error_of(temporary_path("missing.glb")).find("cannot be opened"), std::string::npos);
    EXPECT_NE(error_of(temporary_path("")).find("is a folder"), std::string::npos);
}

TEST(GltfBadInput, EveryTruncationOfABinaryFileIsRefused) {
    const std::string whole = square_file().binary();
    const std::string path = temporary_path("scene.glb");
    for (std::size_t length = 0; length < whole.size(); ++length) {
        write_bytes(path, whole.substr(0, length));
        error_of(path);
    }
}

TEST(GltfBadInput, ChunksThatOverrunTheFileAreRefused) {
    const std::string path = temporary_path("scene.glb");
    std::string bytes = square_file().binary();
    bytes[bytes.size() - square_file().bytes.size() - 8] += 8;  // the second chunk's length
    write_bytes(path, bytes);
    EXPECT_NE(error_of(path).find("chunk 1 runs past the end"), std::string::npos);
}

TEST(GltfBadInput, TruncatedTextFilesAreRefused) {
    const std::string whole = square_file().text();
    const std::string path = temporary_path("scene.gltf");
    for (std::size_t length = 0; length < whole.size(); length += 7) {
        write_bytes(path, whole.substr(0, length));
        error_of(path);
    }
}

TEST(GltfBadInput, DeeplyNestedJsonIsRefused) {
    const std::string path = temporary_path("scene.gltf");
    write_bytes(path,
                R"({"asset":{"version":"2.0"},"extras":)" + std::string(200000, '[') +
                    std::string(200000, ']') + "}");
    EXPECT_NE(error_of(path).find("nested deeper"), std::string::npos);
}

/// One way to spoil the square, and what the message must name.
struct Mutation {
    const char* expected;
    std::function<void(GltfFile&)> spoil;
};

TEST(GltfBadInput, MessagesNameTheOffendingPart) {
    static constexpr auto kHuge = std::numeric_limits<std::uint64_t>::max();
    const std::vector<Mutation> mutations{
        {"asset", [](GltfFile& f) { f.json.erase("asset"); }},
        {"scene: found 4", [](GltfFile& f) { f.json["scene"] = 4; }},
        {"scenes[0].nodes: found 7", [](GltfFile& f) { f.json["scenes"][0]["nodes"] = {7}; }},
        {"scenes[0].nodes: found -1", [](GltfFile& f) { f.json["scenes"][0]["nodes"] = {-1}; }},
        {"nodes[0].mesh: found 1", [](GltfFile& f) { f.json["nodes"][0]["mesh"] = 1; }},
        {"nodes[0].mesh: found 4294967296",
         [](GltfFile& f) { f.json["nodes"][0]["mesh"] = 4294967296; }},
        {"nodes[0].mesh: found \"0\"", [](GltfFile& f) { f.json["nodes"][0]["mesh"] = "0"; }},
        {"nodes[0].matrix",
         [](GltfFile& f) {
             f.json["nodes"][0]["matrix"] = {1, 2};
         }},
        {"nodes[0].matrix: is not affine",
         [](GltfFile& f) { f.json["nodes"][0]["matrix"] = Json(16, 1.0); }},
        {"nodes[0].translation",
         [](GltfFile& f) {
             f.json["nodes"][0]["translation"] = {1, "2", 3};
         }},
        {"nodes[0].rotation: has length 0",
         [](GltfFile& f) {
             f.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
         }},
        {"nodes[0]: its vertices overflow",
         [](GltfFile& f) {
             f.json["nodes"][0]["matrix"] = Json(16, 0.0);
             for (const int i : {0, 4, 8, 12}) f.json["nodes"][0]["matrix"][i] = 1.7e308;
             f.json["nodes"][0]["matrix"][15] = 1;
         }},
        {"nodes[0]: its mesh has no triangle with an area",
         [](GltfFile& f) {
             f.json["nodes"][0]["scale"] = {0, 1, 1};
         }},
        {"nodes[0]: is reached twice", [](GltfFile& f) { f.json["nodes"][0]["children"] = {0}; }},
        {"nodes[1]: is reached twice",
         [](GltfFile& f) {
             f.json["nodes"][0]["children"] = {1, 1};
             f.json["nodes"].push_back(Json::object());
         }},
        {"has no triangles",
         [](GltfFile& f) {
             f.json["nodes"].push_back({{"children", {0}}});
             f.json["nodes"][0]["children"] = {1};  // a cycle that no root reaches
             f.json.erase("scenes");
             f.json.erase("scene");
         }},
        {"has no triangles", [](GltfFile& f) { f.json["nodes"][0].erase("mesh"); }},
        {"has no triangles", [](GltfFile& f) { f.primitive()["mode"] = 0; }},
        {"meshes[0].primitives[0]: found mode 7", [](GltfFile& f) { f.primitive()["mode"] = 7; }},
        {"meshes[0].primitives: found []",
         [](GltfFile& f) { f.json["meshes"][0]["primitives"] = Json::array(); }},
        {"meshes[0].primitives[0]: has no attributes",
         [](GltfFile& f) { f.primitive().erase("attributes"); }},
        {"meshes[0].primitives[0]: has no POSITION",
         [](GltfFile& f) {
             f.primitive()["attributes"] = {{"NORMAL", 0}};
         }},
        {"meshes[0].primitives[0].attributes.POSITION: found 9",
         [](GltfFile& f) { f.primitive()["attributes"]["POSITION"] = 9; }},
        {"meshes[0].primitives[0]: has 4 corners", [](GltfFile& f) { f.primitive()["mode"] = 4; }},
        {"meshes[0].primitives[0].material: found 0",
         [](GltfFile& f) { f.primitive()["material"] = 0; }},
        {"accessors[1]: index 4 is out of range",
         [](GltfFile& f) {
             f.primitive()["indices"] =
                 f.add_accessor(std::vector<std::uint16_t>{0, 1, 4}, kUShort, "SCALAR");
         }},
        {"accessors[1]: is used for indices",
         [](GltfFile& f) {
             f.primitive()["indices"] =
                 f.add_accessor(std::vector<float>{0, 1, 2}, kFloat, "SCALAR");
         }},
        {"accessors[0]: is used for positions",
         [](GltfFile& f) { f.json["accessors"][0]["type"] = "VEC4"; }},
        {"accessors[0]: is used for positions",
         [](GltfFile& f) { f.json["accessors"][0]["componentType"] = 5125; }},
        {"Invalid `componentType`",
         [](GltfFile& f) { f.json["accessors"][0]["componentType"] = 1; }},
        {"accessors[0]: has 5 elements of 12 bytes every 12 bytes from byte 0",
         [](GltfFile& f) { f.json["accessors"][0]["count"] = 5; }},
        {"accessors[0]: has 4 elements of 12 bytes every 12 bytes from byte 4",
         [](GltfFile& f) { f.json["accessors"][0]["byteOffset"] = 4; }},
        {"accessors[0]: has",
         [](GltfFile& f) { f.json["accessors"][0]["byteOffset"] = 2147483644; }},
        {"accessors[0]: has 2147483647 elements of 12 bytes",
         [](GltfFile& f) { f.json["accessors"][0]["count"] = 2147483647; }},
        {"accessors[0].count", [](GltfFile& f) { f.json["accessors"][0]["count"] = 0; }},
        {"accessors[0].count", [](GltfFile& f) { f.json["accessors"][0]["count"] = kHuge; }},
        {"accessors[0].count", [](GltfFile& f) { f.json["accessors"][0]["count"] = 3.5; }},
        {"accessors[0]: has elements of 12 bytes every 4 bytes",
         [](GltfFile& f) { f.json["bufferViews"][0]["byteStride"] = 4; }},
        {"byteStride", [](GltfFile& f) { f.json["bufferViews"][0]["byteStride"] = 254; }},
        {"bufferViews[0]: ends at byte 49",
         [](GltfFile& f) { f.json["bufferViews"][0]["byteLength"] = 49; }},
        {"bufferViews[0]: ends at byte",
         [](GltfFile& f) { f.json["bufferViews"][0]["byteOffset"] = 2147483647; }},
        {"bufferViews[0].byteOffset",
         [](GltfFile& f) { f.json["bufferViews"][0]["byteOffset"] = kHuge; }},
        {"bufferViews[0].buffer: found 1",
         [](GltfFile& f) { f.json["bufferViews"][0]["buffer"] = 1; }},
        {"accessors[0].sparse.indices: found 4",
         [](GltfFile& f) {
             const int indices = f.add_view(std::vector<std::uint8_t>{4});
             const int values = f.add_view(std::vector<float>{0, 0, 0});
             f.json["accessors"][0]["sparse"] = {
                 {"count", 1},
                 {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                 {"values", {{"bufferView", values}}}};
         }},
        {"accessors[0].sparse.values: has 2 elements",
         [](GltfFile& f) {
             const int indices = f.add_view(std::vector<std::uint8_t>{0, 1});
             const int values = f.add_view(std::vector<float>{0, 0, 0});
             f.json["accessors"][0]["sparse"] = {
                 {"count", 2},
                 {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                 {"values", {{"bufferView", values}}}};
         }},
        {"accessors[0].sparse", [](GltfFile& f) { f.json["accessors"][0]["sparse"] = 3; }},
        {"accessors[0].sparse.indices.bufferView: found 5",
         [](GltfFile& f) {
             f.json["accessors"][0]["sparse"] = {
                 {"count", 1},
                 {"indices", {{"bufferView", 5}, {"componentType", 5121}}},
                 {"values", {{"bufferView", 0}}}};
         }},
        {"materials[0].pbrMetallicRoughness.baseColorFactor",
         [](GltfFile& f) {
             f.json["materials"] =
                 Json::array({Json{{"pbrMetallicRoughness", {{"baseColorFactor", {2, 0, 0, 1}}}}}});
         }},
        {"nodes[0].extras.nlos_rolle: found an unknown key; known keys are nlos_role",
         [](GltfFile& f) {
             f.json["nodes"][0]["extras"] = {{"nlos_rolle", "hidden"}};
         }},
        {"nodes[0].extras.nlos_role: found \"wall\"; must be one of hidden|relay_wall|back_wall",
         [](GltfFile& f) {
             f.json["nodes"][0]["extras"] = {{"nlos_role", "wall"}};
         }},
        {"nodes[0].extras.nlos_velocity_m_per_s",
         [](GltfFile& f) {
             f.json["nodes"][0]["extras"] = {{"nlos_velocity_m_per_s", {1, 2}}};
         }},
        {"nodes[0].extras.nlos_ellipsoidal_exclude: found 1",
         [](GltfFile& f) {
             f.json["nodes"][0]["extras"] = {{"nlos_ellipsoidal_exclude", 1}};
         }},
        {"meshes[0].extras.nlos_role: is not on a node or a material",
         [](GltfFile& f) {
             f.json["meshes"][0]["extras"] = {{"nlos_role", "hidden"}};
         }},
        {"extensionsRequired: found \"KHR_draco_mesh_compression\"",
         [](GltfFile& f) { f.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; }},
        {"meshes: found", [](GltfFile& f) { f.json["meshes"] = 3; }},
        {"nodes[0]: found", [](GltfFile& f) { f.json["nodes"][0] = "node"; }},
    };
    for (const Mutation& mutation : mutations) {
        GltfFile file = square_file();
        mutation.spoil(file);
        EXPECT_NE(error_of(file).find(mutation.expected), std::string::npos)
            << "expected: " << mutation.expected << "\nmessage:  " << error_of(file);
    }
}

TEST(GltfBadInput, PositionsMustBeFinite) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        GltfFile file = square_file();
        std::memcpy(file.bytes.data() + 7 * sizeof(float), &bad, sizeof(bad));
        EXPECT_NE(error_of(file).find("accessors[0]: element 2 is not finite"), std::string::npos);
    }
}

TEST(GltfBadInput, MissingBuffersAreNamed) {
    GltfFile file = square_file();
    file.json["buffers"] =
        Json::array({Json{{"byteLength", file.bytes.size()}, {"uri", "no_such.bin"}}});
    const std::string path = temporary_path("scene.gltf");
    write_bytes(path, file.json.dump());
    EXPECT_NE(error_of(path).find("no_such.bin"), std::string::npos);
}

TEST(GltfBadInput, ManyInstancesDoNotExhaustMemory) {
    GltfFile file = square_file();
    // A million corners in each of 20,000 instances would need a terabyte.
    file.json["accessors"][0].erase("bufferView");
    file.json["accessors"][0]["count"] = 1000000;
    const int indices = file.add_view(std::vector<std::uint32_t>{1, 2});
    const int values = file.add_view(std::vector<float>{1, 0, 0, 0, 1, 0});
    file.json["accessors"][0]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", indices}, {"componentType", 5125}}},
        {"values", {{"bufferView", values}}}};
    Json list = Json::array();
    for (int i = 0; i < 20000; ++i) {
        if (i > 0) file.json["nodes"].push_back({{"mesh", 0}});
        list.push_back(i);
    }
    file.json["scenes"][0]["nodes"] = list;
    EXPECT_NE(error_of(file).find("with all its instances"), std::string::npos);
}

TEST(GltfBadInput, MutatedFilesAreAcceptedOrRefused) {
    const std::string whole = square_file().binary();
    const std::string path = temporary_path("scene.glb");
    for (std::uint64_t trial = 0; trial < 300; ++trial) {
        core::Rng rng(1, trial, 0);
        std::string bytes = whole;
        for (std::uint64_t i = 0; i <= trial % 3; ++i) {
            bytes[rng.next_bits() % bytes.size()] = static_cast<char>(rng.next_bits());
        }
        write_bytes(path, bytes);
        expect_no_crash(path);
    }
}

}  // namespace
