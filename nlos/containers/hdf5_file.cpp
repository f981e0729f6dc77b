// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_file.h"

#include "nlos/containers/file_memory.h"
#include "renderer/core/error.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <type_traits>
#include <vector>

namespace nlos {
namespace {

using core::Json;

[[noreturn]] void throw_unreadable(const std::string& where) {
    throw core::Error(where, "cannot be read", "must be an undamaged, complete file");
}

Shape extents_of(const Hdf5Handle& space, const std::string& where) {
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 0) throw_unreadable(where);
    std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
    if (rank > 0 && H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr) < 0) {
        throw_unreadable(where);
    }
    return {extents.begin(), extents.end()};
}

/// Number of values times `bytes` each; the largest number when that does not fit 64 bits.
std::uint64_t total_bytes(const Shape& extents, std::uint64_t bytes) {
    std::uint64_t total = bytes;
    for (const std::size_t extent : extents) {
        if (extent != 0 && total > std::numeric_limits<std::uint64_t>::max() / extent) {
            return std::numeric_limits<std::uint64_t>::max();
        }
        total *= extent;
    }
    return total;
}

Hdf5Kind kind_of(const Hdf5Handle& type) {
    constexpr std::size_t kWidestNumber = 16;
    const H5T_class_t type_class = H5Tget_class(type.id());
    if (type_class == H5T_STRING) return Hdf5Kind::Text;
    if (H5Tget_size(type.id()) > kWidestNumber) return Hdf5Kind::Other;
    if (type_class == H5T_INTEGER || type_class == H5T_ENUM) return Hdf5Kind::Integer;
    return type_class == H5T_FLOAT ? Hdf5Kind::Real : Hdf5Kind::Other;
}

/// The only text of a dataset or attribute of type `type`; `read` fetches it into a buffer.
template <class Read>
std::string fetch_text(const Hdf5Handle& type, const std::string& where, Read&& read) {
    constexpr std::size_t kLongestText = std::size_t{1} << 26;
    const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_cset(text.id(), H5Tget_cset(type.id()));
    if (H5Tis_variable_str(type.id()) > 0) {
        H5Tset_size(text.id(), H5T_VARIABLE);
        char* characters = nullptr;
        if (!read(text.id(), static_cast<void*>(&characters))) throw_unreadable(where);
        return characters == nullptr ? "" : characters;  // the process ends before long
    }
    const std::size_t length = H5Tget_size(type.id());
    if (length == 0 || length > kLongestText) throw_unreadable(where);
    H5Tset_size(text.id(), length + 1);
    std::string result(length + 1, '\0');
    if (!read(text.id(), static_cast<void*>(result.data()))) throw_unreadable(where);
    result.resize(result.find('\0'));
    return result;
}

/// One text, or a few numbers; null for anything else.
Json attribute_value(const Hdf5Handle& attribute, const std::string& where) {
    constexpr std::uint64_t kMaxValues = 4096;
    const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) return nullptr;
    const std::uint64_t count = total_bytes(extents_of(space, where), 1);
    const Hdf5Kind kind = kind_of(type);
    if (kind == Hdf5Kind::Text && count == 1) {
        return fetch_text(type, where, [&](hid_t memory, void* target) {
            return H5Aread(attribute.id(), memory, target) >= 0;
        });
    }
    if ((kind != Hdf5Kind::Integer && kind != Hdf5Kind::Real) || count > kMaxValues) {
        return nullptr;
    }
    std::vector<double> values(count);
    if (count > 0 && H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, values.data()) < 0) {
        throw_unreadable(where);
    }
    return values;
}

/// Extents of a dataset's chunks; empty when it is not stored in chunks.
Shape chunk_of(const Hdf5Handle& dataset, std::size_t rank) {
    const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
    if (H5Pget_layout(plan.id()) != H5D_CHUNKED) return {};
    std::vector<hsize_t> chunk(rank);
    H5Pget_chunk(plan.id(), static_cast<int>(rank), chunk.data());
    return {chunk.begin(), chunk.end()};
}

std::size_t rows_per_read(const Hdf5Handle& dataset, const Shape& shape) {
    constexpr std::size_t kValuesPerRead = std::size_t{1} << 22;
    const std::size_t row_values =
        std::max<std::size_t>(1, total_bytes(Shape(shape.begin() + 1, shape.end()), 1));
    const std::size_t rows = std::max<std::size_t>(1, kValuesPerRead / row_values);
    // Whole chunks at a time, so that none is decompressed twice.
    const Shape chunk = chunk_of(dataset, shape.size());
    const std::size_t rows_of_chunk = chunk.empty() ? 1 : std::max<std::size_t>(1, chunk[0]);
    return (rows + rows_of_chunk - 1) / rows_of_chunk * rows_of_chunk;
}

}  // namespace

