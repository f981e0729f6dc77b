// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_session.h"

#include "nlos/containers/file_memory.h"
#include "nlos/containers/hdf5_global_heap.h"
#include "renderer/core/error.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <filesystem>
#include <limits>
#include <type_traits>

namespace nlos {
namespace {

constexpr std::size_t kLongestText = std::size_t{1} << 26;

template <class T>
hid_t memory_type() {
    if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
    if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
    if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
}

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

/// A text held by a scalar or one-element dataset or attribute; `read` fetches into a buffer.
template <class Read>
std::string fetch_text(hid_t type, const std::string& where, Read&& read) {
    const Hdf5Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_cset(text.id(), H5Tget_cset(type));
    if (H5Tis_variable_str(type) > 0) {
        H5Tset_size(text.id(), H5T_VARIABLE);
        char* characters = nullptr;
        if (!read(text.id(), static_cast<void*>(&characters))) throw_unreadable(where);
        std::string result = characters == nullptr ? "" : characters;
        H5free_memory(characters);
        return result;
    }
    const std::size_t length = H5Tget_size(type);
    if (length == 0 || length > kLongestText) throw_unreadable(where);
    H5Tset_size(text.id(), length + 1);
    std::string result(length + 1, '\0');
    if (!read(text.id(), static_cast<void*>(result.data()))) throw_unreadable(where);
    result.resize(result.find('\0'));
    return result;
}

}  // namespace

Hdf5Session::Hdf5Session(std::string path) : path_(std::move(path)) {
    prepare_hdf5();
    std::error_code error;
    file_bytes_ = std::filesystem::file_size(path_, error);
    if (error) throw core::Error(path_, "cannot be opened", "must be a readable HDF5 file");
    if (!is_hdf5_file(path_)) throw core::Error(path_, "is not HDF5", "must be an HDF5 file");
    const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(access.id(), H5F_CLOSE_STRONG);
    file_ = Hdf5Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose);
    if (!file_.is_valid()) {
        throw core::Error(path_,
                          "is damaged or cut short",
                          "must be a complete HDF5 file that no other program is writing");
    }
}

bool Hdf5Session::has_object(const std::string& name) const {
    // Every part of the path must be asked for, or the library reports an error.
    for (std::size_t slash = name.find('/');; slash = name.find('/', slash + 1)) {
        if (H5Lexists(file_.id(), name.substr(0, slash).c_str(), H5P_DEFAULT) <= 0) return false;
        if (slash == std::string::npos) break;
    }
    return H5Oexists_by_name(file_.id(), name.c_str(), H5P_DEFAULT) > 0;
}

