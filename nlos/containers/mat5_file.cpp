// SPDX-License-Identifier: MIT
#include "nlos/containers/array_file.h"
#include "nlos/containers/deflated_bytes.h"
#include "nlos/containers/file_memory.h"
#include "nlos/containers/matlab_name.h"
#include "nlos/containers/stored_number.h"
#include "nlos/containers/unicode_text.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/system/process.h"
#include "renderer/core/system/sandboxed_process.h"

#include <fmt/core.h>
#include <matio.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

namespace nlos {
namespace {

using MatHandle = std::unique_ptr<mat_t, int (*)(mat_t*)>;
using MatPointer = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

// Layout of a v5 file: a text header, then elements of an 8-byte tag (type, size) and a body.
constexpr std::uint64_t kMatHeaderBytes = 128;
constexpr std::uint64_t kTagBytes = 8;

[[noreturn]] void throw_damaged_mat(const std::string& path) {
    throw core::Error(path, "is damaged or cut short", "must be a complete MATLAB v5 file");
}

/// Checks that every element lies within the file, which the library takes for granted, and holds
/// what is compressed against its checksum, at which the library does not look.
void check_elements(const std::string& path) {
    const core::MappedFile file(path);
    const std::string_view bytes = file.bytes();
    if (bytes.size() < kMatHeaderBytes) throw_damaged_mat(path);
    const std::endian order =
        bytes[kMatHeaderBytes - 2] == 'M' ? std::endian::big : std::endian::little;
    const auto word_at = [&](std::uint64_t place) {
        return static_cast<std::uint32_t>(
            number_at(bytes.data() + place, StoredNumber::UInt32, order));
    };
    for (std::uint64_t begin = kMatHeaderBytes; begin < bytes.size();) {
        if (bytes.size() - begin < kTagBytes) throw_damaged_mat(path);
        const std::uint32_t type = word_at(begin);
        const std::uint32_t size = word_at(begin + 4);
        begin += kTagBytes;
        const bool is_variable = type == MAT_T_MATRIX || type == MAT_T_COMPRESSED;
        if (!is_variable || size == 0 || size > bytes.size() - begin) throw_damaged_mat(path);
        const std::string_view body = bytes.substr(begin, size);
        if (type == MAT_T_COMPRESSED && !unpack(body, DeflateFrame::Zlib, [](auto) {})) {
            throw_damaged_mat(path);
        }
        begin += size;
    }
}

bool is_mat5_file(const std::string& path) {
    using namespace std::string_view_literals;
    const std::string header = core::first_bytes(path, kMatHeaderBytes);
    return header.size() == kMatHeaderBytes &&
           (header.ends_with("\x00\x01IM"sv) || header.ends_with("\x01\x00MI"sv));
}

/// How the values of a class are stored; nothing for what is no number.
std::optional<StoredNumber> number_of(matio_classes type_class) {
    using Number = StoredNumber;
    constexpr std::array kFromDouble{Number::Float64,
                                     Number::Float32,
                                     Number::Int8,
                                     Number::UInt8,
                                     Number::Int16,
                                     Number::UInt16,
                                     Number::Int32,
                                     Number::UInt32,
                                     Number::Int64,
                                     Number::UInt64};
    static_assert(MAT_C_UINT64 - MAT_C_DOUBLE + 1 == kFromDouble.size());
    if (type_class < MAT_C_DOUBLE || type_class > MAT_C_UINT64) return std::nullopt;
    return kFromDouble[static_cast<std::size_t>(type_class - MAT_C_DOUBLE)];
}

std::string type_name(const matvar_t& variable) {
    switch (variable.class_type) {
        case MAT_C_CHAR:
            return "text";
        case MAT_C_CELL:
            return "cell";
        case MAT_C_STRUCT:
            return "struct";
        case MAT_C_SPARSE:
            return "sparse";
        default:
            break;
    }
    const auto number = number_of(variable.class_type);
    if (!number) return "other";
    if (variable.isLogical != 0) return "logical";
    return (variable.isComplex != 0 ? "complex " : "") + type_name(*number);
}

std::size_t element_count(const matvar_t& variable) {
    std::size_t count = 1;
    for (int axis = 0; axis < variable.rank; ++axis) count *= variable.dims[axis];
    return count;
}

/// Whether the parts of a struct or cell array are there; those of an empty one are not.
bool has_parts(const matvar_t& variable, matio_classes wanted) {
    return variable.class_type == wanted && variable.data != nullptr && variable.dims != nullptr;
}

/// Null when there is no such part.
matvar_t* cell_of(matvar_t& variable, std::size_t index) {
    if (!has_parts(variable, MAT_C_CELL) || index >= element_count(variable)) return nullptr;
    return static_cast<matvar_t**>(variable.data)[index];
}

/// The field of an element; of the only one where none is named.
matvar_t* field_of(matvar_t& variable,
                   const std::string& field,
                   std::optional<std::size_t> element) {
    if (!has_parts(variable, MAT_C_STRUCT)) return nullptr;
    const std::size_t count = element_count(variable);
    if (element.value_or(0) >= count || (!element && count > 1)) return nullptr;
    return Mat_VarGetStructFieldByName(&variable, field.c_str(), element.value_or(0));
}

void list(matvar_t* variable, const std::string& name, ArrayNames& found);

void list_fields(matvar_t& variable, const std::string& name, ArrayNames& found) {
    const std::size_t count = element_count(variable);
    const unsigned num_fields = Mat_VarGetNumberOfFields(&variable);
    const char* const* fields = Mat_VarGetStructFieldnames(&variable);
    for (std::size_t element = 0; element < count && found.is_complete; ++element) {
        const std::string owner = count == 1 ? name : fmt::format("{}({})", name, element);
        for (unsigned i = 0; i < num_fields && found.is_complete; ++i) {
            if (fields == nullptr || fields[i] == nullptr) continue;
            const std::string field = fields[i];
            list(field_of(variable, field, element), owner + "." + field, found);
        }
    }
}

/// Notes the names of a variable's parts, or its own if it has none.
void list(matvar_t* variable, const std::string& name, ArrayNames& found) {
    if (variable == nullptr) return;
    if (has_parts(*variable, MAT_C_STRUCT)) return list_fields(*variable, name, found);
    if (has_parts(*variable, MAT_C_CELL)) {
        const std::size_t count = element_count(*variable);
        for (std::size_t i = 0; i < count && found.is_complete; ++i) {
            list(cell_of(*variable, i), fmt::format("{}{{{}}}", name, i), found);
        }
        return;
    }
    if (variable->class_type == MAT_C_STRUCT || variable->class_type == MAT_C_CELL) return;
    found.is_complete = found.names.size() < ArrayNames::kMost;
    if (found.is_complete) found.names.push_back(name);
}

/// A MATLAB v5 file. What a variable holds is known once the file is open; the values of an array
/// are read when they are first asked for, and kept.
class Mat5File : public ArrayFile {
 public:
    explicit Mat5File(const std::string& path)
        : path_(path), file_bytes_(std::filesystem::file_size(path)) {
        check_elements(path_);
        // The library clears whatever room a file claims for the names of fields.
        constexpr std::uint64_t kRoomOfParts = std::uint64_t{1} << 30;
        core::bound_memory(kRoomOfParts + file_bytes_ * kLargestDeflateRatio);
        file_.reset(Mat_Open(path_.c_str(), MAT_ACC_RDONLY));
        if (!file_) throw_damaged_mat(path_);
        while (true) {
            MatPointer variable(Mat_VarReadNextInfo(file_.get()), Mat_VarFree);
            if (!variable) break;
            if (variable->name != nullptr) variables_.push_back(std::move(variable));
        }
        core::bound_memory(core::available_memory_bytes());
    }

