// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/frame_sequence.h"

#include <memory>

namespace renderer {

/// Renders by resampling, in frames that know nothing of each other and are averaged.
///
/// Within a frame pairs and bins reuse each other's paths, so their noise is correlated; between
/// frames it is not, and the variance is taken from the spread of frames. Orders 1 and 2 are added,
/// and on images order 1, without sampling. Arguments and results are those of render(); `samples`
/// counts candidate paths.
RenderResult render_restir(std::shared_ptr<const Scene> scene,
                           const core::Scan& scan,
                           const core::HistogramAxes& axes,
                           const RenderSettings& settings,
                           const core::Progress& progress);

/// Renders the frames of a sequence, each from the paths of the frame before it too.
/// scan   must outlive what is returned
FrameRenderer make_restir_frame_renderer(const core::Scan& scan, const RenderSettings& settings);

}  // namespace renderer
