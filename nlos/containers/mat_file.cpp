// SPDX-License-Identifier: MIT
#include "nlos/containers/mat_file.h"

#include "nlos/containers/file_memory.h"
#include "renderer/core/error.h"
#include "renderer/core/output_file.h"
#include "renderer/core/sandboxed_process.h"

#include <fmt/core.h>
#include <matio.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <type_traits>

namespace nlos {
namespace {

using MatFile = std::unique_ptr<mat_t, int (*)(mat_t*)>;
using MatPointer = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

// Layout of a v5 file: a text header, then elements of an 8-byte tag (type, size) and a body.
constexpr std::uint64_t kMatHeaderBytes = 128;
constexpr std::uint64_t kTagBytes = 8;

[[noreturn]] void throw_damaged_mat(const std::string& path) {
    throw core::Error(path, "is damaged or cut short", "must be a complete MATLAB v5 file");
}

std::uint32_t swap_bytes(std::uint32_t bits) {
    return bits >> 24 | (bits >> 8 & 0xff00U) | (bits << 8 & 0xff0000U) | bits << 24;
}

/// Checks that every element lies within the file, which the library takes for granted.
void check_elements(const std::string& path) {
    std::error_code error;
    const std::uint64_t file_bytes = std::filesystem::file_size(path, error);
    std::ifstream file(path, std::ios::binary);
    std::array<char, kMatHeaderBytes> header{};
    if (error || !file.read(header.data(), header.size())) throw_damaged_mat(path);
    const bool swapped = header[kMatHeaderBytes - 2] == 'M';
    for (std::uint64_t begin = kMatHeaderBytes; begin < file_bytes;) {
        std::array<std::uint32_t, 2> tag{};
        file.seekg(static_cast<std::streamoff>(begin));
        if (!file.read(reinterpret_cast<char*>(tag.data()), kTagBytes)) throw_damaged_mat(path);
        const std::uint32_t type = swapped ? swap_bytes(tag[0]) : tag[0];
        const std::uint32_t size = swapped ? swap_bytes(tag[1]) : tag[1];
        const bool is_variable = type == MAT_T_MATRIX || type == MAT_T_COMPRESSED;
        begin += kTagBytes + size;
        if (!is_variable || size == 0 || begin > file_bytes) throw_damaged_mat(path);
    }
}

MatFile open_mat(const std::string& path) {
    if (!is_mat5_file(path)) {
        throw core::Error(path, "is no MATLAB v5 file", "must be saved as v5, v6 or v7");
    }
    check_elements(path);
    MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
    if (!file) throw_damaged_mat(path);
    return file;
}

/// Extents of a variable after checking them against the file's size and the memory.
Shape checked_shape(const matvar_t& variable, const std::string& path) {
    // Deflate shrinks by less than 1032 to 1.
    constexpr std::uint64_t kLargestRatio = 1100;
    constexpr int kHighestRank = 8;
    const std::string where = path + ": " + variable.name;
    if (variable.rank < 2 || variable.rank > kHighestRank || variable.dims == nullptr) {
        throw_damaged_mat(path);
    }
    const Shape shape(variable.dims, variable.dims + variable.rank);
    const std::uint64_t most = std::filesystem::file_size(path) * kLargestRatio;
    std::uint64_t count = 1;
    for (const std::size_t extent : shape) {
        if (extent == 0) throw core::Error(where, "is empty", "must hold numbers");
        if (extent > most / count) {
            throw core::Error(where,
                              "claims shape " + shape_text(shape) + ", more than the file holds",
                              "must be complete");
        }
        count *= extent;
    }
    require_memory(count * 2 * sizeof(double), where);
    return shape;
}

template <class Stored, class T>
void append(const matvar_t& variable, std::size_t count, std::vector<T>& values) {
    const auto* stored = static_cast<const Stored*>(variable.data);
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<T>(stored[i]));
}

template <class T>
void convert(const matvar_t& variable, std::size_t count, std::vector<T>& values) {
    switch (variable.class_type) {
        case MAT_C_DOUBLE:
            return append<double>(variable, count, values);
        case MAT_C_SINGLE:
            return append<float>(variable, count, values);
        case MAT_C_INT8:
            return append<std::int8_t>(variable, count, values);
        case MAT_C_UINT8:
            return append<std::uint8_t>(variable, count, values);
        case MAT_C_INT16:
            return append<std::int16_t>(variable, count, values);
        case MAT_C_UINT16:
            return append<std::uint16_t>(variable, count, values);
        case MAT_C_INT32:
            return append<std::int32_t>(variable, count, values);
        case MAT_C_UINT32:
            return append<std::uint32_t>(variable, count, values);
        default:
            break;
    }
}

bool is_number_class(const matvar_t& variable) {
    return variable.isComplex == 0 && variable.class_type >= MAT_C_DOUBLE &&
           variable.class_type <= MAT_C_UINT32;
}

std::vector<std::string> names_of_variables(const std::string& path) {
    const MatFile file = open_mat(path);
    std::vector<std::string> names;
    while (true) {
        const MatPointer variable(Mat_VarReadNextInfo(file.get()), Mat_VarFree);
        if (!variable) return names;
        if (variable->name != nullptr) names.emplace_back(variable->name);
    }
}

template <class T>
MatArray<T> read_with_library(const std::string& path, const std::string& variable) {
    const MatFile file = open_mat(path);
    const MatPointer info(Mat_VarReadInfo(file.get(), variable.c_str()), Mat_VarFree);
    if (!info) {
        throw core::Error(
            path + ": " + variable, "is missing or damaged", "must be a number array");
    }
    if (!is_number_class(*info)) {
        throw core::Error(path + ": " + variable, "is not a real array", "must be a number array");
    }
    MatArray<T> array{checked_shape(*info, path), {}};
    std::size_t count = 1;
    for (const std::size_t extent : array.shape) count *= extent;
    if (Mat_VarReadDataAll(file.get(), info.get()) != 0 || info->data == nullptr ||
        info->nbytes < count * static_cast<std::size_t>(info->data_size)) {
        throw_damaged_mat(path);
    }
    convert(*info, count, array.values);
    return array;
}

}  // namespace