    std::string container() const override { return "matlab-v5"; }
    bool first_index_fastest() const override { return true; }

    ArrayNames names() const override {
        ArrayNames found;
        for (const MatPointer& variable : variables_) list(variable.get(), variable->name, found);
        return found;
    }

    std::optional<ArrayDescription> describe(const std::string& name) const override {
        ArrayDescription description;
        if (name == "/") return description;
        matvar_t* variable = find(name);
        if (variable == nullptr) return std::nullopt;
        description.type = type_name(*variable);
        const auto number = number_of(variable->class_type);
        const bool is_text = variable->class_type == MAT_C_CHAR;
        if (!number && !is_text) return description;
        description.shape = checked_shape(*variable, name);
        description.rows_per_read = rows_of_read(*description.shape);
        if (is_text) {
            description.kind = ElementKind::Text;
            description.text = read_text(*variable, name);
        } else if (variable->isComplex == 0) {
            description.kind = variable->isLogical != 0 ? ElementKind::Integer : kind_of(*number);
        }
        return description;
    }

    std::string read(const std::string& name, const WantedRows& rows) const override {
        matvar_t& variable = *find(name);
        const auto number = *number_of(variable.class_type);
        const std::size_t values = element_count(variable);
        if (values == 0) return {};
        read_values(variable, name);
        const std::size_t row = values / variable.dims[variable.rank - 1];
        const auto* begin =
            static_cast<const char*>(variable.data) + rows.first * row * bytes_of(number);
        return convert_numbers(
            begin, rows.count * row, number, std::endian::native, rows.precision);
    }

