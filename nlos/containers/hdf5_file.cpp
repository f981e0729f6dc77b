// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_file.h"

#include "nlos/containers/file_memory.h"
#include "nlos/containers/hdf5_filters.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

namespace nlos {

using core::Json;

namespace {

ElementKind kind_of(const Hdf5Handle& type) {
    constexpr std::size_t kWidestNumber = 16;
    const H5T_class_t type_class = H5Tget_class(type.id());
    if (type_class == H5T_STRING) return ElementKind::Text;
    if (H5Tget_size(type.id()) > kWidestNumber) return ElementKind::Other;
    if (type_class == H5T_INTEGER || type_class == H5T_ENUM) return ElementKind::Integer;
    return type_class == H5T_FLOAT ? ElementKind::Real : ElementKind::Other;
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
        if (!read(text.id(), static_cast<void*>(&characters))) throw_damaged_hdf5(where);
        return characters == nullptr ? "" : characters;  // the process ends before long
    }
    const std::size_t length = H5Tget_size(type.id());
    if (length == 0 || length > kLongestText) throw_damaged_hdf5(where);
    H5Tset_size(text.id(), length + 1);
    std::string result(length + 1, '\0');
    if (!read(text.id(), static_cast<void*>(result.data()))) throw_damaged_hdf5(where);
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
    const ElementKind kind = kind_of(type);
    if (kind == ElementKind::Text && count == 1) {
        return fetch_text(type, where, [&](hid_t memory, void* target) {
            return H5Aread(attribute.id(), memory, target) >= 0;
        });
    }
    if ((kind != ElementKind::Integer && kind != ElementKind::Real) || count > kMaxValues) {
        return nullptr;
    }
    std::vector<double> values(count);
    if (count > 0 && H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, values.data()) < 0) {
        throw_damaged_hdf5(where);
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

/// Whole chunks, as many as make a read, so that none is decompressed twice.
std::size_t rows_per_read(const Hdf5Handle& dataset, const Shape& shape) {
    const std::size_t rows = rows_of_read(shape);
    const Shape chunk = chunk_of(dataset, shape.size());
    const std::size_t rows_of_chunk = chunk.empty() ? 1 : std::max<std::size_t>(1, chunk[0]);
    return (rows + rows_of_chunk - 1) / rows_of_chunk * rows_of_chunk;
}

std::string type_name(const Hdf5Handle& type) {
    const std::size_t bits = 8 * H5Tget_size(type.id());
    switch (H5Tget_class(type.id())) {
        case H5T_INTEGER:
            return fmt::format("{}int{}", H5Tget_sign(type.id()) == H5T_SGN_NONE ? "u" : "", bits);
        case H5T_FLOAT:
            return fmt::format("float{}", bits);
        case H5T_STRING:
            return "text";
        case H5T_ENUM:
            return "enumeration";
        case H5T_REFERENCE:
            return "reference";
        case H5T_COMPOUND:
            return "compound";
        default:
            return "other";
    }
}

/// A walk over all groups of a file that notes the datasets.
class GroupWalk {
 public:
    ArrayNames run(const Hdf5Handle& root) {
        is_new(root);
        list_group(root, "", 0);
        return std::move(found_);
    }

 private:
    static constexpr std::size_t kDeepest = 32;
    static constexpr std::size_t kMostObjects = 4 * ArrayNames::kMost;

    void list_group(const Hdf5Handle& group, const std::string& prefix, std::size_t depth) {
        if (depth > kDeepest) found_.is_complete = false;
        const ArrayNames links = links_of(group);
        for (const std::string& link : links.names) {
            if (found_.names.size() == ArrayNames::kMost || num_objects_++ == kMostObjects) {
                found_.is_complete = false;
            }
            if (!found_.is_complete) return;
            const Hdf5Handle object(H5Oopen(group.id(), link.c_str(), H5P_DEFAULT), H5Oclose);
            if (object.is_valid()) list_object(object, prefix + link, depth);
        }
        if (!links.is_complete) found_.is_complete = false;
    }

    void list_object(const Hdf5Handle& object, const std::string& name, std::size_t depth) {
        const H5I_type_t type = H5Iget_type(object.id());
        if (type == H5I_DATASET) found_.names.push_back(name);
        if (type == H5I_GROUP && is_new(object)) list_group(object, name + "/", depth + 1);
    }

    /// Whether a group was not seen before: links may form cycles.
    bool is_new(const Hdf5Handle& group) { return is_new(group, &H5Oget_info2); }

    /// Info is named H5O_info_t by HDF5 1.10, H5O_info1_t by later versions.
    template <class Info>
    bool is_new(const Hdf5Handle& group, herr_t (*get_info)(hid_t, Info*, unsigned)) {
        Info info{};
        return get_info(group.id(), &info, H5O_INFO_BASIC) >= 0 && groups_.insert(info.addr).second;
    }

    ArrayNames found_;
    std::size_t num_objects_ = 0;
    std::set<haddr_t> groups_;  ///< seen so far
};

/// Throws for a dataset whose values are not in this file, before the library looks for them.
void require_own_storage(const Hdf5Handle& dataset, const std::string& where) {
    const Hdf5Handle plan(H5Dget_create_plist(dataset.id()), H5Pclose);
    if (H5Pget_layout(plan.id()) == H5D_VIRTUAL || H5Pget_external_count(plan.id()) > 0) {
        throw core::Error(where, "is kept in other files", "must be in this file");
    }
}

}  // namespace

void throw_damaged_hdf5(const std::string& where) {
    throw core::Error(where, "is damaged or cut short", "must be a complete, undamaged file");
}

Shape extents_of(const Hdf5Handle& space, const std::string& where) {
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 0) throw_damaged_hdf5(where);
    std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
    if (rank > 0 && H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr) < 0) {
        throw_damaged_hdf5(where);
    }
    return {extents.begin(), extents.end()};
}

