// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"

namespace renderer {

/// Renders by resampling, in independent frames that are averaged.
///
/// Within a frame pairs and bins reuse each other's paths, so that their noise is correlated;
/// between frames it is not, and the variance is estimated from the spread of the frames. Orders 1
/// and 2, on images order 1, are added without sampling. Results are those of render(); `samples`
/// counts candidate paths.
RenderResult render_restir(const RenderTask& task);

/// Renders the frames of a sequence, each of which also reuses the paths of the frame before it.
///
/// A frame is the mean of two and more chains that share nothing: every chain reuses its own past
/// alone, and from their spread follows the error of the mean, past included. `samples` counts the
/// candidate paths of all chains per frame; with `seconds` there are as many chains as the first
/// frame has time for.
///
/// scan   must outlive what is returned
FrameRenderer make_restir_frame_renderer(const core::Scan& scan, const RenderSettings& settings);

}  // namespace renderer
