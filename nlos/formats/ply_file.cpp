// SPDX-License-Identifier: MIT
#include "nlos/formats/ply_file.h"

#include "nlos/containers/file_memory.h"
#include "nlos/containers/stored_number.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/output_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <span>
#include <sstream>

namespace nlos {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY bodies are read and written as is");

using core::Error;
using core::Vec3;

/// Both spellings that programs use for each type.
struct ScalarName {
    const char* name;
    const char* other;
    StoredNumber number;
};
constexpr std::array<ScalarName, 8> kScalarNames{{{"char", "int8", StoredNumber::Int8},
                                                  {"uchar", "uint8", StoredNumber::UInt8},
                                                  {"short", "int16", StoredNumber::Int16},
                                                  {"ushort", "uint16", StoredNumber::UInt16},
                                                  {"int", "int32", StoredNumber::Int32},
                                                  {"uint", "uint32", StoredNumber::UInt32},
                                                  {"float", "float32", StoredNumber::Float32},
                                                  {"double", "float64", StoredNumber::Float64}}};

struct Property {
    std::string name;
    StoredNumber type;
    std::optional<StoredNumber> list_count;  ///< type of the length of a list
};

struct Element {
    std::string name;
    std::size_t count;
    std::vector<Property> properties;
};

struct Header {
    bool ascii;
    std::vector<Element> elements;
    std::size_t body_begin;
};

[[noreturn]] void throw_damaged(const std::string& path, const std::string& found) {
    throw Error(path, found, "must be a complete PLY file, ASCII or binary little endian");
}

StoredNumber parse_scalar(const std::string& path, const std::string& name) {
    for (const ScalarName& known : kScalarNames) {
        if (name == known.name || name == known.other) return known.number;
    }
    throw_damaged(path, "has a property of unknown type '" + name.substr(0, 20) + "'");
}

void parse_header_line(const std::string& path, const std::string& line, Header& header) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
        words >> word;
        if (word != "ascii" && word != "binary_little_endian") {
            throw_damaged(path, "has format '" + word.substr(0, 30) + "'");
        }
        header.ascii = word == "ascii";
    } else if (word == "element") {
        Element element{};
        if (!(words >> element.name >> element.count)) throw_damaged(path, "has a damaged header");
        header.elements.push_back(element);
    } else if (word == "property") {
        if (header.elements.empty()) throw_damaged(path, "has a property outside elements");
        Property property{};
        words >> word;
        if (word == "list") {
            words >> word;
            property.list_count = parse_scalar(path, word);
            words >> word;
        }
        property.type = parse_scalar(path, word);
        words >> property.name;
        header.elements.back().properties.push_back(property);
    } else if (word != "comment" && word != "obj_info" && !word.empty()) {
        throw_damaged(path, "has a damaged header");
    }
}

Header parse_header(const std::string& path, std::string_view text) {
    Header header{};
    std::size_t begin = 0;
    for (bool first = true;; first = false) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string_view::npos)
            throw_damaged(path, first ? "is no PLY file" : "is cut short");
        std::string line(text.substr(begin, end - begin));
        if (line.ends_with('\r')) line.pop_back();
        begin = end + 1;
        if (first && line != "ply") throw_damaged(path, "is no PLY file");
        if (line == "end_header") break;
        if (!first) parse_header_line(path, line, header);
    }
    header.body_begin = begin;
    return header;
}

/// Hands out the numbers of a body one after the other.
class Body {
 public:
    Body(const std::string& path, std::string_view text, const Header& header)
        : path_(path), ascii_(header.ascii), rest_(text.substr(header.body_begin)) {}

    double next(StoredNumber type) { return ascii_ ? next_token() : next_bytes(type); }

    /// Throws unless `count` items of at least `bytes` each can still follow.
    void expect(std::size_t count, std::size_t bytes) const {
        const std::size_t least = ascii_ ? 1 : bytes;
        if (count > rest_.size() / std::max<std::size_t>(1, least))
            throw_damaged(path_, "is cut short");
    }

 private:
    double next_token() {
        const std::size_t begin = rest_.find_first_not_of(" \t\r\n");
        if (begin == std::string_view::npos) throw_damaged(path_, "is cut short");
        rest_.remove_prefix(begin);
        double value = 0.0;
        const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
        if (error != std::errc{}) throw_damaged(path_, "holds a word that is no number");
        rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
        return value;
    }

    double next_bytes(StoredNumber type) {
        const std::size_t size = bytes_of(type);
        if (rest_.size() < size) throw_damaged(path_, "is cut short");
        const double value = number_at(rest_.data(), type, std::endian::little);
        rest_.remove_prefix(size);
        return value;
    }

    const std::string& path_;
    bool ascii_;
    std::string_view rest_;
};

/// Reads one property of one item: a number, or a list of them.
void read_property(const Property& property, Body& body, std::vector<double>& values) {
    std::size_t count = 1;
    if (property.list_count) {
        const double length = body.next(*property.list_count);
        count = length >= 0.0 && length < 1e9 ? static_cast<std::size_t>(length) : 0;
        body.expect(count, bytes_of(property.type));
    }
    values.clear();
    for (std::size_t i = 0; i < count; ++i) values.push_back(body.next(property.type));
}