ArrayNames links_of(const Hdf5Handle& group) {
    ArrayNames links;
    const auto add = [](hid_t, const char* name, const H5L_info_t* info, void* found) {
        auto& list = *static_cast<ArrayNames*>(found);
        list.is_complete = list.names.size() < ArrayNames::kMost;
        if (!list.is_complete) return 1;
        if (info->type == H5L_TYPE_HARD || info->type == H5L_TYPE_SOFT) {
            list.names.emplace_back(name);
        }
        return 0;
    };
    H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &links);
    return links;
}

Hdf5File::Hdf5File(std::string path) : path_(std::move(path)) {
    prepare_hdf5();
    H5Lunregister(H5L_TYPE_EXTERNAL);  // no link leads out of the file
    file_bytes_ = std::filesystem::file_size(path_);
    file_ = Hdf5Handle(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file_.is_valid()) {
        throw core::Error(path_,
                          "is damaged or cut short",
                          "must be a complete HDF5 file that no other program is writing");
    }
}

Hdf5Handle Hdf5File::open_root() const {
    Hdf5Handle root(H5Gopen2(file_.id(), "/", H5P_DEFAULT), H5Gclose);
    if (!root.is_valid()) throw_damaged_hdf5(path_);
    return root;
}

ArrayNames Hdf5File::names() const {
    return GroupWalk().run(open_root());
}

std::optional<ArrayDescription> Hdf5File::describe(const std::string& name) const {
    const Hdf5Handle object = open_object(name);
    if (!object.is_valid()) return std::nullopt;
    return describe_object(object, name);
}

ArrayDescription Hdf5File::describe_object(const Hdf5Handle& object,
                                           const std::string& name) const {
    ArrayDescription description;
    description.attributes = describe_attributes(object, name);
    description.type = "group";
    if (H5Iget_type(object.id()) != H5I_DATASET) return description;
    require_own_storage(object, where(name));
    const Hdf5Handle type(H5Dget_type(object.id()), H5Tclose);
    description.type = type_name(type);
    const Hdf5Handle space(H5Dget_space(object.id()), H5Sclose);
    if (H5Sget_simple_extent_type(space.id()) == H5S_NULL) return description;
    const Shape shape = extents_of(space, where(name));
    description.shape = shape;
    description.kind = kind_of(type);
    if (description.kind == ElementKind::Text && (shape.empty() || shape == Shape{1})) {
        require_filters(object, path_, name);
        if (!chunk_of(object, shape.size()).empty()) check_size(object, shape, where(name));
        description.text = fetch_text(type, where(name), [&](hid_t memory, void* target) {
            return H5Dread(object.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, target) >= 0;
        });
    }
    if (!shape.empty()) description.rows_per_read = rows_per_read(object, shape);
    return description;
}

