// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/gltf/gltf.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

namespace gltf_test {

using core::Json;

enum ComponentType { kByte = 5120, kUByte, kShort, kUShort, kInt, kUInt, kFloat };

/// A path in a folder that goes away with the test program.
inline std::string temporary_path(const std::string& name) {
    static const test_support::TemporaryFolder folder;
    return folder.file(name);
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string read_bytes(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::string base64(const std::string& bytes) {
    static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            const bool inside = i + j < bytes.size();
            group = (group << 8) | (inside ? static_cast<unsigned char>(bytes[i + j]) : 0u);
        }
        for (std::size_t j = 0; j < 4; ++j) {
            const bool padding = i + j > bytes.size();
            text += padding ? '=' : kDigits[(group >> (18 - 6 * j)) & 63];
        }
    }
    return text;
}

/// A glTF file under construction: JSON to edit freely, and one buffer.
struct GltfFile {
    Json json = Json::parse(R"({"asset": {"version": "2.0"}})");
    std::string bytes;

    /// Appends values on a 4-byte boundary as a buffer view; returns its index.
    template <class T>
    int add_view(const std::vector<T>& values) {
        bytes.resize((bytes.size() + 3) / 4 * 4);
        const std::size_t offset = bytes.size();
        bytes.resize(offset + values.size() * sizeof(T));
        std::memcpy(bytes.data() + offset, values.data(), values.size() * sizeof(T));
        json["bufferViews"].push_back(
            {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", values.size() * sizeof(T)}});
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }

    template <class T>
    int add_accessor(const std::vector<T>& values,
                     ComponentType component_type,
                     const std::string& type) {
        const auto side = static_cast<std::size_t>(type[3] - '0');
        const std::size_t width = type == "SCALAR" ? 1 : type[0] == 'M' ? side * side : side;
        const int view = add_view(values);
        json["accessors"].push_back({{"bufferView", view},
                                     {"componentType", static_cast<int>(component_type)},
                                     {"count", values.size() / width},
                                     {"type", type}});
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    Json& primitive() { return json["meshes"][0]["primitives"][0]; }

    std::string text() const {
        Json whole = json;
        whole["buffers"] = {{{"byteLength", bytes.size()},
                             {"uri", "data:application/octet-stream;base64," + base64(bytes)}}};
        return whole.dump();
    }

    std::string binary() const {
        Json whole = json;
        whole["buffers"] = {{{"byteLength", bytes.size()}}};
        std::string chunk0 = whole.dump();
        chunk0.resize((chunk0.size() + 3) / 4 * 4, ' ');
        std::string chunk1 = bytes;
        chunk1.resize((chunk1.size() + 3) / 4 * 4);
        const auto word = [](std::size_t value) {
            std::string text(4, '\0');
            for (std::size_t i = 0; i < 4; ++i) text[i] = static_cast<char>(value >> (8 * i));
            return text;
        };
        return "glTF" + word(2) + word(12 + 8 + chunk0.size() + 8 + chunk1.size()) +
               word(chunk0.size()) + "JSON" + chunk0 + word(chunk1.size()) +
               std::string("BIN\0", 4) + chunk1;
    }

    renderer::SceneGeometry load() const {
        const std::string path = temporary_path("scene.gltf");
        write_bytes(path, text());
        return renderer::load_gltf(path);
    }
};

/// Four corners of the unit square, in the order of a triangle strip.
inline std::vector<float> square_positions() {
    return {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
}

/// A file with one node and one primitive on the four corners; no indices, a strip.
inline GltfFile square_file() {
    GltfFile file;
    const int positions = file.add_accessor(square_positions(), kFloat, "VEC3");
    file.json["meshes"] = Json::array(
        {Json{{"primitives",
               Json::array({Json{{"attributes", {{"POSITION", positions}}}, {"mode", 5}}})}}});
    file.json["nodes"] = Json::array({Json{{"mesh", 0}}});
    file.json["scenes"] = Json::array({Json{{"nodes", {0}}}});
    file.json["scene"] = 0;
    return file;
}

inline double total_area(const core::TriangleMesh& mesh) {
    double area = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        area +=
            core::triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]).norm();
    }
    return area;
}

/// What load_gltf says about a bad file: its one line, or a test failure.
inline std::string error_of(const std::string& path) {
    try {
        renderer::load_gltf(path);
    } catch (const core::Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        EXPECT_TRUE(message.starts_with(path)) << message;
        return message;
    }
    ADD_FAILURE() << path << " was accepted";
    return "";
}

inline std::string error_of(const GltfFile& file) {
    const std::string path = temporary_path("scene.gltf");
    write_bytes(path, file.text());
    return error_of(path);
}

}  // namespace gltf_test
