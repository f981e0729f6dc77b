// SPDX-License-Identifier: MIT
#pragma once

#include "apps/python/arrays.h"
#include "renderer/core/capture/capture.h"

namespace python {

/// Histograms with time as first axis; read and written in place.
using HistogramArray = nanobind::ndarray<float, nanobind::device::cpu>;

/// The grid of points, or the length of their list.

/// Time, then the axes of H that stand for a capture's pairs: (Sx, Sy), (S), (Lx, Ly, Sx, Sy),
/// (L, S) or (width, height).
Extents histogram_shape(const core::Scan& scan, std::size_t num_bins);

/// Histograms as NumPy sees them, see histogram_shape(), in the memory they have.
template <class T>
Array<T> histogram_view(T* values,
                        std::size_t num_bins,
                        const core::Scan& scan,
                        nanobind::handle owner) {
    const Extents shape = histogram_shape(scan, num_bins);
    Extents strides(shape.size(), 1);
    std::size_t stride = num_bins;
    for (std::size_t axis = shape.size(); --axis > 0; stride *= shape[axis]) {
        strides[axis] = stride;
    }
    return array_view(values, shape, owner, strides);
}
inline Array<float> histogram_view(core::Transient& transient,
                                   const core::Scan& scan,
                                   nanobind::handle owner) {
    return histogram_view(transient.values().data(), transient.num_bins(), scan, owner);
}

/// Histograms that NumPy makes of numbers: what is float32 and may be written is taken as it is.
/// throws   core::Error naming the argument when they are no real numbers
HistogramArray histograms_from(nanobind::handle value, const std::string& name);

/// Histograms of an array (T, ...) whose other axes number the pairs, last index fastest. An array
/// whose time axis is the fastest one in memory is borrowed, any other copied.
core::Transient transient_from(const HistogramArray& array);

}  // namespace python
