// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace nlos {

/// True when the file starts like a MATLAB file of version 5. Throws nothing.
bool is_mat5_file(const std::string& path);

/// The names of the variables of a MATLAB v5 file.
/// Throws core::Error when the file is damaged or cut short.
std::vector<std::string> mat_variable_names(const std::string& path);

/// A numeric array as MATLAB stores it.
template <class T>
struct MatArray {
    Shape shape;            ///< at least two extents
    std::vector<T> values;  ///< first index fastest
};

/// Reads a real numeric array of a MATLAB v5 file; T is float or double.
///
/// throws   core::Error when the file is damaged, or the variable missing or no real number array;
///          core::Failure when it would not fit in memory
template <class T>
MatArray<T> read_mat_array(const std::string& path, const std::string& variable);

/// A real array to write, first index fastest, or a struct of shape (1, 1).
struct MatVariable {
    std::string name;
    Shape shape;
    std::variant<std::vector<std::uint16_t>,
                 std::vector<float>,
                 std::vector<double>,
                 std::vector<MatVariable>>  ///< the fields of a struct
        values;
};

/// Writes a MATLAB v5 file, compressed; whole or not at all.
///
/// throws   core::Error for a bad target or a variable of 2 GiB or more, which the format cannot
///          hold; core::Failure when writing fails
void write_mat_file(const std::string& path, const std::vector<MatVariable>& variables);

}  // namespace nlos
