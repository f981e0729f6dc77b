// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/mesh_formats/file_words.h"
#include "renderer/core/mesh_formats/mesh_formats.h"
#include "renderer/core/mesh_formats/polygons.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <sstream>

namespace core {
namespace {

/// A type of numbers, with both names that programs use for it.
struct Scalar {
    const char* name;
    const char* other;
    std::size_t bytes;
    double (*read)(const char* stored, std::endian order);
};

template <class T>
double read_as(const char* stored, std::endian order) {
    std::array<char, sizeof(T)> bytes;
    std::copy_n(stored, sizeof(T), bytes.begin());
    if (order != std::endian::native) std::ranges::reverse(bytes);
    return static_cast<double>(std::bit_cast<T>(bytes));
}

template <class T>
constexpr Scalar scalar(const char* name, const char* other) {
    return {name, other, sizeof(T), &read_as<T>};
}

constexpr const char* kFaceColoursNotModelled = "the colours of its faces are not modelled";

constexpr std::array kScalars{scalar<std::int8_t>("char", "int8"),
                              scalar<std::uint8_t>("uchar", "uint8"),
                              scalar<std::int16_t>("short", "int16"),
                              scalar<std::uint16_t>("ushort", "uint16"),
                              scalar<std::int32_t>("int", "int32"),
                              scalar<std::uint32_t>("uint", "uint32"),
                              scalar<float>("float", "float32"),
                              scalar<double>("double", "float64")};

struct Property {
    std::string name;
    const Scalar* type;
    const Scalar* list_count = nullptr;  ///< type of the length of a list; null for a number
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;

    bool has(std::string_view property) const {
        return std::ranges::find(properties, property, &Property::name) != properties.end();
    }
};

struct Header {
    std::optional<std::endian> order;  ///< of binary numbers; none in text
    std::vector<Element> elements;
    bool has_texture = false;
};

const Scalar* find_scalar(const std::string& path, const std::string& name) {
    for (const Scalar& known : kScalars) {
        if (name == known.name || name == known.other) return &known;
    }
    throw_damaged(path, "has a property of unknown type " + excerpt(name));
}

std::optional<std::endian> byte_order(const std::string& path, const std::string& format) {
    if (format == "ascii") return std::nullopt;
    if (format == "binary_little_endian") return std::endian::little;
    if (format == "binary_big_endian") return std::endian::big;
    throw_damaged(path, "has format " + excerpt(format));
}

void parse_header_line(const std::string& path, const std::string& line, Header& header) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
        words >> word;
        header.order = byte_order(path, word);
    } else if (word == "element") {
        Element element;
        if (!(words >> element.name >> element.count)) throw_damaged(path, "has a damaged header");
        header.elements.push_back(element);
    } else if (word == "property") {
        if (header.elements.empty()) throw_damaged(path, "has a property outside elements");
        Property property{};
        words >> word;
        if (word == "list") {
            words >> word;
            property.list_count = find_scalar(path, word);
            words >> word;
        }
        property.type = find_scalar(path, word);
        words >> property.name;
        header.elements.back().properties.push_back(property);
    } else if (word == "comment") {
        words >> word;
        header.has_texture = header.has_texture || word == "TextureFile";
    } else if (word != "obj_info" && !word.empty()) {
        throw_damaged(path, "has a damaged header");
    }
}

/// Takes the header off a text, so that the body is left.
Header take_header(const std::string& path, std::string_view& text) {
    Header header;
    if (trimmed(take_line(text)) != "ply") throw_damaged(path, "is no PLY file");
    bool has_format = false;
    for (;;) {
        const std::string line(trimmed(take_line(text)));
        if (line == "end_header") break;
        if (text.empty()) throw_damaged(path, "is cut short");
        has_format = has_format || line.starts_with("format");
        parse_header_line(path, line, header);
    }
    if (!has_format) throw_damaged(path, "does not say its format");
    return header;
}

/// Hands out the numbers of a body one after the other.
class Body {
 public:
    Body(const std::string& path, std::string_view text, std::optional<std::endian> order)
        : path_(path), rest_(text), order_(order) {}

    double next(const Scalar& type) {
        if (order_) return next_bytes(type);
        const std::string_view word = take_word(rest_);
        if (word.empty()) throw_damaged(path_, "is cut short");
        const std::optional<double> number = number_of(word);
        if (!number) throw_damaged(path_, "holds " + excerpt(word) + ", which is no number");
        return *number;
    }

    /// Throws unless `count` items of at least `bytes` each can still follow.
    void expect(std::size_t count, std::size_t bytes) const {
        const std::size_t least = order_ ? std::max<std::size_t>(1, bytes) : 1;
        if (count > rest_.size() / least) throw_damaged(path_, "is cut short");
    }

 private:
    double next_bytes(const Scalar& type) {
        if (rest_.size() < type.bytes) throw_damaged(path_, "is cut short");
        const double value = type.read(rest_.data(), *order_);
        rest_.remove_prefix(type.bytes);
        return value;
    }

    const std::string& path_;
    std::string_view rest_;
    std::optional<std::endian> order_;
};

