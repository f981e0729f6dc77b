// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"
#include "renderer/core/capture.h"

namespace nlos {

// How a capture stands in arrays with time slowest, as y-tal defined it and .npz files share it.

/// Which of y-tal's shapes a scan has.
struct ArrayLayout {
    bool exhaustive;
    bool grids;  ///< points as (X, Y, 3) and not as (N, 3), or an image
};

ArrayLayout array_layout(const core::Scan& scan);

/// (X, Y) or (N,) of some points.
Shape point_extents(const core::WallPoints& points, const ArrayLayout& layout);

/// (T, pairs...) of H: (T, Sx, Sy), (T, Lx, Ly, Sx, Sy), (T, S) or (T, L, S); (T, width, height) of
/// an image.
Shape histogram_shape(const core::Capture& capture);

/// The array observed_bins of shape (2, pairs...): first observed bins of all pairs, then the bins
/// after their last ones. H holds 0 in all others, which means that nobody looked.
std::vector<int> observed_array(const std::vector<core::BinRange>& observed);

/// Copies bins [first, first + count) of [pair][bin] to rows with time slowest.
void copy_rows(const core::Transient& transient, std::size_t first, std::size_t count, float* rows);

/// Copies consecutive members of a stack, each as H, to rows of (stack, T, pairs...).
void copy_stack(const std::vector<core::Transient>& stack,
                std::size_t first,
                std::size_t count,
                float* rows);

}  // namespace nlos
