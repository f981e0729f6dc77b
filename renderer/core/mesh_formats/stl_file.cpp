// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/file_words.h"
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/nearest_name.h"

#include <fmt/core.h>

#include <cstring>

namespace core {
namespace {

// Binary: a header, the number of triangles, and for each its normal, corners and attributes.
constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kBodyBegin = kHeaderBytes + sizeof(std::uint32_t);
constexpr std::size_t kNormalBytes = 3 * sizeof(float);
constexpr std::size_t kTriangleBytes = 4 * kNormalBytes + sizeof(std::uint16_t);

/// The triangle of the last three vertices.
void add_triangle(TriangleMesh& mesh) {
    const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

template <class T>
T stored(std::string_view text, std::size_t at) {
    T value;
    std::memcpy(&value, text.data() + at, sizeof(T));
    return value;
}

std::size_t declared_triangles(std::string_view text) {
    return text.size() < kBodyBegin ? 0 : stored<std::uint32_t>(text, kHeaderBytes);
}

FileMesh parse_binary(std::string_view text) {
    FileMesh file;
    bool has_colours = text.substr(0, kHeaderBytes).find("COLOR=") != text.npos;
    for (std::size_t at = kBodyBegin; at < text.size(); at += kTriangleBytes) {
        for (std::size_t c = 1; c <= 3; ++c) {
            const auto corner = stored<std::array<float, 3>>(text, at + c * kNormalBytes);
            file.mesh.vertices.emplace_back(corner[0], corner[1], corner[2]);
        }
        add_triangle(file.mesh);
        constexpr unsigned kHasColour = 0x8000;
        const auto attributes = stored<std::uint16_t>(text, at + 4 * kNormalBytes);
        has_colours = has_colours || (attributes & kHasColour) != 0;
    }
    if (has_colours) file.warnings.emplace_back(kColoursNotModelled);
    file.parts.push_back({"", 0, file.mesh.triangles.size()});
    return file;
}

Vec3 take_vertex(const std::string& path, std::string_view& text) {
    Vec3 vertex;
    for (double& coordinate : vertex) {
        const std::string_view word = take_word(text);
        const std::optional<double> number = number_of(word);
        if (word.empty()) throw_damaged(path, "is cut short");
        if (!number) throw_damaged(path, "holds " + excerpt(word) + ", which is no number");
        coordinate = *number;
    }
    return vertex;
}

FileMesh parse_text(const std::string& path, std::string_view text) {
    FileMesh file;
    TriangleMesh& mesh = file.mesh;
    bool is_in_solid = false;
    for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
        const std::string keyword = lower_case(std::string(word));
        if (keyword == "solid") {
            std::string_view line = take_line(text);
            file.parts.push_back({std::string(take_word(line)), 0, mesh.triangles.size()});
            is_in_solid = true;
        } else if (keyword == "vertex") {
            mesh.vertices.push_back(take_vertex(path, text));
        } else if (keyword == "endfacet" && is_in_solid) {
            if (mesh.vertices.size() != 3 * mesh.triangles.size() + 3) {
                throw_damaged(path, "has a facet that is no triangle");
            }
            add_triangle(mesh);
            file.parts.back().end = mesh.triangles.size();
        } else if (keyword == "endsolid") {
            is_in_solid = false;
            take_line(text);  // its name
        } else if (keyword == "normal") {
            for (int i = 0; i < 3; ++i) take_word(text);  // the corners tell it, too
        } else if (keyword != "facet" && keyword != "outer" && keyword != "loop" &&
                   keyword != "endloop") {
            throw_damaged(path, "holds " + excerpt(word) + " where a facet should stand");
        }
    }
    if (is_in_solid) throw_damaged(path, "is cut short");
    return file;
}

FileMesh parse_stl(const std::string& path, std::string_view text) {
    const std::size_t count = declared_triangles(text);
    const std::size_t expected = kBodyBegin + count * kTriangleBytes;
    if (text.size() == expected) return parse_binary(text);
    std::string_view start = text.substr(0, kBodyBegin);
    const bool is_text =
        start.find('\0') == start.npos && lower_case(std::string(take_word(start))) == "solid";
    if (is_text) return parse_text(path, text);
    if (text.size() < kBodyBegin) throw_damaged(path, "is no STL file");
    throw_damaged(path,
                  fmt::format("{}: of {} triangles, which are {} bytes, it has {} bytes",
                              text.size() < expected ? "is cut short" : "has a damaged length",
                              count,
                              expected,
                              text.size()));
}

}  // namespace

const MeshFormat kStl{"STL", ".stl", &parse_stl};

}  // namespace core