/// Reads the items of an element, and hands the values of each property to `take(property,
/// values)`: one of a number, any number of a list.
template <class Take>
void read_items(const std::string& path, const Element& element, Body& body, const Take& take) {
    std::size_t min_bytes = 0;
    for (const Property& property : element.properties) {
        min_bytes += (property.list_count ? property.list_count : property.type)->bytes;
    }
    body.expect(element.count, min_bytes);
    std::vector<double> values;
    for (std::size_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < element.properties.size(); ++p) {
            const Property& property = element.properties[p];
            const double count = property.list_count ? body.next(*property.list_count) : 1.0;
            if (!(count >= 0.0 && count <= 0xffffffff)) {
                throw_damaged(path, fmt::format("has a list of {} numbers", count));
            }
            body.expect(static_cast<std::size_t>(count), property.type->bytes);
            values.resize(static_cast<std::size_t>(count));
            for (double& value : values) value = body.next(*property.type);
            take(p, std::span<const double>(values));
        }
    }
}

void read_vertices(const std::string& path, const Element& element, Body& body, FileMesh& file) {
    constexpr std::array<const char*, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
    std::array<std::size_t, 6> present{};
    std::vector<std::size_t> coordinates;  // of each property: a place in kNames, or behind them
    for (const Property& property : element.properties) {
        const auto name =
            property.list_count ? kNames.end() : std::ranges::find(kNames, property.name);
        coordinates.push_back(static_cast<std::size_t>(name - kNames.begin()));
        if (name != kNames.end()) ++present[coordinates.back()];
    }
    for (std::size_t c = 0; c < 3; ++c) {
        if (present[c] == 0) throw_damaged(path, "has vertices without x, y, z");
    }
    if (element.has("red") || element.has("diffuse_red")) {
        file.warnings.emplace_back(kColoursNotModelled);
    }
    bool has_normals = present[3] > 0 && present[4] > 0 && present[5] > 0;
    std::array<double, 7> vertex{};
    read_items(path, element, body, [&](std::size_t p, std::span<const double> values) {
        if (!values.empty()) vertex[coordinates[p]] = values[0];
        if (p + 1 < coordinates.size()) return;
        const Vec3 position(vertex[0], vertex[1], vertex[2]);
        const Vec3 normal(vertex[3], vertex[4], vertex[5]);
        has_normals = has_normals && normal.allFinite();
        file.mesh.vertices.push_back(position);
        if (has_normals) file.mesh.normals.push_back(normal);
    });
    if (file.mesh.normals.size() != file.mesh.vertices.size()) file.mesh.normals.clear();
}

std::uint32_t vertex_number(const std::string& path, double value) {
    if (value >= 0.0 && value <= 0xffffffff && value == std::floor(value)) {
        return static_cast<std::uint32_t>(value);
    }
    throw Error(path, fmt::format("has a face with vertex {}", value), "must be a whole number");
}

/// Every corner but the first two of a strip ends a triangle with the two before it, each the other
/// way round; -1 begins the next strip.
void add_strips(const std::string& path, std::span<const double> strips, Polygons& polygons) {
    std::size_t first = 0;
    for (std::size_t i = 0; i < strips.size(); ++i) {
        if (strips[i] == -1.0) first = i + 1;
        if (i < first + 2) continue;
        const bool is_odd = (i - first) % 2 == 1;
        for (const std::size_t corner : {is_odd ? i - 1 : i - 2, is_odd ? i - 2 : i - 1, i}) {
            polygons.corners.push_back(vertex_number(path, strips[corner]));
        }
        polygons.ends.push_back(polygons.corners.size());
    }
}

void read_faces(const std::string& path, const Element& element, Body& body, Polygons& polygons) {
    const bool are_strips = element.name == "tristrips";
    const auto is_list = [](const Property& property) {
        return property.list_count &&
               (property.name == "vertex_indices" || property.name == "vertex_index");
    };
    const auto list = std::ranges::find_if(element.properties, is_list);
    if (element.count > 0 && list == element.properties.end()) {
        throw_damaged(path, "has faces without vertex_indices");
    }
    const auto wanted = static_cast<std::size_t>(list - element.properties.begin());
    read_items(path, element, body, [&](std::size_t p, std::span<const double> values) {
        if (p != wanted) return;
        if (are_strips) return add_strips(path, values, polygons);
        for (const double value : values) polygons.corners.push_back(vertex_number(path, value));
        polygons.ends.push_back(polygons.corners.size());
    });
}

/// The vertices, normals, faces and triangle strips of a PLY file [Turk1994], as one part: ASCII or
/// binary of either byte order, any scalar types. Everything else is skipped.
FileMesh parse_ply(const std::string& path, std::string_view text) {
    const Header header = take_header(path, text);
    Body body(path, text, header.order);
    FileMesh file;
    if (header.has_texture) file.warnings.emplace_back("its texture is not modelled");
    Polygons polygons;
    for (const Element& element : header.elements) {
        if (element.name == "vertex") {
            read_vertices(path, element, body, file);
        } else if (element.name == "face" || element.name == "tristrips") {
            if (element.has("red")) file.warnings.emplace_back(kFaceColoursNotModelled);
            read_faces(path, element, body, polygons);
        } else {
            read_items(path, element, body, [](std::size_t, std::span<const double>) {});
        }
    }
    add_triangles(path, polygons, 0, polygons.ends.size(), file.mesh);
    file.parts.push_back({"", 0, file.mesh.triangles.size()});
    return file;
}

}  // namespace

const MeshFormat kPly{"PLY", ".ply", &parse_ply};

}  // namespace core
