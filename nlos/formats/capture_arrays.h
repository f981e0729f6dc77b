// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/shape.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/json_fwd.h"

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

/// Where the capture came from, and for an image its camera, whose grids are null: no array has a
/// place for it.
core::Json scene_info_of(const core::Capture& capture);

/// The array observed_bins of shape (2, pairs...): first observed bins of all pairs, then the bins
/// after their last ones. H holds 0 in all others, which means that nobody looked.
std::vector<int> observed_array(const std::vector<core::BinRange>& observed);

/// The array frames_observed_bins of shape (F, 2, pairs...): the same of each frame of a sequence.
std::vector<int> observed_array_of_frames(const core::Capture& capture);

/// Copies bins [first, first + count) of [pair][bin] to rows with time slowest.
void copy_rows(const core::Transient& transient, std::size_t first, std::size_t count, float* rows);

/// The reverse of copy_rows().
void copy_bins(const float* rows, std::size_t first, std::size_t count, core::Transient& transient);

/// Copies consecutive members of a stack, each as H, to rows of (stack, T, pairs...).
void copy_stack(const std::vector<core::Transient>& stack,
                std::size_t first,
                std::size_t count,
                float* rows);

/// Writes a transient of the shape of H, at the latest when the writer finishes. Not compressed
/// beyond the least: the noise of rendered and measured histograms leaves deflate little to save
/// for many times the writing time.
template <class Writer>
void write_transient(Writer& file,
                     const std::string& name,
                     const Shape& shape,
                     const core::Transient& transient) {
    file.write_rows(
        name, shape, [&transient](std::size_t first, std::size_t count, std::vector<float>& rows) {
            copy_rows(transient, first, count, rows.data());
        });
}

/// Writes several transients as one array, each of them as H.
template <class Writer>
void write_stack(Writer& file,
                 const std::string& name,
                 Shape shape,
                 const std::vector<core::Transient>& stack) {
    shape.insert(shape.begin(), stack.size());
    file.write_rows(
        name, shape, [&stack](std::size_t first, std::size_t count, std::vector<float>& rows) {
            copy_stack(stack, first, count, rows.data());
        });
}

}  // namespace nlos
