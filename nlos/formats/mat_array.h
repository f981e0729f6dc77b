// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_reader.h"

#include <algorithm>
#include <string>
#include <type_traits>
#include <vector>

namespace nlos {

/// A numeric array as MATLAB counts its axes.
template <class T>
struct MatArray {
    Shape shape;            ///< at least two extents, first index first
    std::vector<T> values;  ///< first index fastest
};

/// Reads a real numeric array of a MATLAB file; T is float or double.
template <class T>
MatArray<T> read_mat_array(const std::string& path, const std::string& name) {
    const ArrayReader file(path);
    MatArray<T> array{file.shape(name), {}};
    if constexpr (std::is_same_v<T, float>) {
        array.values = file.read_floats(name, array.shape);
    } else {
        array.values = file.read_doubles(name, array.shape);
    }
    std::reverse(array.shape.begin(), array.shape.end());
    return array;
}

}  // namespace nlos