void add_polygon(const std::string& path,
                 const std::vector<double>& corners,
                 core::TriangleMesh& mesh) {
    for (const double corner : corners) {
        if (!(corner >= 0.0) || corner >= static_cast<double>(mesh.vertices.size())) {
            throw Error(path,
                        fmt::format("has a face with vertex {}", corner),
                        fmt::format("must be below the {} vertices", mesh.vertices.size()));
        }
    }
    const auto corner = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
    for (std::size_t i = 2; i < corners.size(); ++i) {
        mesh.triangles.push_back({corner(0), corner(i - 1), corner(i)});
    }
}

/// Which coordinate a vertex property is: 0 to 2 position, 3 to 5 normal.
std::optional<std::size_t> coordinate_of(const Property& property) {
    constexpr std::array<const char*, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
    const auto found = std::find(kNames.begin(), kNames.end(), property.name);
    if (found == kNames.end() || property.list_count) return std::nullopt;
    return static_cast<std::size_t>(found - kNames.begin());
}

void read_vertices(const std::string& path,
                   const Element& element,
                   Body& body,
                   core::TriangleMesh& mesh) {
    std::array<bool, 6> present{};
    for (const Property& property : element.properties) {
        if (const auto coordinate = coordinate_of(property)) present[*coordinate] = true;
    }
    if (!present[0] || !present[1] || !present[2])
        throw_damaged(path, "has vertices without x, y, z");
    const bool has_normals = present[3] && present[4] && present[5];
    std::vector<double> values;
    for (std::size_t i = 0; i < element.count; ++i) {
        std::array<double, 6> vertex{};
        for (const Property& property : element.properties) {
            read_property(property, body, values);
            if (const auto coordinate = coordinate_of(property)) vertex[*coordinate] = values[0];
        }
        for (const double value : vertex) {
            if (!std::isfinite(value)) {
                throw Error(
                    path, fmt::format("vertex {} is not finite", i), "must be finite numbers");
            }
        }
        mesh.vertices.emplace_back(vertex[0], vertex[1], vertex[2]);
        if (has_normals) mesh.normals.emplace_back(vertex[3], vertex[4], vertex[5]);
    }
}

void read_element(const std::string& path,
                  const Element& element,
                  Body& body,
                  core::TriangleMesh& mesh) {
    std::size_t min_bytes = 0;
    for (const Property& property : element.properties) {
        min_bytes += bytes_of(property.list_count.value_or(property.type));
    }
    body.expect(element.count, min_bytes);
    if (element.name == "vertex") return read_vertices(path, element, body, mesh);
    std::vector<double> values;
    for (std::size_t i = 0; i < element.count; ++i) {
        for (const Property& property : element.properties) {
            read_property(property, body, values);
            const bool is_polygon =
                property.name == "vertex_indices" || property.name == "vertex_index";
            if (element.name == "face" && is_polygon) add_polygon(path, values, mesh);
        }
    }
}

void write_body(const std::string& path,
                const std::vector<Vec3>& positions,
                const std::vector<Vec3>& normals,
                std::span<const std::array<std::uint32_t, 3>> triangles) {
    core::OutputFile output(path);
    std::ofstream file(output.temporary(), std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\ncomment metres\n";
    file << "element vertex " << positions.size() << "\n";
    for (const char* name : {"x", "y", "z"}) file << "property float " << name << "\n";
    for (const char* name : {"nx", "ny", "nz"}) {
        if (!normals.empty()) file << "property float " << name << "\n";
    }
    if (!triangles.empty()) {
        file << "element face " << triangles.size()
             << "\nproperty list uchar uint vertex_indices\n";
    }
    file << "end_header\n";
    const auto write_vector = [&](const Vec3& vector) {
        const Eigen::Vector3f single = vector.cast<float>();
        file.write(reinterpret_cast<const char*>(single.data()), sizeof(single));
    };
    for (std::size_t i = 0; i < positions.size(); ++i) {
        write_vector(positions[i]);
        if (!normals.empty()) write_vector(normals[i]);
    }
    for (const auto& triangle : triangles) {
        file.put(3);
        file.write(reinterpret_cast<const char*>(triangle.data()), sizeof(triangle));
    }
    file.close();
    if (!file) throw core::Failure(path, "cannot be written (disk full?)");
    output.commit();
}

}  // namespace

core::TriangleMesh read_ply(const std::string& path) {
    const core::MappedFile file(path, "must be a readable PLY file");
    const std::string_view text = file.bytes();
    const Header header = parse_header(path, text);
    file.require_stored();
    // At most a position and a normal for every few bytes of the text.
    require_memory(7 * text.size(), path);
    Body body(path, text, header);
    core::TriangleMesh mesh;
    for (const Element& element : header.elements) read_element(path, element, body, mesh);
    return mesh;
}

void write_ply(const std::string& path, const core::PointCloud& points) {
    write_body(path, points.positions, points.normals, {});
}

void write_ply(const std::string& path, const core::TriangleMesh& mesh) {
    write_body(path, mesh.vertices, mesh.normals, mesh.triangles);
}

}  // namespace nlos
