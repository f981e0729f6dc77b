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

/// The same of points, directions or triangles, with their three numbers last.
template <class Row>
auto array_view(std::vector<Row>& rows, Extents shape, nanobind::handle owner) {
    static_assert(sizeof(Row) == 3 * sizeof(*rows[0].data()));
    shape.push_back(3);
    return array_view(rows.empty() ? nullptr : rows[0].data(), shape, owner);
}

/// What deletes an object with the last array that shows its memory.
template <class T>
nanobind::capsule owner_of(T* owned) {
    return {owned, [](void* p) noexcept { delete static_cast<T*>(p); }};
}

/// An array of its own. Properties return it by rv_policy::reference: by default they would tie it
/// to their object.
template <class T>
Array<T> array_of(std::vector<T> values, const Extents& shape) {
    auto* const owned = new std::vector<T>(std::move(values));
    return array_view(owned->data(), shape, owner_of(owned));
}

/// The same of points, directions or triangles.
template <class Row>
auto array_of(std::vector<Row> rows) {
    auto* const owned = new std::vector<Row>(std::move(rows));
    return array_view(*owned, {owned->size()}, owner_of(owned));
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
