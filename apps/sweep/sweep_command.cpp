// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/sweep/sweep.h"
#include "apps/sweep/sweep_summary.h"
#include "apps/terminal.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace apps {
namespace {

namespace fs = std::filesystem;

struct SweepArguments {
    std::string sweep;
    std::string folder;
    std::string shard;
    const CLI::Option* slurm_option = nullptr;
    std::vector<std::string> slurm;  ///< none or one
    std::vector<std::string> overrides;
    int threads = 0;
};

constexpr std::size_t kMostTasks = 1000;  // of an array, as Slurm has it unless told otherwise
constexpr std::size_t kMostPrinted = 60;

void print_script(const SweepArguments& arguments, const SweepPlan& plan) {
    const ArrayJob job{"sweep",
                       arguments.sweep,
                       arguments.folder,
                       arguments.overrides,
                       read_task_count(arguments.slurm.empty() ? "" : arguments.slurm.front(),
                                       std::min(kMostTasks, plan.pieces(1).size())),
                       std::max(1, arguments.threads)};
    write_output(slurm_script(job));
}

void print_summary(const SweepPlan& plan, const core::Json& rows, const SweepArguments& arguments) {
    const SweepSummary summary = write_summary(plan, rows, arguments.folder);
    if (rows.size() <= kMostPrinted) {
        write_message(plain_text({headline_table(plan.settings(), rows)}));
    }
    for (const std::string& text : summary.warnings) warn(text);
    const std::string path = (fs::path(arguments.folder) / "sweep.json").string();
    note_written({path, with_suffix(path, ".csv")});
    outcome()["runs"] = rows.size();
    outcome()["runs_failed"] = summary.num_failed;
    print("wrote {} and sweep.csv ({} runs{})\n",
          path,
          rows.size(),
          summary.num_failed > 0 ? fmt::format(", {} of them failed", summary.num_failed) : "");
    if (summary.num_failed == rows.size()) {
        throw core::Failure("sweep", fmt::format("all of its {} runs failed", rows.size()));
    }
}

void run(const SweepArguments& arguments) {
    const WorkShare share = read_work_share(arguments.shard);
    const core::ThreadLimit threads(arguments.threads);
    const SweepPlan plan(arguments.sweep, arguments.overrides);
    if (arguments.slurm_option->count() > 0) return print_script(arguments, plan);
    const SweepResults results(plan, arguments.folder);
    SweepProgress done;
    {
        ProgressBar bar("sweep");
        const StoppableWork stoppable(
            "stopping; what is done stays, and the same command goes on with the other runs; "
            "Ctrl-C again ends at once");
        done = do_share(plan, results, share, bar.progress());
    }
    outcome()["runs_done"] = results.num_done();
    outcome()["runs_in_all"] = plan.num_runs();
    if (done.interrupted) {
        throw core::Failure("sweep",
                            fmt::format("interrupted; {} of {} runs are done, and the same command "
                                        "goes on with the others",
                                        results.num_done(),
                                        plan.num_runs()));
    }
    if (const auto rows = results.rows()) return print_summary(plan, *rows, arguments);
    const std::string runs = note_written({(fs::path(arguments.folder) / "runs").string()});
    print("wrote {} runs to {}; {} of {} are done, other shards do the rest\n",
          done.num_new,
          runs,
          results.num_done(),
          plan.num_runs());
}

void declare_sweep(Command& command) {
    auto& arguments = command.runs<SweepArguments>(run);
    command.settings = core::settings_help(SweepSettings{});
    add_file_option(command, "SWEEP", arguments.sweep, "Scene and grid of settings (.json)")
        ->required();
    add_output_folder_option(command,
                             arguments.folder,
                             "Folder of results; what it holds of this sweep is not done again")
        ->required();
    command.add_option("--shard",
                       arguments.shard,
                       "I/N: do part I, from 0, of N (default: that of the Slurm array task, or "
                       "all)");
    arguments.slurm_option =
        command
            .add_option("--slurm",
                        arguments.slurm,
                        "Only print a script for sbatch, an array of TASKS (default: one per "
                        "capture)")
            ->type_name("TASKS")
            ->expected(0, 1);
    add_threads_option(command, arguments.threads);
    add_set_option(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kSweepCommand{"sweep",
                                      "Render, reconstruct and compare over a grid of settings",
                                      "nlos sweep data/sweep.json -o out/sweep",
                                      declare_sweep};

}  // namespace apps
