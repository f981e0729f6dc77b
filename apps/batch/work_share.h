// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

namespace apps {

/// The part of a large job that one process does: of the job's numbered pieces, those whose number
/// leaves the remainder `index` when it is divided by `count`.
struct WorkShare {
    std::size_t index = 0;
    std::size_t count = 1;

    bool takes(std::size_t piece) const { return piece % count == index; }
    bool is_everything() const { return count == 1; }
};

/// Which part this process does.
///
/// text     "I/N" with I from 0 to N - 1; empty: what Slurm says of the task of a job array
///          (SLURM_ARRAY_TASK_ID, _MIN, _MAX, _STEP), and everything outside of one
/// throws   core::Error for any other text
WorkShare read_work_share(const std::string& text);

/// How a batch script asks Slurm for a job array.
struct ArrayJob {
    std::string name;     ///< of the job
    std::string command;  ///< one line of shell, to which task I of N adds `--shard I/N`
    std::string folder;   ///< where the logs of the tasks go
    std::size_t num_tasks = 1;
    int cpus_per_task = 1;
};

/// The script, for `sbatch`: tasks that are preempted get SIGTERM a minute before the end of their
/// time, and are started again.
std::string slurm_script(const ArrayJob& job);

/// A text as one word of a shell's command line.
std::string shell_word(const std::string& text);

}  // namespace apps
