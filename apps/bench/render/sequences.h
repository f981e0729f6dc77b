// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "renderer/core/progress.h"
#include "renderer/frame_sequence.h"

#include <array>
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

/// How one method does on a sequence, on one thread.
struct SequenceBench {
    std::string sequence;            ///< gate and measurement
    std::string method;              ///< estimator and candidates
    double seconds_per_frame = 0.0;  ///< CPU time
    double rel_mse = 0.0;            ///< mean over the later frames and all seeds
    double trimmed_rel_mse = 0.0;    ///< the same without the worst 0.2 % of values
    double sum_ratio = 0.0;          ///< sum of all values over that of the reference
    double gain = 0.0;          ///< relative MSE times seconds of the first method over this one's
    double trimmed_gain = 0.0;  ///< the same for the trimmed error
    double accepted_share = 0.0;            ///< of shifts; 0: none was tried
    double shifts_per_frame = 0.0;          ///< shifts tried in a frame
    double merges_per_frame = 0.0;          ///< merges of two reservoirs in a frame
    std::vector<double> rel_mse_of_frames;  ///< frame by frame
};
NLOS_FIGURES(SequenceBench,
             sequence,
             method,
             seconds_per_frame,
             rel_mse,
             trimmed_rel_mse,
             sum_ratio,
             gain,
             trimmed_gain,
             accepted_share,
             shifts_per_frame,
             merges_per_frame,
             rel_mse_of_frames);

/// Errors of frames as a line over their numbers from 1 on.
PlotLine line_of_frames(const std::string& title, const std::vector<double>& errors);

/// A method and the settings that make it.
struct SequenceMethod {
    std::string name;
    std::vector<std::string> overrides;
};

/// Runs methods over a sequence and measures them against two independent references, whose
/// product has no bias from their noise.
///
/// methods     the first is what gains are counted against
/// num_seeds   runs per method
std::vector<SequenceBench> bench_sequence(const SequenceCase& sequence,
                                          const std::vector<SequenceMethod>& methods,
                                          int num_seeds,
                                          const core::Progress& progress);

/// What the standard table is made of.
struct SequenceScenes {
    std::string scan = "scenes/bars/scene.json";
    std::string image = "scenes/room/scene.json";
    std::array<int, 2> image_resolution{128, 96};
    std::string moving_scan = "scenes/traffic/scan.json";
    std::string moving_image = "scenes/traffic/scene.json";
};

/// The sequences and methods of the standard table.
std::vector<SequenceCase> standard_sequences(const SequenceScenes& scenes, int num_frames);
std::vector<SequenceMethod> standard_methods(const SequenceCase& sequence);

}  // namespace apps
