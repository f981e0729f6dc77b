// SPDX-License-Identifier: MIT
#pragma once

#include <matio.h>

#include <cstdint>
#include <string>
#include <vector>

namespace nlos {

/// One array of a MATLAB file to be made; first index fastest.
struct MatVariableToWrite {
    std::string name;
    matio_classes type_class;
    matio_types type;
    std::vector<std::size_t> shape;
    void* values;  ///< only read, though matio asks for it so
};

template <class T>
MatVariableToWrite mat_variable(const std::string& name,
                                std::vector<std::size_t> shape,
                                const std::vector<T>& values) {
    void* data = const_cast<T*>(values.data());
    if constexpr (std::is_same_v<T, std::uint8_t>) {
        return {name, MAT_C_UINT8, MAT_T_UINT8, std::move(shape), data};
    } else if constexpr (std::is_same_v<T, std::uint16_t>) {
        return {name, MAT_C_UINT16, MAT_T_UINT16, std::move(shape), data};
    } else {
        static_assert(std::is_same_v<T, double>);
        return {name, MAT_C_DOUBLE, MAT_T_DOUBLE, std::move(shape), data};
    }
}

/// Writes a MATLAB v5 file with the given arrays.
inline void write_mat(const std::string& path,
                      const std::vector<MatVariableToWrite>& variables,
                      matio_compression compression = MAT_COMPRESSION_ZLIB) {
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    for (const MatVariableToWrite& variable : variables) {
        std::vector<std::size_t> shape = variable.shape;
        matvar_t* array = Mat_VarCreate(variable.name.c_str(),
                                        variable.type_class,
                                        variable.type,
                                        static_cast<int>(shape.size()),
                                        shape.data(),
                                        variable.values,
                                        0);
        Mat_VarWrite(file, array, compression);
        Mat_VarFree(array);
    }
    Mat_Close(file);
}

}  // namespace nlos
