// SPDX-License-Identifier: MIT
#pragma once

#include "apps/scene_truth.h"
#include "apps/sweep/sweep_plan.h"
#include "nlos/compare/metrics.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/progress.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What a run found and took.
struct SweepResult {
    nlos::Metrics metrics;  ///< as compare gives them; all empty for a run that failed
    std::string method;     ///< that reconstructed
    std::optional<double> seconds_render;
    std::optional<double> seconds_noise;
    std::optional<double> seconds_reconstruct;
    std::optional<double> estimated_error;  ///< of the capture without noise, where it is known
    std::vector<std::string> warnings;
    std::optional<std::string> failed;  ///< why there is no result
};

template <class Visitor>
void for_each_field(SweepResult& result, Visitor&& visit) {
    visit("failed", result.failed, "why there is no result");
    visit("metrics", result.metrics, "scores against the scene");
    visit("method", result.method, "that reconstructed");
    visit("seconds_render", result.seconds_render, "time to render [s]");
    visit("seconds_noise", result.seconds_noise, "time to draw the noise [s]");
    visit("seconds_reconstruct", result.seconds_reconstruct, "time to reconstruct [s]");
    visit("estimated_error", result.estimated_error, "of the capture without noise, relative L2");
    visit("warnings", result.warnings, "what casts doubt on the result");
}

/// Does runs one after another and keeps the last capture, with and without noise, for those that
/// need the same.
class SweepRunner {
 public:
    /// Renders, draws noise, reconstructs and compares, all in memory, as the commands do.
    ///
    /// returns  what was found, or why it cannot be; nothing when `progress` asked to stop
    std::optional<SweepResult> do_run(const SweepRun& run, const core::Progress& progress);

 private:
    /// A capture, with what it was made from and took.
    struct Recorded {
        std::string changes;
        core::Capture capture;
        double seconds = 0.0;
        std::optional<double> estimated_error{};
        std::vector<std::string> warnings{};
    };

    void render(const SweepRun& run, const core::Progress& progress);
    void draw_noise(const SweepRun& run);
    SweepResult score(const SweepRun& run, const core::Progress& progress);

    std::optional<Recorded> rendered_;
    std::optional<SceneTruth> truth_;  ///< of the rendered scene
    std::optional<Recorded> noisy_;    ///< of `rendered_`
};

}  // namespace apps