Hdf5File::Hdf5File(std::string path) : path_(std::move(path)) {
    prepare_hdf5();
    file_bytes_ = std::filesystem::file_size(path_);
    if (!is_hdf5_file(path_)) throw core::Error(path_, "is not HDF5", "must be an HDF5 file");
    file_ = Hdf5Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file_.is_valid()) {
        throw core::Error(path_,
                          "is damaged or cut short",
                          "must be a complete HDF5 file that no other program is writing");
    }
}

Json Hdf5File::describe(const std::string& name) const {
    if (!exists(name)) return nullptr;
    const Hdf5Handle object(H5Oopen(file_.id(), name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.is_valid()) throw_unreadable(where(name));
    Json description{{kAttributes, describe_attributes(object, name)}};
    if (H5Iget_type(object.id()) != H5I_DATASET) return description;
    const Hdf5Handle space(H5Dget_space(object.id()), H5Sclose);
    if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) return description;
    const Hdf5Handle type(H5Dget_type(object.id()), H5Tclose);
    const Shape shape = extents_of(space, where(name));
    const Hdf5Kind kind = kind_of(type);
    description[kShape] = shape;
    description[kKind] = kind;
    if (kind == Hdf5Kind::Text && (shape.empty() || shape == Shape{1})) {
        description[kText] = fetch_text(type, where(name), [&](hid_t memory, void* target) {
            return H5Dread(object.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target) >= 0;
        });
    }
    if (!shape.empty()) description[kRowsPerRead] = rows_per_read(object, shape);
    return description;
}

bool Hdf5File::exists(const std::string& name) const {
    if (name == "/") return true;
    // Every part of the path must be asked for, or the library reports an error.
    for (std::size_t slash = name.find('/');; slash = name.find('/', slash + 1)) {
        if (H5Lexists(file_.id(), name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) {
            return false;
        }
        if (slash == std::string::npos) break;
    }
    return H5Oexists_by_name(file_.id(), name.c_str(), H5P_DEFAULT) > 0;
}

Json Hdf5File::describe_attributes(const Hdf5Handle& object, const std::string& name) const {
    Json attributes = Json::object();
    const auto add = [](hid_t id, const char* attribute, const H5A_info_t*, void* list) {
        (*static_cast<Json*>(list))[attribute] = nullptr;
        return id < 0 ? -1 : 0;
    };
    if (H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &attributes) < 0) {
        throw_unreadable(where(name));
    }
    for (const auto& [key, value] : attributes.items()) {
        const Hdf5Handle attribute(H5Aopen(object.id(), key.c_str(), H5P_DEFAULT), H5Aclose);
        if (!attribute.is_valid()) throw_unreadable(where(name + " attribute " + key));
        value = attribute_value(attribute, where(name + " attribute " + key));
    }
    return attributes;
}

/// Throws unless what a dataset claims to hold is stored in the file and fits in memory.
void Hdf5File::check_size(const Hdf5Handle& dataset,
                          const Shape& shape,
                          const std::string& where) const {
    // Deflate, the strongest filter in use, shrinks by less than 1032 to 1.
    constexpr std::uint64_t kLargestRatio = 1100;
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
    if (H5Pget_layout(plan.id()) == H5D_VIRTUAL || H5Pget_external_count(plan.id()) > 0) {
        throw core::Error(where, "is kept in other files", "must be in this file");
    }
    const Shape chunk = chunk_of(dataset, shape.size());
    const std::uint64_t stored =
        std::min<std::uint64_t>(H5Dget_storage_size(dataset.id()), file_bytes_);
    const std::uint64_t value_bytes = H5Tget_size(type.id());
    if (total_bytes(shape, value_bytes) > stored * (chunk.empty() ? 1 : kLargestRatio)) {
        throw core::Error(
            where,
            fmt::format("claims shape {} but only {} bytes are stored", shape_text(shape), stored),
            "must be complete");
    }
    const std::uint64_t chunk_bytes = chunk.empty() ? 0 : total_bytes(chunk, value_bytes);
    require_memory(std::max(total_bytes(shape, 2 * sizeof(double)), chunk_bytes), where);
}

template <class T>
std::string Hdf5File::read(const std::string& name, std::size_t first, std::size_t count) const {
    const Hdf5Handle dataset(H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Shape shape = extents_of(space, where(name));
    check_size(dataset, shape, where(name));
    std::vector<hsize_t> start(shape.size(), 0);
    std::vector<hsize_t> size(shape.begin(), shape.end());
    if (!shape.empty()) {
        start[0] = first;
        size[0] = count;
        H5Sselect_hyperslab(
            space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
    }
    std::string values(total_bytes({size.begin(), size.end()}, sizeof(T)), '\0');
    const Hdf5Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
                            H5Sclose);
    const hid_t type = std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
    if (!values.empty() &&
        H5Dread(dataset.id(), type, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
        throw_unreadable(where(name));
    }
    return values;
}

template std::string Hdf5File::read<float>(const std::string&, std::size_t, std::size_t) const;
template std::string Hdf5File::read<double>(const std::string&, std::size_t, std::size_t) const;

}  // namespace nlos
