// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_accessor.h"

#include "renderer/core/error.h"
#include "renderer/core/process.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace renderer {
namespace {

template <int N>
using Elements = std::vector<Eigen::Matrix<double, N, 1>>;

/// Equally spaced elements inside a buffer view.
struct ElementRange {
    const unsigned char* first = nullptr;
    std::size_t stride = 0;
};

/// Which elements of a view an accessor (or one half of a sparse one) takes.
struct ElementLayout {
    std::size_t byte_offset = 0;
    std::size_t count = 0;
    std::size_t element_bytes = 0;
};

/// Finds elements in a buffer view. Throws Error when they do not fit into it.
ElementRange locate(const GltfDocument& document,
                    int view_index,
                    const ElementLayout& layout,
                    const std::string& where) {
    const tinygltf::BufferView& view =
        document.model->bufferViews[static_cast<std::size_t>(view_index)];
    const std::size_t stride = view.byteStride ? view.byteStride : layout.element_bytes;
    if (stride < layout.element_bytes) {
        throw core::Error(
            document.where(where),
            fmt::format("has elements of {} bytes every {} bytes", layout.element_bytes, stride),
            "byteStride must be at least the size of an element");
    }
    // Divides instead of multiplying, which could overflow.
    const bool fits =
        layout.byte_offset <= view.byteLength &&
        layout.element_bytes <= view.byteLength - layout.byte_offset &&
        layout.count - 1 <= (view.byteLength - layout.byte_offset - layout.element_bytes) / stride;
    if (!fits) {
        throw core::Error(document.where(where),
                          fmt::format("has {} elements of {} bytes every {} bytes from byte {}",
                                      layout.count,
                                      layout.element_bytes,
                                      stride,
                                      layout.byte_offset),
                          fmt::format("bufferViews[{}] has {} bytes", view_index, view.byteLength));
    }
    const tinygltf::Buffer& buffer = document.model->buffers[static_cast<std::size_t>(view.buffer)];
    return {buffer.data.data() + view.byteOffset + layout.byte_offset, stride};
}

template <class T>
T load_as(const unsigned char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
}

std::size_t component_bytes(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        default:
            return 4;
    }
}

/// One component as a number; normalised integers become fractions.
double decode_component(const unsigned char* bytes, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const double value = load_as<std::int8_t>(bytes);
            return normalized ? std::max(value / 127.0, -1.0) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
            const double value = load_as<std::uint8_t>(bytes);
            return normalized ? value / 255.0 : value;
        }
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const double value = load_as<std::int16_t>(bytes);
            return normalized ? std::max(value / 32767.0, -1.0) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
            const double value = load_as<std::uint16_t>(bytes);
            return normalized ? value / 65535.0 : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return load_as<std::uint32_t>(bytes);
        default:
            return static_cast<double>(load_as<float>(bytes));
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
    const auto count = static_cast<std::size_t>(sparse.count);
    const std::size_t bytes = component_bytes(accessor.componentType);
    const ElementRange indices = locate(document,
                                        sparse.indices.bufferView,
                                        {static_cast<std::size_t>(sparse.indices.byteOffset),
                                         count,
                                         component_bytes(sparse.indices.componentType)},
                                        where + ".sparse.indices");
    const ElementRange values =
        locate(document,
               sparse.values.bufferView,
               {static_cast<std::size_t>(sparse.values.byteOffset), count, N * bytes},
               where + ".sparse.values");
    for (std::size_t i = 0; i < count; ++i) {
        const auto index = static_cast<std::size_t>(decode_component(
            indices.first + i * indices.stride, sparse.indices.componentType, false));
        if (index >= elements.size()) {
            throw core::Error(document.where(where + ".sparse.indices"),
                              fmt::format("found {}", index),
                              fmt::format("must be below {}", elements.size()));
        }
        for (int c = 0; c < N; ++c) {
            const unsigned char* at =
                values.first + i * values.stride + static_cast<std::size_t>(c) * bytes;
            elements[index][c] = decode_component(at, accessor.componentType, accessor.normalized);
        }
    }
}

/// All elements of an accessor whose type the caller has checked; zeros where it has no data.
template <int N>
Elements<N> read_elements(const GltfDocument& document,
                          const tinygltf::Accessor& accessor,
                          const std::string& where) {
    const std::size_t bytes = component_bytes(accessor.componentType);
    ElementRange range;
    if (accessor.bufferView >= 0) {
        range = locate(
            document, accessor.bufferView, {accessor.byteOffset, accessor.count, N * bytes}, where);
    } else if (accessor.count > core::available_memory_bytes() / (4 * sizeof(double) * N)) {
        // Without a buffer view, a few bytes of file can ask for any number of zeros.
        throw core::Error(document.where(where),
                          fmt::format("has {} elements", accessor.count),
                          "must fit into a quarter of the free memory");
    }
    Elements<N> elements(accessor.count, Eigen::Matrix<double, N, 1>::Zero());
    for (std::size_t i = 0; range.first && i < accessor.count; ++i) {
        for (int c = 0; c < N; ++c) {
            const unsigned char* at =
                range.first + i * range.stride + static_cast<std::size_t>(c) * bytes;
            elements[i][c] = decode_component(at, accessor.componentType, accessor.normalized);
        }
    }
    if (accessor.sparse.isSparse) apply_sparse<N>(document, accessor, where, elements);
    return elements;
}

template <int N>
Elements<N> read_attribute(const GltfDocument& document, int index, const char* meaning) {
    const tinygltf::Accessor& accessor = document.model->accessors[static_cast<std::size_t>(index)];
    const std::string where = fmt::format("accessors[{}]", index);
    const int wanted = N == 2 ? TINYGLTF_TYPE_VEC2 : TINYGLTF_TYPE_VEC3;
    if (accessor.type != wanted || !is_attribute_type(accessor.componentType)) {
        throw core::Error(
            document.where(where),
            fmt::format("is used for {} and has another type (componentType {})",
                        meaning,
                        accessor.componentType),
            fmt::format("must be VEC{} of 5120, 5121, 5122, 5123 or 5126 (float)", N));
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

std::vector<core::Vec3> read_positions(const GltfDocument& document, int accessor) {
    return read_attribute<3>(document, accessor, "positions");
}

std::vector<core::Vec2> read_texture_coordinates(const GltfDocument& document, int accessor) {
    return read_attribute<2>(document, accessor, "texture coordinates");
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
