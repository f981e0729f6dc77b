// SPDX-License-Identifier: MIT
#include "renderer/core/random.h"
#include "renderer/core/settings/json_file.h"
#include "tests/renderer/gltf/gltf_files.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
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

/// One value of the square's file that is spoilt, and what the message must name.
struct Mutation {
    const char* expected;
    const char* pointer;
    const char* value;  ///< JSON; empty: the value is removed
};

TEST(GltfBadInput, MessagesNameTheOffendingValue) {
    const Mutation mutations[]{
        {"asset", "/asset", ""},
        {"scene: found 4", "/scene", "4"},
        {"scenes[0].nodes: found 7", "/scenes/0/nodes", "[7]"},
        {"scenes[0].nodes: found -1", "/scenes/0/nodes", "[-1]"},
        {"nodes[0].mesh: found 1", "/nodes/0/mesh", "1"},
        {"nodes[0].mesh: found 4294967296", "/nodes/0/mesh", "4294967296"},
        {"nodes[0].mesh: found \"0\"", "/nodes/0/mesh", "\"0\""},
        {"nodes[0].matrix", "/nodes/0/matrix", "[1, 2]"},
        {"nodes[0].matrix: is not affine",
         "/nodes/0/matrix",
         "[1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"},
        {"nodes[0].translation", "/nodes/0/translation", "[1, \"2\", 3]"},
        {"nodes[0].rotation: has length 0", "/nodes/0/rotation", "[0, 0, 0, 0]"},
        {"nodes[0]: its vertices overflow",
         "/nodes/0/matrix",
         "[1.7e308, 0, 0, 0, 1.7e308, 0, 0, 0, 1.7e308, 0, 0, 0, 1.7e308, 0, 0, 1]"},
        {"nodes[0]: its mesh has no triangle with an area", "/nodes/0/scale", "[0, 1, 1]"},
        {"nodes[0]: is reached twice", "/nodes/0/children", "[0]"},
        {"nodes[1]: is reached twice", "/nodes", R"([{"mesh": 0, "children": [1, 1]}, {}])"},
        {"has no triangles", "/nodes/0/mesh", ""},
        {"has no triangles", "/meshes/0/primitives/0/mode", "0"},
        {"meshes[0].primitives[0]: found mode 7", "/meshes/0/primitives/0/mode", "7"},
        {"meshes[0].primitives: found []", "/meshes/0/primitives", "[]"},
        {"meshes[0].primitives[0]: has no attributes", "/meshes/0/primitives/0/attributes", ""},
        {"meshes[0].primitives[0]: has no POSITION",
         "/meshes/0/primitives/0/attributes",
         R"({"NORMAL": 0})"},
        {"meshes[0].primitives[0].attributes.POSITION: found 9",
         "/meshes/0/primitives/0/attributes/POSITION",
         "9"},
        {"meshes[0].primitives[0]: has 4 corners", "/meshes/0/primitives/0/mode", "4"},
        {"meshes[0].primitives[0].material: found 0", "/meshes/0/primitives/0/material", "0"},
        {"accessors[0]: is used for positions", "/accessors/0/type", "\"VEC4\""},
        {"accessors[0]: is used for positions", "/accessors/0/componentType", "5125"},
        {"Invalid `componentType`", "/accessors/0/componentType", "1"},
        {"accessors[0]: has 5 elements of 12 bytes every 12 bytes from byte 0",
         "/accessors/0/count",
         "5"},
        {"accessors[0]: has 4 elements of 12 bytes every 12 bytes from byte 4",
         "/accessors/0/byteOffset",
         "4"},
        {"accessors[0]: has", "/accessors/0/byteOffset", "2147483644"},
        {"accessors[0]: has 2147483647 elements of 12 bytes", "/accessors/0/count", "2147483647"},
        {"accessors[0].count", "/accessors/0/count", "0"},
        {"accessors[0].count", "/accessors/0/count", "18446744073709551615"},
        {"accessors[0].count", "/accessors/0/count", "3.5"},
        {"accessors[0]: has elements of 12 bytes every 4 bytes", "/bufferViews/0/byteStride", "4"},
        {"byteStride", "/bufferViews/0/byteStride", "254"},
        {"bufferViews[0]: ends at byte 49", "/bufferViews/0/byteLength", "49"},
        {"bufferViews[0]: ends at byte", "/bufferViews/0/byteOffset", "2147483647"},
        {"bufferViews[0].byteOffset", "/bufferViews/0/byteOffset", "18446744073709551615"},
        {"bufferViews[0].buffer: found 1", "/bufferViews/0/buffer", "1"},
        {"accessors[0].sparse", "/accessors/0/sparse", "3"},
        {"accessors[0].sparse.indices.bufferView: found 5",
         "/accessors/0/sparse",
         R"({"count": 1, "indices": {"bufferView": 5, "componentType": 5121},
             "values": {"bufferView": 0}})"},
        {"materials[0].pbrMetallicRoughness.baseColorFactor",
         "/materials",
         R"([{"pbrMetallicRoughness": {"baseColorFactor": [2, 0, 0, 1]}}])"},
        {"nodes[0].extras.nlos_rolle: found an unknown key; did you mean 'nlos_role'? known keys "
         "are nlos_role",
         "/nodes/0/extras",
         R"({"nlos_rolle": "hidden"})"},
        {"nodes[0].extras.nlos_role: found \"wall\"; must be one of hidden|relay_wall|back_wall",
         "/nodes/0/extras",
         R"({"nlos_role": "wall"})"},
        {"nodes[0].extras.nlos_velocity_m_per_s",
         "/nodes/0/extras",
         R"({"nlos_velocity_m_per_s": [1, 2]})"},
        {"nodes[0].extras.nlos_ellipsoidal_exclude: found 1",
         "/nodes/0/extras",
         R"({"nlos_ellipsoidal_exclude": 1})"},
        {"meshes[0].extras.nlos_role: is not on a node or a material",
         "/meshes/0/extras",
         R"({"nlos_role": "hidden"})"},
        {"extensionsRequired: found \"KHR_draco_mesh_compression\"",
         "/extensionsRequired",
         R"(["KHR_draco_mesh_compression"])"},
        {"meshes: found", "/meshes", "3"},
        {"nodes[0]: found", "/nodes/0", "\"node\""},
    };
    for (const Mutation& mutation : mutations) {
        GltfFile file = square_file();
        const Json::json_pointer pointer(mutation.pointer);
        if (*mutation.value) {
            file.json[pointer] = Json::parse(mutation.value);
        } else {
            file.json[pointer.parent_pointer()].erase(pointer.back());
        }
        EXPECT_NE(error_of(file).find(mutation.expected), std::string::npos)
            << "expected: " << mutation.expected << "\nmessage:  " << error_of(file);
    }
}

