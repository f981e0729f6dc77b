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
/// ones without end.
///
/// is_even   samples of a pass are spread so evenly that longer ones do much more
PassPlan plan_passes(const core::Scan& scan, const RenderSettings& settings, bool is_even);

/// After so many passes of a plan it is known how much there is to do.
inline constexpr int kPilotPasses = 8;

/// Longer passes that suit what is left to do once kPilotPasses have done a fraction of it, at most
/// 8 times as long: where samples are spread evenly, those may turn out to do much more. None where
/// the passes may go on, which would then not be worth dropping.
///
/// samples_per_pass   of the passes that were made
std::optional<PassPlan> plan_longer_passes(const core::Scan& scan,
                                           const RenderSettings& settings,
                                           bool is_even,
                                           int samples_per_pass,
                                           double fraction);

}  // namespace renderer
