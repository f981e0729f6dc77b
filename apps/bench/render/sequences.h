// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/gnuplot.h"
#include "renderer/frame_sequence.h"

#include <memory>
#include <string>
#include <vector>

namespace apps {

/// A gate that moves over a scene, or stands still before one that moves, as frames.
struct SequenceCase {
    std::string name;
    std::string scene;
    std::vector<std::string> overrides;  ///< of scene.json
    double gate_start_m = 0.0;
    double gate_width_mm = 10.0;
    double gate_step_mm = 10.0;  ///< per frame; 0: the gate stands still
    int num_frames = 60;
    int num_bins = 1;  ///< of that width; more of them stand still
    int reference_samples = 20'000;
    double frame_s = 0.0;  ///< time between frames, in which objects move [s]

    bool is_static() const { return gate_step_mm == 0.0 && frame_s == 0.0; }
};

/// What is rendered of a sequence, with a method's overrides of scene.json.
struct SequenceSetup {
    SequenceSetup(const SequenceCase& sequence, const std::vector<std::string>& overrides);

    renderer::SceneDescription description;
    core::Scan scan;
    std::shared_ptr<const renderer::Scene> scene;
};

using SequenceFrames = std::vector<core::Transient>;

/// The frames of a sequence to little noise, third bounces of scans integrated: sums of the bins of
/// one long histogram, or frame by frame where objects move.
SequenceFrames reference_frames(const SequenceCase& sequence, std::uint64_t seed);

/// Errors of frames as a line over their numbers from 1 on.
PlotLine line_of_frames(const std::string& title, const std::vector<double>& errors);

}  // namespace apps
