// SPDX-License-Identifier: MIT
#include "apps/batch/work_share.h"

#include "renderer/core/error.h"
#include "renderer/core/settings/settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>

namespace apps {
namespace {

std::optional<std::size_t> whole_number(std::string_view text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::optional<std::size_t> environment_number(const char* name) {
    const char* text = std::getenv(name);
    return text == nullptr ? std::nullopt : whole_number(text);
}

WorkShare share_of_array_task() {
    const auto task = environment_number("SLURM_ARRAY_TASK_ID");
    if (!task) return {};
    const auto first = environment_number("SLURM_ARRAY_TASK_MIN");
    const auto last = environment_number("SLURM_ARRAY_TASK_MAX");
    if (!first || !last || *first > *task || *task > *last) {
        throw core::Error("SLURM_ARRAY_TASK_ID",
                          fmt::format("found task {} of an array without a range", *task),
                          "must lie from SLURM_ARRAY_TASK_MIN to SLURM_ARRAY_TASK_MAX");
    }
    const std::size_t step =
        std::max<std::size_t>(1, environment_number("SLURM_ARRAY_TASK_STEP").value_or(1));
    return {(*task - *first) / step, (*last - *first) / step + 1};
}

}  // namespace

WorkShare read_work_share(const std::string& text) {
    if (text.empty()) return share_of_array_task();
    const std::size_t slash = text.find('/');
    const auto index = whole_number(std::string_view(text).substr(0, slash));
    const auto count = slash == std::string::npos
                           ? std::nullopt
                           : whole_number(std::string_view(text).substr(slash + 1));
    if (!index || !count || *index >= *count) {
        throw core::Error(
            "--shard", "found " + text, "must be I/N, the part I of N, with I from 0 to N - 1");
    }
    return {*index, *count};
}

std::string slurm_script(const ArrayJob& job) {
    const auto absolute = [](const std::string& path) {
        return std::filesystem::absolute(path).lexically_normal().string();
    };
    std::string command = shell_word(std::filesystem::read_symlink("/proc/self/exe").string());
    for (const std::string& word :
         {job.command, absolute(job.file), std::string("-o"), absolute(job.folder)}) {
        command += " " + shell_word(word);
    }
    for (const std::string& text : job.settings) command += " --set " + shell_word(text);
    return fmt::format(
        "#!/bin/bash\n"
        "#SBATCH --job-name=nlos-{0}\n"
        "#SBATCH --array=0-{1}\n"
        "#SBATCH --ntasks=1 --cpus-per-task={2}\n"
        "#SBATCH --requeue --open-mode=append\n"
        "#SBATCH --signal=TERM@60\n"
        "#SBATCH --output=nlos-{0}-%A_%a.log\n"
        "# Each task does its part of the work. What is finished is kept: submitting the script "
        "once\n"
        "# more, or single tasks of it by --array=3,7, does what is left.\n"
        "exec srun --cpus-per-task={2} {3} --threads {2} --shard \"$SLURM_ARRAY_TASK_ID/{4}\"\n",
        job.command,
        job.num_tasks - 1,
        job.cpus_per_task,
        command,
        job.num_tasks);
}

std::size_t read_task_count(const std::string& text, std::size_t otherwise) {
    if (text.empty()) return otherwise;
    const auto number = whole_number(text);
    core::require(number && *number > 0, "--slurm", text, "a number of tasks, at least 1");
    return *number;
}

std::string shell_word(const std::string& text) {
    constexpr const char* kPlain =
        "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ/._-+=:,@%";
    const bool is_plain = !text.empty() && text.find_first_not_of(kPlain) == std::string::npos;
    if (is_plain) return text;
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

}  // namespace apps
