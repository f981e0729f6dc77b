// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_file.h"
#include "nlos/containers/matlab_name.h"
#include "nlos/containers/unicode_text.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"

#include <fmt/core.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <vector>

namespace nlos {
namespace {

constexpr const char* kClass = "MATLAB_class";
constexpr const char* kEmpty = "MATLAB_empty";

bool has_attribute(const Hdf5Handle& object, const char* name) {
    return H5Aexists(object.id(), name) > 0;
}

bool is_dataset(const Hdf5Handle& object) {
    return H5Iget_type(object.id()) == H5I_DATASET;
}

/// Whether a dataset holds references to other objects: the elements of a cell array, or those of
/// one field of an array of structs.
bool holds_references(const Hdf5Handle& object) {
    if (!is_dataset(object) || has_attribute(object, kEmpty)) return false;
    const Hdf5Handle type(H5Dget_type(object.id()), H5Tclose);
    return H5Tequal(type.id(), H5T_STD_REF_OBJ) > 0;
}

bool is_cell(const Hdf5Handle& object) {
    return holds_references(object) && has_attribute(object, kClass);
}

/// One field of all elements of an array of structs.
bool is_element_list(const Hdf5Handle& object) {
    return holds_references(object) && !has_attribute(object, kClass);
}

std::uint64_t element_count(const Hdf5Handle& dataset) {
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space.id());
    return count < 0 ? 0 : static_cast<std::uint64_t>(count);
}

/// MATLAB's names of types, where they differ from those of others.
std::string type_of_class(const std::string& matlab_class) {
    if (matlab_class == "double") return "float64";
    if (matlab_class == "single") return "float32";
    return matlab_class == "char" ? "text" : matlab_class;
}

bool is_plain_class(const std::string& matlab_class) {
    return matlab_class == "double" || matlab_class == "single" || matlab_class == "logical" ||
           matlab_class == "char" || matlab_class.starts_with("int") ||
           matlab_class.starts_with("uint");
}

/// What element `index` of a dataset, in the order of storage, refers to; not valid when nothing.
Hdf5Handle open_referred(const Hdf5Handle& dataset, std::uint64_t index) {
    const Hdf5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    const Shape shape = extents_of(space, "");
    if (index >= total_bytes(shape, 1)) return {};
    std::vector<hsize_t> coordinates(shape.size());
    std::uint64_t rest = index;
    for (std::size_t axis = shape.size(); axis-- > 0;) {
        coordinates[axis] = rest % shape[axis];
        rest /= shape[axis];
    }
    if (!coordinates.empty()) H5Sselect_elements(space.id(), H5S_SELECT_SET, 1, coordinates.data());
    const Hdf5Handle memory(H5Screate(H5S_SCALAR), H5Sclose);
    hobj_ref_t reference = 0;
    if (H5Dread(dataset.id(), H5T_STD_REF_OBJ, memory.id(), space.id(), H5P_DEFAULT, &reference) <
        0) {
        return {};
    }
    return {H5Rdereference2(dataset.id(), H5P_DEFAULT, H5R_OBJECT, &reference), H5Oclose};
}

/// A walk over a file's variables and their parts.
class VariableWalk {
 public:
    ArrayNames run(const Hdf5Handle& root) {
        const ArrayNames links = links_of(root);
        for (const std::string& link : links.names) {
            if (!link.starts_with('#')) list_member(root, link, link, 0);
        }
        if (!links.is_complete) found_.is_complete = false;
        return std::move(found_);
    }

 private:
    static constexpr std::size_t kDeepest = 32;
    static constexpr std::size_t kMostObjects = 4 * ArrayNames::kMost;

    void list_member(const Hdf5Handle& group,
                     const std::string& link,
                     const std::string& name,
                     std::size_t depth) {
        const Hdf5Handle object(H5Oopen(group.id(), link.c_str(), H5P_DEFAULT), H5Oclose);
        list_object(object, name, depth);
    }

    void list_object(const Hdf5Handle& object, const std::string& name, std::size_t depth) {
        if (found_.names.size() == ArrayNames::kMost || ++num_objects_ > kMostObjects ||
            depth > kDeepest) {
            found_.is_complete = false;
        }
        if (!found_.is_complete || !object.is_valid()) return;
        if (is_cell(object)) {
            list_referred(
                object, depth, [&](std::uint64_t i) { return fmt::format("{}{{{}}}", name, i); });
        } else if (H5Iget_type(object.id()) == H5I_GROUP &&
                   !has_attribute(object, "MATLAB_sparse")) {
            list_struct(object, name, depth);
        } else {
            found_.names.push_back(name);
        }
    }

    template <class NameOf>
    void list_referred(const Hdf5Handle& dataset, std::size_t depth, const NameOf& name_of) {
        const std::uint64_t count = element_count(dataset);
        for (std::uint64_t i = 0; i < count && found_.is_complete; ++i) {
            list_object(open_referred(dataset, i), name_of(i), depth + 1);
        }
    }

    void list_struct(const Hdf5Handle& group, const std::string& name, std::size_t depth) {
        const ArrayNames fields = links_of(group);
        for (const std::string& field : fields.names) {
            if (!found_.is_complete) return;
            const Hdf5Handle member(H5Oopen(group.id(), field.c_str(), H5P_DEFAULT), H5Oclose);
            if (member.is_valid() && is_element_list(member)) {
                list_referred(member, depth, [&](std::uint64_t i) {
                    return fmt::format("{}({}).{}", name, i, field);
                });
            } else {
                list_object(member, name + "." + field, depth + 1);
            }
        }
        if (!fields.is_complete) found_.is_complete = false;
    }

