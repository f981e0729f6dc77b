// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace apps {

/// The part of a large job that one process does: of the job's numbered pieces, those whose number
/// leaves the remainder `index` when it is divided by `count`.
struct WorkShare {
    std::size_t index = 0;
    std::size_t count = 1;

    bool takes(std::size_t piece) const { return piece % count == index; }
};

/// Which part this process does.
///
/// text     "I/N" with I from 0 to N - 1; empty: what Slurm says of the task of a job array
///          (SLURM_ARRAY_TASK_ID, _MIN, _MAX, _STEP), and everything outside of one
/// throws   core::Error for any other text
WorkShare read_work_share(const std::string& text);

/// How a batch script asks Slurm for a job array.
struct ArrayJob {
    std::string command;  ///< of this program, which has a file, a folder and settings
    std::string file;     ///< that says what is to be done
    std::string folder;   ///< of the results
    std::vector<std::string> settings;  ///< `key.path=value` texts
    std::size_t num_tasks = 1;
    int cpus_per_task = 1;
};

/// The script, for `sbatch`: task I of N runs the command with `--shard I/N` and as many threads as
/// it has processors. Tasks get SIGTERM a minute before their time ends; preempted ones are started
/// again. Logs go where the script is submitted.
std::string slurm_script(const ArrayJob& job);

/// The number of tasks that `--slurm` asks for; `otherwise` where it names none.
/// throws   core::Error unless it is a number of at least 1
std::size_t read_task_count(const std::string& text, std::size_t otherwise);

/// A text as one word of a shell's command line.
std::string shell_word(const std::string& text);

}  // namespace apps
