// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_reader.h"

#include "nlos/containers/file_memory.h"
#include "nlos/containers/sandboxed_process.h"
#include "renderer/core/error.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <cstring>
#include <filesystem>
#include <limits>
#include <type_traits>

namespace nlos {
namespace {

using core::Json;

// A request is a list: the name of an object alone asks what it is (Json, see File::describe); with
// a first row, a number of rows and whether they are wanted in double precision, for their values.

constexpr const char* kShape = "shape";                ///< of a dataset that is not null
constexpr const char* kKind = "kind";                  ///< an Hdf5Kind
constexpr const char* kText = "text";                  ///< the only text of a dataset
constexpr const char* kRowsPerRead = "rows_per_read";  ///< whole chunks, as many as fit a read
constexpr const char* kAttributes = "attributes";      ///< texts, lists of numbers, or null

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

/// The file as the library reads it, in the sandboxed process.
class File {
 public:
    explicit File(std::string path) : path_(std::move(path)) {
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

    std::string answer(const Json& request) const {
        const std::string name = request.at(0);
        if (request.size() > 1) {
            return request.at(3) ? read<double>(name, request.at(1), request.at(2))
                                 : read<float>(name, request.at(1), request.at(2));
        }
        std::string text;
        Json::to_cbor(describe(name), text);
        return text;
    }

 private:
    std::string where(const std::string& name) const { return path_ + ": " + name; }

    /// What an object is; null when there is none of this name.
    Json describe(const std::string& name) const {
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

    bool exists(const std::string& name) const {
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

    Json describe_attributes(const Hdf5Handle& object, const std::string& name) const {
        Json attributes = Json::object();
        const auto add = [](hid_t id, const char* attribute, const H5A_info_t*, void* list) {
            (*static_cast<Json*>(list))[attribute] = nullptr;
            return id < 0 ? -1 : 0;
        };
        if (H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &attributes) <
            0) {
            throw_unreadable(where(name));
        }
        for (const auto& [key, value] : attributes.items()) {
            const Hdf5Handle attribute(H5Aopen(object.id(), key.c_str(), H5P_DEFAULT), H5Aclose);
            if (!attribute.is_valid()) throw_unreadable(where(name + " attribute " + key));
            value = attribute_value(attribute, where(name + " attribute " + key));
        }
        return attributes;
    }

    /// One text, or a few numbers; null for anything else.
    static Json attribute_value(const Hdf5Handle& attribute, const std::string& where) {
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
    static Shape chunk_of(const Hdf5Handle& dataset, std::size_t rank) {
        const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
        if (H5Pget_layout(plan.id()) != H5D_CHUNKED) return {};
        std::vector<hsize_t> chunk(rank);
        H5Pget_chunk(plan.id(), static_cast<int>(rank), chunk.data());
        return {chunk.begin(), chunk.end()};
    }

    static std::size_t rows_per_read(const Hdf5Handle& dataset, const Shape& shape) {
        constexpr std::size_t kValuesPerRead = std::size_t{1} << 22;
        const std::size_t row_values =
            std::max<std::size_t>(1, total_bytes(Shape(shape.begin() + 1, shape.end()), 1));
        const std::size_t rows = std::max<std::size_t>(1, kValuesPerRead / row_values);
        // Whole chunks at a time, so that none is decompressed twice.
        const Shape chunk = chunk_of(dataset, shape.size());
        const std::size_t rows_of_chunk = chunk.empty() ? 1 : std::max<std::size_t>(1, chunk[0]);
        return (rows + rows_of_chunk - 1) / rows_of_chunk * rows_of_chunk;
    }

    /// Throws unless what a dataset claims to hold is stored in the file and fits in memory.
    void check_size(const Hdf5Handle& dataset, const Shape& shape, const std::string& where) const {
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
                fmt::format(
                    "claims shape {} but only {} bytes are stored", shape_text(shape), stored),
                "must be complete");
        }
        const std::uint64_t chunk_bytes = chunk.empty() ? 0 : total_bytes(chunk, value_bytes);
        require_memory(std::max(total_bytes(shape, 2 * sizeof(double)), chunk_bytes), where);
    }

    /// Rows [first, first + count) of a dataset, or the only value of a scalar one.
    template <class T>
    std::string read(const std::string& name, std::size_t first, std::size_t count) const {
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
        const Hdf5Handle memory(
            H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose);
        const hid_t type = std::is_same_v<T, double> ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
        if (!values.empty() &&
            H5Dread(dataset.id(), type, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
            throw_unreadable(where(name));
        }
        return values;
    }

    std::string path_;
    std::uint64_t file_bytes_ = 0;
    Hdf5Handle file_;
};

}  // namespace

Hdf5Reader::Hdf5Reader(std::string path) : path_(std::move(path)) {
    if (!std::filesystem::exists(path_)) {
        throw core::Error(path_, "cannot be opened", "must be a readable HDF5 file");
    }
    // The file is opened in the child, at the first request.
    const auto file = std::make_shared<std::optional<File>>();
    process_ = std::make_unique<SandboxedProcess>(path_, [file, this](const std::string& request) {
        if (!*file) file->emplace(path_);
        return (*file)->answer(Json::from_cbor(request));
    });
    describe("/");
}

Hdf5Reader::~Hdf5Reader() = default;

const Json& Hdf5Reader::describe(const std::string& name) const {
    const auto [place, is_new] = described_.try_emplace(name);
    if (is_new) {
        std::string request;
        Json::to_cbor(Json::array({name}), request);
        place->second = Json::from_cbor(process_->ask(request));
    }
    return place->second;
}

const Json& Hdf5Reader::describe_dataset(const std::string& name) const {
    if (!has(name)) {
        throw core::Error(where(name), "is missing or empty", "must be a dataset with values");
    }
    return describe(name);
}

bool Hdf5Reader::has_object(const std::string& name) const {
    return !describe(name).is_null();
}

bool Hdf5Reader::has(const std::string& name) const {
    return describe(name).contains(kShape);
}

Shape Hdf5Reader::shape(const std::string& name) const {
    return describe_dataset(name).at(kShape);
}

Hdf5Kind Hdf5Reader::kind(const std::string& name) const {
    return describe_dataset(name).at(kKind);
}

void Hdf5Reader::require_numeric(const std::string& name) const {
    const Hdf5Kind found = kind(name);
    if (found != Hdf5Kind::Integer && found != Hdf5Kind::Real) {
        throw core::Error(where(name),
                          found == Hdf5Kind::Text ? "holds text" : "holds no plain numbers",
                          "must hold real numbers");
    }
}

template <class T>
std::vector<T> Hdf5Reader::read_values(const std::string& name,
                                       std::size_t first,
                                       std::size_t count) const {
    std::string request;
    Json::to_cbor(Json::array({name, first, count, std::is_same_v<T, double>}), request);
    const std::string bytes = process_->ask(request);
    std::vector<T> values(bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

template std::vector<float> Hdf5Reader::read_values(const std::string&,
                                                    std::size_t,
                                                    std::size_t) const;

template <class T>
std::vector<T> Hdf5Reader::read_all(const std::string& name, const Shape& wanted) const {
    const Shape found = shape(name);
    if (found != wanted) {
        throw core::Error(
            where(name), "has shape " + shape_text(found), "must have shape " + shape_text(wanted));
    }
    require_numeric(name);
    return read_values<T>(name, 0, found.empty() ? 1 : found[0]);
}

std::vector<float> Hdf5Reader::read_floats(const std::string& name, const Shape& wanted) const {
    return read_all<float>(name, wanted);
}

std::vector<double> Hdf5Reader::read_doubles(const std::string& name, const Shape& wanted) const {
    return read_all<double>(name, wanted);
}

double Hdf5Reader::read_real(const std::string& name) const {
    return read_doubles(name, shape(name) == Shape{1} ? Shape{1} : Shape{})[0];
}

std::int64_t Hdf5Reader::read_integer(const std::string& name) const {
    if (kind(name) != Hdf5Kind::Integer) {
        throw core::Error(where(name), "holds no whole number", "must be an integer, enum or bool");
    }
    return static_cast<std::int64_t>(read_real(name));
}

std::string Hdf5Reader::read_text(const std::string& name) const {
    if (kind(name) != Hdf5Kind::Text) {
        throw core::Error(where(name), "holds no text", "must be a text");
    }
    if (!describe(name).contains(kText)) {
        throw core::Error(where(name), "has shape " + shape_text(shape(name)), "must be one text");
    }
    return describe(name).at(kText);
}

std::size_t Hdf5Reader::rows_per_read(const std::string& name) const {
    require_numeric(name);
    return describe_dataset(name).at(kRowsPerRead);
}

std::optional<std::string> Hdf5Reader::text_attribute(const std::string& object,
                                                      const std::string& name) const {
    if (!has_object(object) || !describe(object).at(kAttributes).contains(name)) return {};
    const Json& value = describe(object).at(kAttributes).at(name);
    if (value.is_string()) return value;
    throw core::Error(where(object + " attribute " + name), "holds no text", "must be one text");
}

std::optional<std::vector<double>> Hdf5Reader::real_attribute(const std::string& object,
                                                              const std::string& name) const {
    if (!has_object(object) || !describe(object).at(kAttributes).contains(name)) return {};
    const Json& value = describe(object).at(kAttributes).at(name);
    if (value.is_array()) return value;
    throw core::Error(
        where(object + " attribute " + name), "holds no numbers", "must hold a few numbers");
}

}  // namespace nlos