    ArrayNames found_;
    std::size_t num_objects_ = 0;
};

/// A MATLAB v7.3 file: HDF5 whose cell arrays and arrays of structs refer to objects in the group
/// #refs#, and whose structs are groups.
class Mat73File : public Hdf5File {
 public:
    explicit Mat73File(const std::string& path) : Hdf5File(path) {}

    std::string container() const override { return "matlab-v7.3"; }
    bool first_index_fastest() const override { return true; }

    ArrayNames names() const override { return VariableWalk().run(open_root()); }

    std::optional<ArrayDescription> describe(const std::string& name) const override {
        const Hdf5Handle object = open_object(name);
        if (!object.is_valid()) return std::nullopt;
        ArrayDescription description = describe_object(object, name);
        const auto found = description.attributes->find(kClass);
        const bool has_class = found != description.attributes->end() && found->is_string();
        const std::string matlab_class = has_class ? found->get<std::string>() : "";
        if (!is_dataset(object)) {
            description.type = has_attribute(object, "MATLAB_sparse") ? "sparse" : "struct";
        }
        if (!has_class || !description.shape) return description;
        description.type = description.type == "compound" ? "complex " + type_of_class(matlab_class)
                                                          : type_of_class(matlab_class);
        if (!is_plain_class(matlab_class)) {
            description.kind = ElementKind::Other;
            if (matlab_class == "struct" || matlab_class == "cell") description.shape.reset();
            return description;
        }
        if (has_attribute(object, kEmpty)) description.shape = empty_shape(object, name);
        if (matlab_class == "char") {
            description.kind = ElementKind::Text;
            description.text = read_text(object, *description.shape, name);
        }
        return description;
    }

    std::string read(const std::string& name, const WantedRows& rows) const override {
        if (has_attribute(open_object(name), kEmpty)) return {};
        return Hdf5File::read(name, rows);
    }

 protected:
    Hdf5Handle open_object(const std::string& name) const override {
        if (name == "/") return open_root();
        const auto steps = parse_matlab_name(name);
        if (!steps) return {};
        Hdf5Handle at = open_root();
        for (const MatlabStep& step : *steps) {
            at = open_step(at, step);
            if (!at.is_valid()) break;
        }
        return at;
    }

 private:
    /// The field or cell that a step leads to; not valid when there is none.
    Hdf5Handle open_step(const Hdf5Handle& at, const MatlabStep& step) const {
        if (step.is_cell()) return is_cell(at) ? open_referred(at, step.cell) : Hdf5Handle();
        if (H5Iget_type(at.id()) != H5I_GROUP) return {};
        Hdf5Handle member = open_member(at, step.field);
        if (!member.is_valid() || is_element_list(member) != step.element.has_value()) return {};
        return step.element ? open_referred(member, *step.element) : std::move(member);
    }

    /// The extents of an empty array, which stand in the file in place of its values.
    Shape empty_shape(const Hdf5Handle& dataset, const std::string& name) const {
        constexpr std::size_t kHighestRank = 32;
        std::array<std::uint64_t, kHighestRank> extents{};
        const std::uint64_t rank = element_count(dataset);
        if (rank <= kHighestRank &&
            H5Dread(
                dataset.id(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, extents.data()) >=
                0) {
            const Shape shape(extents.rend() - static_cast<std::ptrdiff_t>(rank), extents.rend());
            if (std::find(shape.begin(), shape.end(), 0U) != shape.end()) return shape;
        }
        throw core::Error(
            where(name), "has extents that are not empty", "must be an undamaged file");
    }

    /// The text of a row of characters, or of none.
    std::optional<std::string> read_text(const Hdf5Handle& dataset,
                                         const Shape& shape,
                                         const std::string& name) const {
        const std::uint64_t count = total_bytes(shape, 1);
        if (count == 0) return "";
        if (shape.size() != 2 || shape[1] != 1) return std::nullopt;
        check_size(dataset, shape, where(name));
        std::vector<std::uint16_t> units(count);
        if (H5Dread(dataset.id(), H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, units.data()) <
            0) {
            throw_damaged_hdf5(where(name));
        }
        return utf8_text(reinterpret_cast<const char*>(units.data()),
                         units.size(),
                         sizeof(units[0]),
                         std::endian::native);
    }
};

}  // namespace

bool is_mat73_file(const Hdf5File& file, const std::string& path) {
    constexpr std::string_view kHeader = "MATLAB 7.3";
    constexpr std::size_t kMostAsked = 64;
    if (core::first_bytes(path, kHeader.size()) == kHeader) return true;
    const Hdf5Handle root = file.open_root();
    std::vector<std::string> links = links_of(root).names;
    links.resize(std::min(links.size(), kMostAsked));
    return std::any_of(links.begin(), links.end(), [&](const std::string& link) {
        return H5Aexists_by_name(root.id(), link.c_str(), kClass, H5P_DEFAULT) > 0;
    });
}

std::unique_ptr<ArrayFile> open_mat73_file(const std::string& path) {
    return std::make_unique<Mat73File>(path);
}

}  // namespace nlos
