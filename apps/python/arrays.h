// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/types.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstdint>
#include <string>
#include <vector>

namespace python {

/// Sizes, or strides, of an array along its axes.
using Extents = std::vector<std::size_t>;

/// A NumPy array as the stubs know it.
template <class T>
using Array = nanobind::ndarray<nanobind::numpy, T>;

/// An array that shows memory of `owner`, which lives as long as the array.
///
/// strides   in elements; empty: last index fastest
template <class T>
Array<T> array_view(T* data,
                    const Extents& shape,
                    nanobind::handle owner,
                    const Extents& strides = {}) {
    const std::vector<std::int64_t> signed_strides(strides.begin(), strides.end());
    return {
        data, shape.size(), shape.data(), owner, strides.empty() ? nullptr : signed_strides.data()};
}

/// The same of points or directions, with the three coordinates last.
inline Array<double> array_view(std::vector<core::Vec3>& vectors,
                                Extents shape,
                                nanobind::handle owner) {
    static_assert(sizeof(core::Vec3) == 3 * sizeof(double));
    shape.push_back(3);
    return array_view(vectors.empty() ? nullptr : vectors.front().data(), shape, owner);
}

/// An array of its own. Properties return it by rv_policy::reference: by default they would tie it
/// to their object.
template <class T>
Array<T> array_of(std::vector<T> values, const Extents& shape) {
    auto* const owned = new std::vector<T>(std::move(values));
    const nanobind::capsule owner(owned,
                                  [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
    return array_view(owned->data(), shape, owner);
}

using DoubleArray = nanobind::ndarray<const double, nanobind::device::cpu, nanobind::c_contig>;
using IndexArray = nanobind::ndarray<const std::int64_t, nanobind::device::cpu, nanobind::c_contig>;

/// What NumPy makes of numbers of any kind: an array of real numbers as `dtype`, without a copy
/// where it is one already.
///
/// name     what messages call the value
/// throws   core::Error when the value is something else
nanobind::object numbers_from(nanobind::handle value, const char* dtype, const std::string& name);

inline DoubleArray doubles_from(nanobind::handle value, const std::string& name) {
    return nanobind::cast<DoubleArray>(numbers_from(value, "float64", name));
}

/// Points or directions from numbers of shape (..., 3).
/// throws   core::Error naming the argument
std::vector<core::Vec3> vectors_from(nanobind::handle value, const std::string& name);

/// Sizes as Python writes them.
std::string shape_text(const Extents& shape);
/// Throws core::Error naming the argument unless it has the shape wanted.
void require_shape(const Extents& found, const Extents& wanted, const std::string& name);
template <class Array>
Extents shape_of(const Array& array) {
    return {array.shape_ptr(), array.shape_ptr() + array.ndim()};
}

}  // namespace python
