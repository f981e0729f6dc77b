// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/prepared_capture.h"
#include "renderer/core/capture/capture.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What looks wrong about a capture, a sentence each, for people:
///
/// - nothing observed, or no light at all;
/// - hot, dead and negative bins and points, which are left out of all that follows; see
///   find_faults();
/// - counts from which a background was taken off;
/// - a time axis that cuts most light off, where the capture's provenance knows how much there is;
/// - radiance that is whole numbers throughout, or counts that are not: the unit is wrong;
/// - a mistake in describing the capture that explains it decisively better than its description,
///   with the option that mends it: units of length or time, one way for round trip, half the
///   wall's width for all of it, device segments in or out, x and y exchanged, an axis or time
///   reversed, time zero off; see recognise_mistakes() and possible_corrections().
///
/// Where no single mistake explains it:
///
/// - light that arrives before the shortest possible path, |l - s| plus device segments: time zero
///   is late;
/// - first light that moves along the wall faster than any path length can change (1 m per metre of
///   sensing point, 2 if confocal): bins are narrower than given;
/// - first light of a confocal scan that bends over the wall more than any path length can, or less
///   than that of points, edges and tips: bins are narrower or wider than given, or the wall's size
///   is wrong, see bend_of_first_light().
///
/// Only bins that were observed count, and first light only where it came after they began.
///
/// costs     a look at all values, and for mistakes at most 196 histograms: one fit of a tenth of a
///           second on one core where the description explains the data well, else some 10 to 25
/// returns   empty when nothing does; nothing about timing for captures too small or dark to tell,
///           nor for images
/// throws    nothing
std::vector<std::string> capture_warnings(const core::Capture& capture);

/// What a look at a capture tells before a method is run, a line each, for people: what its numbers
/// are, background, where light begins and ends, what was observed, the set-up's response.
///
/// plan   of what becomes of its histograms
std::vector<std::string> survey_capture(const PreparedCapture& prepared,
                                        const PreparationPlan& plan,
                                        const ReconstructSettings& settings);

/// Says of a volume that none of the capture's light can come from where there is some, and how to
/// ask for that; nothing of others, and in the dark.
///
/// plan        as survey_capture()
/// z_range_m   of the volume
std::optional<std::string> volume_warning(const PreparedCapture& prepared,
                                          const PreparationPlan& plan,
                                          const std::array<double, 2>& z_range_m);

}  // namespace nlos