bool is_mat5_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, kMatHeaderBytes> header{};
    if (!file.read(header.data(), header.size())) return false;
    const std::string_view mark(header.data() + kMatHeaderBytes - 4, 4);
    using namespace std::string_view_literals;
    return mark == "\x00\x01IM"sv || mark == "\x01\x00MI"sv;
}

std::vector<std::string> mat_variable_names(const std::string& path) {
    // Names end with a zero each.
    const std::string answer = core::run_sandboxed(path, [&] {
        std::string text;
        for (const std::string& name : names_of_variables(path))
            text += std::string(name.c_str()) + '\0';
        return text;
    });
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin < answer.size();) {
        names.emplace_back(answer.c_str() + begin);
        begin += names.back().size() + 1;
    }
    return names;
}

template <class T>
MatArray<T> read_mat_array(const std::string& path, const std::string& variable) {
    // The number of extents, these, and the values.
    const std::string answer = core::run_sandboxed(path, [&] {
        const MatArray<T> array = read_with_library<T>(path, variable);
        const std::size_t rank = array.shape.size();
        std::string bytes(reinterpret_cast<const char*>(&rank), sizeof(rank));
        bytes.append(reinterpret_cast<const char*>(array.shape.data()), rank * sizeof(rank));
        bytes.append(reinterpret_cast<const char*>(array.values.data()),
                     array.values.size() * sizeof(T));
        return bytes;
    });
    MatArray<T> array;
    std::size_t rank = 0;
    std::memcpy(&rank, answer.data(), sizeof(rank));
    const std::size_t begin = (rank + 1) * sizeof(rank);
    array.shape.resize(rank);
    std::memcpy(array.shape.data(), answer.data() + sizeof(rank), rank * sizeof(rank));
    array.values.resize((answer.size() - begin) / sizeof(T));
    std::memcpy(array.values.data(), answer.data() + begin, array.values.size() * sizeof(T));
    return array;
}

template MatArray<float> read_mat_array<float>(const std::string&, const std::string&);
template MatArray<double> read_mat_array<double>(const std::string&, const std::string&);

void write_mat_file(const std::string& path, const std::vector<MatVariable>& variables) {
    core::OutputFile output(path);
    const auto check = [&](bool ok) {
        if (!ok) throw core::Failure(path, "cannot be written (disk full?)");
    };
    MatFile file(Mat_CreateVer(output.temporary().c_str(), nullptr, MAT_FT_MAT5), Mat_Close);
    check(file != nullptr);
    for (const MatVariable& variable : variables) {
        Shape shape = variable.shape;
        const MatPointer array(
            std::visit(
                [&](const auto& values) {
                    using T = typename std::decay_t<decltype(values)>::value_type;
                    constexpr matio_classes kClass = std::is_same_v<T, double>  ? MAT_C_DOUBLE
                                                     : std::is_same_v<T, float> ? MAT_C_SINGLE
                                                                                : MAT_C_UINT16;
                    constexpr matio_types kType = std::is_same_v<T, double>  ? MAT_T_DOUBLE
                                                  : std::is_same_v<T, float> ? MAT_T_SINGLE
                                                                             : MAT_T_UINT16;
                    return Mat_VarCreate(variable.name.c_str(),
                                         kClass,
                                         kType,
                                         static_cast<int>(shape.size()),
                                         shape.data(),
                                         const_cast<T*>(values.data()),  // only read
                                         MAT_F_DONT_COPY_DATA);
                },
                variable.values),
            Mat_VarFree);
        check(array != nullptr);
        check(Mat_VarWrite(file.get(), array.get(), MAT_COMPRESSION_ZLIB) == 0);
    }
    check(Mat_Close(file.release()) == 0);
    output.commit();
}

}  // namespace nlos
