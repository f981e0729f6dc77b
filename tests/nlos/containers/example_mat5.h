// SPDX-License-Identifier: MIT
#pragma once

#include <matio.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace nlos {

/// A numeric array for matio, which copies the values.
template <class T>
matvar_t* mat5_numbers(const char* name,
                       matio_classes type_class,
                       matio_types type,
                       std::vector<std::size_t> shape,
                       std::vector<T> values,
                       int flags = 0) {
    return Mat_VarCreate(
        name, type_class, type, static_cast<int>(shape.size()), shape.data(), values.data(), flags);
}

inline matvar_t* mat5_number(const char* name, double value) {
    return mat5_numbers<double>(name, MAT_C_DOUBLE, MAT_T_DOUBLE, {1, 1}, {value});
}

inline matvar_t* mat5_text(const char* name, std::u16string text) {
    std::array<std::size_t, 2> shape{1, text.size()};
    return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UINT16, 2, shape.data(), text.data(), 0);
}

inline matvar_t* mat5_struct(const char* name,
                             std::size_t count,
                             std::vector<const char*> fields,
                             const std::vector<matvar_t*>& values) {
    std::array<std::size_t, 2> shape{1, count};
    matvar_t* made = Mat_VarCreateStruct(
        name, 2, shape.data(), fields.data(), static_cast<unsigned>(fields.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        Mat_VarSetStructFieldByIndex(made, i % fields.size(), i / fields.size(), values[i]);
    }
    return made;
}

inline matvar_t* mat5_cell(const char* name, std::vector<matvar_t*> values) {
    std::array<std::size_t, 2> shape{1, values.size()};
    return Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, shape.data(), values.data(), 0);
}

/// Writes variables, which it frees.
inline void write_mat5_variables(const std::string& path,
                                 const std::vector<matvar_t*>& variables,
                                 matio_compression compression) {
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    for (matvar_t* variable : variables) {
        Mat_VarWrite(file, variable, compression);
        Mat_VarFree(variable);
    }
    Mat_Close(file);
}

/// A capture as some groups store it: an array, a text, a struct in a struct, a cell array, and an
/// array of two structs.
inline void write_example_mat5(const std::string& path, matio_compression compression) {
    std::vector<std::uint16_t> data(24);
    for (std::size_t i = 0; i < data.size(); ++i) data[i] = static_cast<std::uint16_t>(i);
    matvar_t* deep = mat5_struct("deep", 1, {"x"}, {mat5_number(nullptr, 7.0)});
    write_mat5_variables(
        path,
        {mat5_numbers("meas", MAT_C_UINT16, MAT_T_UINT16, {4, 3, 2}, data),
         mat5_text("note", u"h\u00e9\u20ac"),
         mat5_struct("dataset", 1, {"t0", "deep"}, {mat5_number(nullptr, 0.25), deep}),
         mat5_cell("accum",
                   {mat5_numbers<float>(nullptr, MAT_C_SINGLE, MAT_T_SINGLE, {1, 3}, {1, 2, 3}),
                    mat5_text(nullptr, u"two")}),
         mat5_struct("list",
                     2,
                     {"gain", "name"},
                     {mat5_number(nullptr, 1.5),
                      mat5_text(nullptr, u"a"),
                      mat5_number(nullptr, 2.5),
                      mat5_text(nullptr, u"b")}),
         mat5_numbers<std::int64_t>(
             "ticks", MAT_C_INT64, MAT_T_INT64, {1, 2}, {std::int64_t{1} << 40, -3}),
         mat5_numbers<std::uint8_t>(
             "flag", MAT_C_UINT8, MAT_T_UINT8, {1, 2}, {1, 0}, MAT_F_LOGICAL)},
        compression);
}

}  // namespace nlos