 private:
    matvar_t* find(const std::string& name) const {
        const auto steps = parse_matlab_name(name);
        if (!steps) return nullptr;
        matvar_t* at = nullptr;
        for (const MatPointer& variable : variables_) {
            if (steps->front().field == variable->name) at = variable.get();
        }
        for (std::size_t i = 1; i < steps->size() && at != nullptr; ++i) {
            const MatlabStep& step = (*steps)[i];
            at = step.is_cell() ? cell_of(*at, step.cell) : field_of(*at, step.field, step.element);
        }
        return at;
    }

    /// The text of a row of characters, or of none.
    std::optional<std::string> read_text(matvar_t& variable, const std::string& name) const {
        const std::size_t count = element_count(variable);
        if (count == 0) return "";
        if (variable.rank != 2 || variable.dims[0] != 1) return std::nullopt;
        read_values(variable, name);
        const std::size_t unit_bytes = Mat_SizeOf(variable.data_type);
        if (unit_bytes != 1 && unit_bytes != 2 && unit_bytes != 4) return std::nullopt;
        return utf8_text(static_cast<const char*>(variable.data),
                         variable.nbytes / unit_bytes,
                         unit_bytes,
                         std::endian::native);
    }

    /// Extents of an array, slowest first, after checking them against the file's size.
    Shape checked_shape(const matvar_t& variable, const std::string& name) const {
        constexpr int kHighestRank = 8;
        if (variable.rank < 2 || variable.rank > kHighestRank || variable.dims == nullptr) {
            throw_damaged_mat(path_);
        }
        Shape shape(variable.dims, variable.dims + variable.rank);
        std::reverse(shape.begin(), shape.end());
        if (total_bytes(shape, 1) > file_bytes_ * kLargestDeflateRatio) {
            throw core::Error(path_ + ": " + name,
                              "claims shape " + shape_text(shape) + ", more than the file holds",
                              "must be complete");
        }
        return shape;
    }

    /// Reads the values of an array unless they are there.
    void read_values(matvar_t& variable, const std::string& name) const {
        if (variable.data != nullptr) return;
        // As stored, and as the caller gets them.
        require_memory(total_bytes(checked_shape(variable, name), 2 * sizeof(double)),
                       path_ + ": " + name);
        if (Mat_VarReadDataAll(file_.get(), &variable) != 0 || variable.data == nullptr ||
            variable.nbytes <
                element_count(variable) * static_cast<std::size_t>(variable.data_size)) {
            throw_damaged_mat(path_);
        }
    }

    std::string path_;
    std::uint64_t file_bytes_ = 0;
    MatHandle file_{nullptr, Mat_Close};
    std::vector<MatPointer> variables_;
};

}  // namespace

Container mat5_container() {
    return {"MATLAB v5", is_mat5_file, open_as<Mat5File>};
}

}  // namespace nlos
