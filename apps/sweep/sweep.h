// SPDX-License-Identifier: MIT
#pragma once

#include "apps/batch/work_share.h"
#include "apps/sweep/sweep_results.h"
#include "renderer/core/progress.h"

#include <cstddef>

namespace apps {

/// What a process did of a sweep. This room runs the grid of settings of a sweep file: the file is
/// sweep_settings.h, its numbered runs are sweep_plan.h, one run is sweep_runner.h, the files of
/// runs are sweep_results.h, and table and plots of all of them sweep_summary.h.
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
