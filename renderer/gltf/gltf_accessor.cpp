// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/gltf/gltf_document.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

namespace renderer {
namespace {

template <int N>
using Elements = std::vector<Eigen::Matrix<double, N, 1>>;

/// Equally spaced elements inside a buffer view.
struct ElementRange {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
    std::size_t component_bytes = 0;
};

/// Finds an accessor's elements in its buffer view. Throws Error when they do not fit into it.
ElementRange locate(const GltfDocument& document,
                    const tinygltf::Accessor& accessor,
                    const std::string& where) {
    const tinygltf::BufferView& view =
        document.model->bufferViews[static_cast<std::size_t>(accessor.bufferView)];
    const auto component_bytes = static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
    const std::size_t bytes =
        component_bytes * static_cast<std::size_t>(tinygltf::GetNumComponentsInType(
                              static_cast<std::uint32_t>(accessor.type)));
    const std::size_t stride = view.byteStride ? view.byteStride : bytes;
    if (stride < bytes) {
        throw core::Error(document.where(where),
                          fmt::format("has elements of {} bytes every {} bytes", bytes, stride),
                          "byteStride must be at least the size of an element");
    }
    // Divides instead of multiplying, which could overflow.
    const bool fits =
        accessor.byteOffset <= view.byteLength && bytes <= view.byteLength - accessor.byteOffset &&
        accessor.count - 1 <= (view.byteLength - accessor.byteOffset - bytes) / stride;
    if (!fits) {
        throw core::Error(
            document.where(where),
            fmt::format("has {} elements of {} bytes every {} bytes from byte {}",
                        accessor.count,
                        bytes,
                        stride,
                        accessor.byteOffset),
            fmt::format("bufferViews[{}] has {} bytes", accessor.bufferView, view.byteLength));
    }
    const tinygltf::Buffer& buffer = document.model->buffers[static_cast<std::size_t>(view.buffer)];
    return {buffer.data.data() + view.byteOffset + accessor.byteOffset, stride, component_bytes};
}

/// A component as a number; normalized integers become fractions.
template <class T>
double decode(const unsigned char* bytes, bool normalized) {
    T stored;
    std::memcpy(&stored, bytes, sizeof(T));
    const auto value = static_cast<double>(stored);
    if (!normalized || !std::is_integral_v<T>) return value;
    return std::max(value / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
}

double decode_component(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return decode<std::int8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return decode<std::uint8_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return decode<std::int16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return decode<std::uint16_t>(bytes, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return decode<std::uint32_t>(bytes, normalized);
        default:
            return decode<float>(bytes, normalized);
    }
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

bool is_attribute_type(int type) {
    return (type >= TINYGLTF_COMPONENT_TYPE_BYTE &&
            type <= TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) ||
           type == TINYGLTF_COMPONENT_TYPE_FLOAT;
}

template <int N>
Elements<N> read_elements(const GltfDocument& document,
                          const tinygltf::Accessor& accessor,
                          const std::string& where);

/// Overwrites the elements that a sparse accessor lists.
template <int N>
void apply_sparse(const GltfDocument& document,
                  const tinygltf::Accessor& accessor,
                  const std::string& where,
                  Elements<N>& elements) {
    const auto& sparse = accessor.sparse;
    if (!is_index_type(sparse.indices.componentType)) {
        throw core::Error(document.where(where + ".sparse.indices"),
                          fmt::format("found componentType {}", sparse.indices.componentType),
                          "must be 5121, 5123 or 5125");
    }
    // Both halves are dense accessors without a name of their own.
    tinygltf::Accessor half;
    half.count = static_cast<std::size_t>(sparse.count);
    half.bufferView = sparse.indices.bufferView;
    half.byteOffset = static_cast<std::size_t>(sparse.indices.byteOffset);
    half.componentType = sparse.indices.componentType;
    half.type = TINYGLTF_TYPE_SCALAR;
    const auto indices = read_elements<1>(document, half, where + ".sparse.indices");
    half.bufferView = sparse.values.bufferView;
    half.byteOffset = static_cast<std::size_t>(sparse.values.byteOffset);
    half.componentType = accessor.componentType;
    half.type = accessor.type;
    half.normalized = accessor.normalized;
    const auto values = read_elements<N>(document, half, where + ".sparse.values");
    for (std::size_t i = 0; i < half.count; ++i) {
        const auto index = static_cast<std::size_t>(indices[i][0]);
        if (index >= elements.size()) {
            throw core::Error(document.where(where + ".sparse.indices"),
                              fmt::format("found {}", index),
                              fmt::format("must be below {}", elements.size()));
        }
        elements[index] = values[i];
    }
}

// Fewer elements than that take no time or memory worth a check of their own.
constexpr std::size_t kMany = 1'000'000;

/// A few bytes of file can ask for any number of zeros.
void check_unstored(const GltfDocument& document,
                    const tinygltf::Accessor& accessor,
                    const std::string& where) {
    if (accessor.count <= kMany) return;
    throw core::Error(document.where(where),
                      fmt::format("has {} elements and no bufferView", accessor.count),
                      fmt::format("must have at most {} without one", kMany));
}

/// All elements of an accessor whose type the caller has checked; zeros where it has no data.
template <int N>
Elements<N> read_elements(const GltfDocument& document,
                          const tinygltf::Accessor& accessor,
                          const std::string& where) {
    ElementRange range;
    if (accessor.bufferView >= 0) {
        range = locate(document, accessor, where);
    } else {
        check_unstored(document, accessor, where);
    }
    Elements<N> elements(accessor.count, Eigen::Matrix<double, N, 1>::Zero());
    for (std::size_t i = 0; range.first && i < accessor.count; ++i) {
        for (int c = 0; c < N; ++c) {
            const unsigned char* at = range.first + i * range.stride +
                                      static_cast<std::size_t>(c) * range.component_bytes;
            elements[i][c] = decode_component(at, accessor.componentType, accessor.normalized);
        }
    }
    if (accessor.sparse.isSparse) apply_sparse<N>(document, accessor, where, elements);
    return elements;
}

/// The type of elements of N numbers, with its name.
template <int N>
constexpr std::pair<int, const char*> kTypeOf{};
template <>
constexpr std::pair<int, const char*> kTypeOf<2>{TINYGLTF_TYPE_VEC2, "VEC2"};
template <>
constexpr std::pair<int, const char*> kTypeOf<3>{TINYGLTF_TYPE_VEC3, "VEC3"};
template <>
constexpr std::pair<int, const char*> kTypeOf<4>{TINYGLTF_TYPE_VEC4, "VEC4"};
template <>
constexpr std::pair<int, const char*> kTypeOf<16>{TINYGLTF_TYPE_MAT4, "MAT4"};

template <int N>
Elements<N> read_attribute(const GltfDocument& document, int index, const char* meaning) {
    const tinygltf::Accessor& accessor = document.model->accessors[static_cast<std::size_t>(index)];
    const std::string where = fmt::format("accessors[{}]", index);
    const auto& [wanted, name] = kTypeOf<N>;
    if (accessor.type != wanted || !is_attribute_type(accessor.componentType)) {
        throw core::Error(
            document.where(where),
            fmt::format("is used for {} and has another type (componentType {})",
                        meaning,
                        accessor.componentType),
            fmt::format("must be {} of 5120, 5121, 5122, 5123 or 5126 (float)", name));
    }
    Elements<N> elements = read_elements<N>(document, accessor, where);
    for (std::size_t i = 0; i < elements.size(); ++i) {
        if (!elements[i].allFinite()) {
            throw core::Error(document.where(where),
                              fmt::format("element {} is not finite", i),
                              fmt::format("{} must be finite numbers", meaning));
        }
    }
    return elements;
}

}  // namespace

std::size_t checked_count(const GltfDocument& document, int index) {
    const tinygltf::Accessor& accessor = document.model->accessors[static_cast<std::size_t>(index)];
    const std::string where = fmt::format("accessors[{}]", index);
    if (accessor.bufferView < 0) {
        check_unstored(document, accessor, where);
    } else if (accessor.count > kMany) {
        locate(document, accessor, where);
    }
    return accessor.count;
}

std::vector<core::Vec3> read_positions(const GltfDocument& document, int accessor) {
    return read_attribute<3>(document, accessor, "positions");
}

std::vector<core::Vec2> read_texture_coordinates(const GltfDocument& document, int accessor) {
    return read_attribute<2>(document, accessor, "texture coordinates");
}

std::vector<core::Vec3> read_colours(const GltfDocument& document, int accessor) {
    if (document.model->accessors[static_cast<std::size_t>(accessor)].type != TINYGLTF_TYPE_VEC4) {
        return read_attribute<3>(document, accessor, "colours");
    }
    std::vector<core::Vec3> colours;
    for (const auto& colour : read_attribute<4>(document, accessor, "colours")) {
        colours.emplace_back(colour.head<3>());
    }
    return colours;
}

std::vector<Eigen::Vector4d> read_vectors4(const GltfDocument& document, int accessor) {
    return read_attribute<4>(document, accessor, "rotations, joints or weights");
}

std::vector<Eigen::Matrix4d> read_matrices(const GltfDocument& document, int accessor) {
    std::vector<Eigen::Matrix4d> matrices;
    for (const auto& numbers : read_attribute<16>(document, accessor, "matrices")) {
        matrices.emplace_back(Eigen::Map<const Eigen::Matrix4d>(numbers.data()));
    }
    return matrices;
}

std::vector<std::uint32_t> read_indices(const GltfDocument& document,
                                        int index,
                                        std::size_t num_vertices) {
    const tinygltf::Accessor& accessor = document.model->accessors[static_cast<std::size_t>(index)];
    const std::string where = fmt::format("accessors[{}]", index);
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index_type(accessor.componentType) ||
        accessor.normalized) {
        throw core::Error(document.where(where),
                          fmt::format("is used for indices and has another type (componentType {})",
                                      accessor.componentType),
                          "must be SCALAR of 5121, 5123 or 5125, not normalized");
    }
    const Elements<1> elements = read_elements<1>(document, accessor, where);
    std::vector<std::uint32_t> indices;
    indices.reserve(elements.size());
    for (const auto& element : elements) {
        if (element[0] >= static_cast<double>(num_vertices)) {
            throw core::Error(document.where(where),
                              fmt::format("index {} is out of range", element[0]),
                              fmt::format("the primitive has {} vertices", num_vertices));
        }
        indices.push_back(static_cast<std::uint32_t>(element[0]));
    }
    return indices;
}

}  // namespace renderer
