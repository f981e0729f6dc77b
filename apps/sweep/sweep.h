// SPDX-License-Identifier: MIT
#pragma once

#include "apps/batch/work_share.h"
#include "apps/scene_truth.h"
#include "apps/sweep/sweep_plan.h"
#include "nlos/compare/metrics.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/json_fwd.h"

#include <cstddef>
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

/// The results of a sweep's runs, a file for each: DIR/runs/000012.json.
class SweepResults {
 public:
    /// throws   core::Error when the folder cannot be made
    SweepResults(const SweepPlan& plan, std::string folder);

    /// Whether a run is done. A file that is damaged counts as none.
    /// throws   core::Error for a file of another sweep
    bool has(std::size_t run) const { return read(run).has_value(); }

    void write(const SweepRun& run, const SweepResult& result) const;

    std::size_t num_done() const;

    /// One row per run, for a table: its number, values and results side by side. Nothing unless
    /// all runs are done.
    std::optional<core::Json> rows() const;

 private:
    std::string path_of(std::size_t run) const;
    std::optional<core::Json> read(std::size_t run) const;

    const SweepPlan& plan_;
    std::string folder_;  ///< of the files
};

/// What a process did of a sweep. This room runs the grid of settings of a sweep file: the file is
/// sweep_settings.h, its numbered runs are sweep_plan.h, and table and plots of all of them
/// sweep_summary.h.
struct SweepProgress {
    std::size_t num_new = 0;   ///< runs done now
    std::size_t num_kept = 0;  ///< of the share, done before
    bool interrupted = false;
};

/// Does the runs of a share that have no result yet, one after another. A run that fails for its
/// settings' sake has a result that says so.
///
/// progress   asked to stop, the run in flight is given up
/// throws     core::Error for a folder with results of another sweep; core::Failure when a result
///            cannot be written
SweepProgress do_share(const SweepPlan& plan,
                       const SweepResults& results,
                       const WorkShare& share,
                       const core::Progress& progress);

}  // namespace apps