bool Hdf5Session::has(const std::string& name) const {
    if (!has_object(name)) return false;
    const Hdf5Handle object(H5Oopen(file_.id(), name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.is_valid()) throw_unreadable(where(name));
    if (H5Iget_type(object.id()) != H5I_DATASET) return false;
    const Hdf5Handle space(H5Dget_space(object.id()), H5Sclose);
    return H5Sget_simple_extent_type(space.id()) != H5S_NULL;
}

Hdf5Handle Hdf5Session::open_dataset(const std::string& name) const {
    if (!has(name)) {
        throw core::Error(where(name), "is missing or empty", "must be a dataset with values");
    }
    return {H5Dopen2(file_.id(), name.c_str(), H5P_DEFAULT), H5Dclose};
}

Shape Hdf5Session::shape(const std::string& name) const {
    const Hdf5Handle dataset = open_dataset(name);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    return extents_of(space, where(name));
}

Hdf5Kind Hdf5Session::kind(const std::string& name) const {
    constexpr std::size_t kWidestNumber = 16;
    const Hdf5Handle dataset = open_dataset(name);
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const H5T_class_t type_class = H5Tget_class(type.id());
    if (type_class == H5T_STRING) return Hdf5Kind::Text;
    if (H5Tget_size(type.id()) > kWidestNumber) return Hdf5Kind::Other;
    if (type_class == H5T_INTEGER || type_class == H5T_ENUM) return Hdf5Kind::Integer;
    return type_class == H5T_FLOAT ? Hdf5Kind::Real : Hdf5Kind::Other;
}

void Hdf5Session::require_numeric(const std::string& name) const {
    const Hdf5Kind found = kind(name);
    if (found != Hdf5Kind::Integer && found != Hdf5Kind::Real) {
        throw core::Error(where(name),
                          found == Hdf5Kind::Text ? "holds text" : "holds no plain numbers",
                          "must hold real numbers");
    }
}

void Hdf5Session::check_size(const std::string& name) const {
    // Deflate, the strongest filter in use, shrinks by less than 1032 to 1.
    constexpr std::uint64_t kLargestRatio = 1100;
    const Hdf5Handle dataset = open_dataset(name);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
    const Shape extents = extents_of(space, where(name));
    const H5D_layout_t layout = H5Pget_layout(plan.id());
    if (layout == H5D_VIRTUAL || H5Pget_external_count(plan.id()) > 0) {
        throw core::Error(where(name), "is kept in other files", "must be in this file");
    }
    const std::uint64_t stored =
        std::min<std::uint64_t>(H5Dget_storage_size(dataset.id()), file_bytes_);
    const std::uint64_t bytes = total_bytes(extents, H5Tget_size(type.id()));
    if (bytes > stored * (layout == H5D_CHUNKED ? kLargestRatio : 1)) {
        throw core::Error(
            where(name),
            fmt::format(
                "claims shape {} but only {} bytes are stored", shape_text(extents), stored),
            "must be complete");
    }
    std::uint64_t needed = total_bytes(extents, 2 * sizeof(double));
    if (layout == H5D_CHUNKED) {
        std::vector<hsize_t> chunk(extents.size());
        H5Pget_chunk(plan.id(), static_cast<int>(chunk.size()), chunk.data());
        needed =
            std::max(needed, total_bytes({chunk.begin(), chunk.end()}, H5Tget_size(type.id())));
    }
    require_memory(needed, where(name));
}

template <class T>
std::vector<T> Hdf5Session::read_all(const std::string& name, const Shape& wanted) const {
    const Shape found = shape(name);
    if (found != wanted) {
        throw core::Error(
            where(name), "has shape " + shape_text(found), "must have shape " + shape_text(wanted));
    }
    require_numeric(name);
    check_size(name);
    std::vector<T> values(total_bytes(found, 1));
    const Hdf5Handle dataset = open_dataset(name);
    if (!values.empty() &&
        H5Dread(dataset.id(), memory_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
        throw_unreadable(where(name));
    }
    return values;
}

std::vector<float> Hdf5Session::read_floats(const std::string& name, const Shape& wanted) const {
    return read_all<float>(name, wanted);
}

std::vector<double> Hdf5Session::read_doubles(const std::string& name, const Shape& wanted) const {
    return read_all<double>(name, wanted);
}

template <class T>
T Hdf5Session::read_one(const std::string& name) const {
    const Shape found = shape(name);
    return read_all<T>(name, found == Shape{1} ? found : Shape{})[0];
}

double Hdf5Session::read_real(const std::string& name) const {
    return read_one<double>(name);
}

std::int64_t Hdf5Session::read_integer(const std::string& name) const {
    if (kind(name) != Hdf5Kind::Integer) {
        throw core::Error(where(name), "holds no whole number", "must be an integer, enum or bool");
    }
    return read_one<std::int64_t>(name);
}

void Hdf5Session::check_texts() const {
    if (!texts_checked_) check_text_heaps(path_);
    texts_checked_ = true;
}

std::string Hdf5Session::read_text(const std::string& name) const {
    if (kind(name) != Hdf5Kind::Text) {
        throw core::Error(where(name), "holds no text", "must be a text");
    }
    const Shape found = shape(name);
    if (!found.empty() && found != Shape{1}) {
        throw core::Error(where(name), "has shape " + shape_text(found), "must be one text");
    }
    const Hdf5Handle dataset = open_dataset(name);
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    check_texts();
    const haddr_t position = H5Dget_offset(dataset.id());
    if (H5Tis_variable_str(type.id()) > 0 && position != HADDR_UNDEF) {
        check_text_reference(path_, position);
    }
    return fetch_text(type.id(), where(name), [&](hid_t memory, void* target) {
        return H5Dread(dataset.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target) >= 0;
    });
}

std::size_t Hdf5Session::rows_per_read(const std::string& name) const {
    constexpr std::size_t kValuesPerRead = std::size_t{1} << 22;
    require_numeric(name);
    check_size(name);
    const Shape extents = shape(name);
    const std::size_t row_values =
        std::max<std::size_t>(1, total_bytes(Shape(extents.begin() + 1, extents.end()), 1));
    const std::size_t rows = std::max<std::size_t>(1, kValuesPerRead / row_values);
    const Hdf5Handle dataset = open_dataset(name);
    const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
    if (H5Pget_layout(plan.id()) != H5D_CHUNKED) return rows;
    // Whole chunks at a time, so that none is decompressed twice.
    std::vector<hsize_t> chunk(extents.size());
    if (H5Pget_chunk(plan.id(), static_cast<int>(chunk.size()), chunk.data()) < 0 ||
        chunk[0] == 0) {
        throw_unreadable(where(name));
    }
    return (rows + chunk[0] - 1) / chunk[0] * chunk[0];
}

std::vector<float> Hdf5Session::read_row_range(const std::string& name,
                                               std::size_t first,
                                               std::size_t count) const {
    require_numeric(name);
    check_size(name);
    const Shape extents = shape(name);
    if (extents.empty() || first + count > extents[0]) throw_unreadable(where(name));
    std::vector<hsize_t> start(extents.size(), 0);
    std::vector<hsize_t> size(extents.begin(), extents.end());
    start[0] = first;
    size[0] = count;
    std::vector<float> values(total_bytes({size.begin(), size.end()}, 1));
    const Hdf5Handle dataset = open_dataset(name);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Hdf5Handle memory(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr),
                            H5Sclose);
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
    if (H5Dread(
            dataset.id(), H5T_NATIVE_FLOAT, memory.id(), space.id(), H5P_DEFAULT, values.data()) <
        0) {
        throw_unreadable(where(name));
    }
    return values;
}

Hdf5Handle Hdf5Session::open_attribute(const std::string& object, const std::string& name) const {
    if (object != "/" && !has_object(object)) return {};
    if (H5Aexists_by_name(file_.id(), object.c_str(), name.c_str(), H5P_DEFAULT) <= 0) return {};
    return {H5Aopen_by_name(file_.id(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose};
}

std::optional<std::string> Hdf5Session::text_attribute(const std::string& object,
                                                       const std::string& name) const {
    const Hdf5Handle attribute = open_attribute(object, name);
    if (!attribute.is_valid()) return std::nullopt;
    const std::string place = where(object + " attribute " + name);
    const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    if (H5Tget_class(type.id()) != H5T_STRING || H5Sget_simple_extent_npoints(space.id()) != 1) {
        throw core::Error(place, "holds no text", "must be one text");
    }
    check_texts();
    return fetch_text(type.id(), place, [&](hid_t memory, void* target) {
        return H5Aread(attribute.id(), memory, target) >= 0;
    });
}

std::optional<std::vector<double>> Hdf5Session::real_attribute(const std::string& object,
                                                               const std::string& name) const {
    constexpr std::uint64_t kMaxValues = 4096;
    const Hdf5Handle attribute = open_attribute(object, name);
    if (!attribute.is_valid()) return std::nullopt;
    const std::string place = where(object + " attribute " + name);
    const Hdf5Handle type(H5Aget_type(attribute.id()), H5Tclose);
    const Hdf5Handle space(H5Aget_space(attribute.id()), H5Sclose);
    const H5T_class_t type_class = H5Tget_class(type.id());
    const std::uint64_t count = total_bytes(extents_of(space, place), 1);
    if ((type_class != H5T_FLOAT && type_class != H5T_INTEGER) || count > kMaxValues ||
        H5Sget_simple_extent_type(space.id()) == H5S_NULL) {
        throw core::Error(place, "holds no numbers", "must hold a few numbers");
    }
    std::vector<double> values(count);
    if (count > 0 && H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, values.data()) < 0) {
        throw_unreadable(place);
    }
    return values;
}

}  // namespace nlos
