// SPDX-License-Identifier: MIT
#pragma once

#include "apps/sweep/sweep_plan.h"
#include "apps/sweep/sweep_runner.h"

#include <optional>
#include <string>

namespace apps {

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

}  // namespace apps