TEST(GltfBadInput, CyclesThatNoRootReachesLeaveNothing) {
    GltfFile file = square_file();
    file.json["nodes"].push_back({{"children", {0}}});
    file.json["nodes"][0]["children"] = {1};
    file.json.erase("scenes");
    file.json.erase("scene");
    EXPECT_NE(error_of(file).find("has no triangles"), std::string::npos);
}

TEST(GltfBadInput, IndicesMustBeWholeNumbersInRange) {
    GltfFile file = square_file();
    file.primitive()["indices"] =
        file.add_accessor(std::vector<std::uint16_t>{0, 1, 4}, kUShort, "SCALAR");
    EXPECT_NE(error_of(file).find("accessors[1]: index 4 is out of range"), std::string::npos);

    file = square_file();
    file.primitive()["indices"] = file.add_accessor(std::vector<float>{0, 1, 2}, kFloat, "SCALAR");
    EXPECT_NE(error_of(file).find("accessors[1]: is used for indices"), std::string::npos);
}

TEST(GltfBadInput, SparseElementsMustExist) {
    const auto message = [](const std::vector<std::uint8_t>& listed) {
        GltfFile file = square_file();
        const int indices = file.add_view(listed);
        const int values = file.add_view(std::vector<float>{0, 0, 0});
        file.json["accessors"][0]["sparse"] = {
            {"count", listed.size()},
            {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
            {"values", {{"bufferView", values}}}};
        return error_of(file);
    };
    EXPECT_NE(message({4}).find("accessors[0].sparse.indices: found 4"), std::string::npos);
    EXPECT_NE(message({0, 1}).find("accessors[0].sparse.values: has 2 elements"),
              std::string::npos);
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

TEST(GltfBadInput, ElementsThatAreNotStoredAreFew) {
    GltfFile file = square_file();
    Json& accessor = file.json["accessors"][0];
    accessor.erase("bufferView");
    accessor["count"] = 100'000'000;
    EXPECT_NE(error_of(file).find("100000000 elements and no bufferView"), std::string::npos);
}

TEST(GltfBadInput, NodesBeyondReasonAreRefused) {
    GltfFile file = square_file();
    for (int i = 0; i < 100'001; ++i) file.json["nodes"].push_back(Json::object());
    EXPECT_NE(error_of(file).find("a list of at most 100000 items"), std::string::npos);
}

TEST(GltfBadInput, PrimitivesThatShareALongListAreRead) {
    GltfFile file = square_file();
    const Json primitive = file.primitive();
    for (int i = 1; i < 5'000; ++i) file.json["meshes"][0]["primitives"].push_back(primitive);
    const auto geometry = file.load();
    EXPECT_EQ(geometry.objects.size(), 5'000U);
    EXPECT_EQ(geometry.objects.back().mesh.vertices, geometry.objects.front().mesh.vertices);
}

TEST(GltfBadInput, ExternalFilesAreRegularAndStored) {
    const std::string pipe = temporary_path("pipe");
    ::mkfifo(pipe.c_str(), 0600);
    std::filesystem::create_symlink("/dev/zero", temporary_path("zero"));
    const std::string holes = temporary_path("holes");
    write_bytes(holes, "");
    std::filesystem::resize_file(holes, 2'000'000'000);
    const auto error_with = [](const std::string& uri, std::size_t bytes) {
        GltfFile file = square_file();
        file.json["buffers"][0] = {{"uri", uri}, {"byteLength", bytes}};
        const std::string path = temporary_path("external.gltf");
        write_bytes(path, file.json.dump());
        return test_support::error_message([&] { renderer::load_gltf(path); });
    };
    EXPECT_NE(error_with("pipe", 1000).find("is no regular file"), std::string::npos);
    EXPECT_NE(error_with("zero", 1000).find("is no regular file"), std::string::npos);
    EXPECT_NE(error_with(".", 1000).find("is a folder"), std::string::npos);
    EXPECT_NE(error_with("holes", 1000).find("must have at most"), std::string::npos);
    EXPECT_NE(error_with("holes", 2'000'000'000).find("of which 0 are stored"), std::string::npos);
}

}  // namespace
