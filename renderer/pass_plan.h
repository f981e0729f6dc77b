// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/settings/render_settings.h"

#include <optional>

namespace renderer {

/// How samples are dealt out to passes. A pass spreads its own evenly, so that few long passes have
/// less noise than many short ones; the spread of the passes tells how much. For a variance of each
/// bin there are many short ones.
struct PassPlan {
    int samples_per_pass = 1;  ///< of each pair
    int num_passes = 1;
};

/// Whether a time or an error ends the passes, not a number of samples.
bool is_open_ended(const RenderSettings& settings);

/// The passes for the number of samples asked for, or a little more; of open-ended renders short
/// ones without end, the first kPilotPasses of which tell how much there is to do.
PassPlan plan_passes(const core::Scan& scan, const RenderSettings& settings);

inline constexpr int kPilotPasses = 8;

/// Passes that suit what is left to do once the pilot passes have done a fraction of it; none where
/// short ones may go on, which would then not be worth dropping.
std::optional<PassPlan> plan_after_pilot(const core::Scan& scan,
                                         const RenderSettings& settings,
                                         double fraction);

}  // namespace renderer
