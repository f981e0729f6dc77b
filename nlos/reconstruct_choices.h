// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/methods.h"
#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/second_capture.h"
#include "nlos/reconstruction/reconstruction.h"

namespace nlos {

/// What becomes of a capture before a method gets it.
struct ReconstructionPlan {
    PreparedCapture prepared;     ///< cropped and, where the method needs it, converted
    PreparationPlan preparation;  ///< of its histograms
    double range_power = 0.0;     ///< of range, which prepared histograms are multiplied by
    core::TimeAxis time_axis;     ///< of prepared histograms
    core::ObservedBins observed;  ///< likewise
    Measurement measurement;      ///< what the method explains of them
    double dark_from_m;           ///< from this path length on prepared histograms hold nothing
    VolumeAxes axes;
    FalloffTrial falloff_trial = FalloffTrial::WhereNeeded;

    /// Whether the noise of the capture that it was made for is known.
    bool knows_noise(const core::Capture& capture) const {
        return knows_its_noise(capture) || preparation.photon;
    }
    /// Whether the method gets other histograms than the cropped ones.
    bool changes_histograms() const {
        return preparation.num_bins != prepared.time_axis.num_bins ||
               !preparation.ambient_per_bin.empty() || preparation.deconvolution ||
               range_power != 0.0;
    }
};

/// Chooses what `result.settings` leave open, all but the falloff, which prepared histograms tell,
/// and enters it there; says what `auto` found, and warns of what was chosen.
///
/// capture   must outlive the plan
/// throws    core::Error when the method cannot serve or a setting does not fit the capture
ReconstructionPlan choose(const core::Capture& capture, Reconstruction& result);

/// What looks wrong about a capture, for people.
std::vector<std::string> warnings_of(const core::Capture& capture,
                                     const ReconstructionPlan& plan,
                                     const ReconstructSettings& settings);

}  // namespace nlos