Hdf5Handle Hdf5File::open_object(const std::string& name) const {
    Hdf5Handle root = open_root();
    return name == "/" ? std::move(root) : open_member(root, name);
}

Hdf5Handle Hdf5File::open_member(const Hdf5Handle& group, const std::string& path) const {
    // Every part of the path must be asked for, or the library reports an error.
    for (std::size_t slash = path.find('/');; slash = path.find('/', slash + 1)) {
        const std::string part = path.substr(0, slash);
        H5L_info_t link{};
        if (H5Lexists(group.id(), part.c_str(), H5P_DEFAULT) <= 0 ||
            H5Lget_info(group.id(), part.c_str(), &link, H5P_DEFAULT) < 0) {
            return {};
        }
        if (link.type != H5L_TYPE_HARD && link.type != H5L_TYPE_SOFT) {
            throw core::Error(where(path), "is kept in another file", "must be in this file");
        }
        if (slash == std::string::npos) break;
    }
    if (H5Oexists_by_name(group.id(), path.c_str(), H5P_DEFAULT) <= 0) return {};
    Hdf5Handle object(H5Oopen(group.id(), path.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object.is_valid()) throw_damaged_hdf5(where(path));
    return object;
}

Json Hdf5File::describe_attributes(const Hdf5Handle& object, const std::string& name) const {
    Json attributes = Json::object();
    const auto add = [](hid_t id, const char* attribute, const H5A_info_t*, void* list) {
        constexpr std::size_t kMost = 1024;
        auto& names = *static_cast<Json*>(list);
        names[attribute] = nullptr;
        return id < 0 ? -1 : names.size() == kMost ? 1 : 0;
    };
    if (H5Aiterate2(object.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, add, &attributes) < 0) {
        throw_damaged_hdf5(where(name));
    }
    for (const auto& [key, value] : attributes.items()) {
        const Hdf5Handle attribute(H5Aopen(object.id(), key.c_str(), H5P_DEFAULT), H5Aclose);
        if (!attribute.is_valid()) throw_damaged_hdf5(where(name + " attribute " + key));
        value = attribute_value(attribute, where(name + " attribute " + key));
    }
    return attributes;
}

void Hdf5File::check_size(const Hdf5Handle& dataset,
                          const Shape& shape,
                          const std::string& where) const {
    const Hdf5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const Shape chunk = chunk_of(dataset, shape.size());
    const std::uint64_t stored =
        std::min<std::uint64_t>(H5Dget_storage_size(dataset.id()), file_bytes_);
    const std::uint64_t value_bytes = H5Tget_size(type.id());
    const std::uint64_t chunk_bytes = chunk.empty() ? 0 : total_bytes(chunk, value_bytes);
    const std::uint64_t most = stored * (chunk.empty() ? 1 : kLargestDeflateRatio);
    if (std::max(total_bytes(shape, value_bytes), chunk_bytes) > most) {
        throw core::Error(
            where,
            fmt::format("claims shape {} but only {} bytes are stored", shape_text(shape), stored),
            "must be complete");
    }
    require_memory(std::max(total_bytes(shape, 2 * sizeof(double)), chunk_bytes), where);
}

std::string Hdf5File::read(const std::string& name, const WantedRows& rows) const {
    const Hdf5Handle dataset = open_object(name);
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    Shape shape = extents_of(space, where(name));
    require_filters(dataset, path_, name);
    check_size(dataset, shape, where(name));
    const Hdf5Handle memory = select_rows(space, rows.first, rows.count);
    if (!shape.empty()) shape[0] = rows.count;
    const bool is_double = rows.precision == Precision::Double;
    const std::size_t value_bytes = is_double ? sizeof(double) : sizeof(float);
    std::string values(total_bytes(shape, value_bytes), '\0');
    const hid_t type = is_double ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
    if (!values.empty() &&
        H5Dread(dataset.id(), type, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
        throw_damaged_hdf5(where(name));
    }
    return values;
}

Container hdf5_container() {
    return {"HDF5 (MATLAB v7.3 too)",
            is_hdf5_file,
            [](const std::string& path) -> std::unique_ptr<ArrayFile> {
                auto file = std::make_unique<Hdf5File>(path);
                if (is_mat73_file(*file, path)) return open_mat73_file(path);
                return file;
            }};
}

}  // namespace nlos
