// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/methods/methods.h"
#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "nlos/reconstruction/volume.h"

namespace nlos {

// What reconstruct() chooses from a capture where its settings leave it open. Each choice is
// entered into the settings.

/// Chooses the method and enters it and what it takes from the capture's provenance: `auto` lets
/// the solver explain a recorded response.
MethodChoice choose_and_enter_method(const core::Capture& capture,
                                     ReconstructSettings& settings,
                                     PreparedCapture& prepared);

/// Fills in merge_bins, ambient and, where a method has it, snr, and says what becomes of the
/// histograms.
PreparationPlan choose_preparation(const PreparedCapture& prepared, ReconstructSettings& settings);

/// What the solver explains of the histograms instead of having it taken off: moves the plan's
/// ambient light here.
///
/// axis   of the prepared histograms
Measurement take_measurement(const PreparedCapture& prepared,
                             const ReconstructSettings& settings,
                             const core::TimeAxis& axis,
                             PreparationPlan& plan);

/// Whether a virtual wave is propagated.
bool uses_wave(const ReconstructSettings& settings);

/// Whether histograms are multiplied by range^power against the falloff of light. A confocal scan
/// lights every voxel from all over the wall; there the factor would only let far wall points
/// outvote near ones.
bool makes_up_for_falloff(const core::WallScan& scan, const ReconstructSettings& settings);

/// Columns at the scan's points or evenly over its footprint, depths at the bins' ranges.
void choose_axes(const core::WallScan& scan,
                 const core::TimeAxis& axis,
                 const WallFrame& wall,
                 ReconstructSettings& settings,
                 VolumeAxes& axes);

}  // namespace nlos
