// SPDX-License-Identifier: MIT
#include "apps/arguments.h"
#include "apps/batch/work_share.h"
#include "apps/dataset/dataset_index.h"
#include "apps/dataset/generate.h"
#include "apps/outcome.h"
#include "apps/progress_bar.h"
#include "apps/terminal.h"
#include "apps/version.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace apps {
namespace {

struct GenerateArguments {
    std::string recipe;
    std::string folder;
    std::string shard;
    std::string items;
    std::string verify;
    std::string merge;
    std::vector<std::string> overrides;
    const CLI::Option* slurm_option = nullptr;
    std::vector<std::string> slurm;  ///< none or one
    int threads = 0;
};

constexpr std::array<Shorthand, 1> kGenerateShorthands{
    {{"--format", "format", "NAME", "How shards are stored"}}};

ItemRange read_range(const std::string& text) {
    ItemRange range;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, range.begin);
    bool is_range = first.ec == std::errc{} && first.ptr != end && *first.ptr == ':';
    if (is_range) {
        const auto second = std::from_chars(first.ptr + 1, end, range.end);
        is_range = second.ec == std::errc{} && second.ptr == end && range.begin < range.end;
    }
    if (is_range) return range;
    throw core::Error("--items", "found " + text, "must be A:B, the items from A to B - 1");
}

void warn_of_oddities(const GenerateResult& result) {
    for (const auto& [name, reason] : result.broken_meshes) {
        warn(fmt::format("{} was skipped: {}", name, reason));
    }
    if (result.dark_items > 0) {
        warn(fmt::format("{} items hold no light of their scene", result.dark_items));
    }
    if (result.clipped_counts > 0) {
        warn(fmt::format("{} counts were clipped to what storage.histograms can hold",
                         result.clipped_counts));
    }
}

void print_script(const GenerateArguments& arguments, const Dataset& dataset) {
    constexpr std::uint64_t kMostTasks = 100;
    const ArrayJob job{"generate",
                       arguments.recipe,
                       arguments.folder,
                       arguments.overrides,
                       read_task_count(arguments.slurm.empty() ? "" : arguments.slurm.front(),
                                       std::min(kMostTasks, dataset.num_shards())),
                       std::max(1, arguments.threads)};
    write_output(slurm_script(job));
}

void make(const GenerateArguments& arguments) {
    const core::ThreadLimit threads(arguments.threads);
    Dataset dataset(read_recipe(arguments.recipe, arguments.overrides), arguments.folder);
    if (arguments.slurm_option->count() > 0) {
        core::require(arguments.items.empty() && arguments.shard.empty(),
                      "--slurm",
                      "found beside --items or --shard",
                      "alone: tasks get their shares by --shard");
        return print_script(arguments, dataset);
    }
    std::optional<ItemRange> items;
    if (!arguments.items.empty()) items = read_range(arguments.items);
    ProgressBar bar("generate");
    const StoppableWork stoppable(
        "stopping; whole shards stay, and the same command goes on with the others; Ctrl-C again "
        "ends at once");
    const GenerateResult result =
        generate(dataset, read_work_share(arguments.shard), items, version_text(), bar.progress());
    warn_of_oddities(result);
    outcome()["shards"] = result.shards_written;
    outcome()["items"] = result.items_written;
    outcome()["shards_there"] = result.shards_there;
    outcome()["interrupted"] = result.interrupted;
    if (result.interrupted) {
        throw core::Failure("generate",
                            fmt::format("interrupted after {} shards; the same command goes on",
                                        result.shards_written));
    }
    note_written({arguments.folder});
    const auto made = static_cast<double>(std::max<std::uint64_t>(1, result.items_written));
    print(
        "wrote {} ({} shards, {} items, {} shards were there; {:.2f} s, {:.3f} CPU s an item: "
        "{})\n",
        arguments.folder,
        result.shards_written,
        result.items_written,
        result.shards_there,
        result.seconds,
        result.profile.total() / made,
        fractions_text(result.profile));
}

/// Whether the items that runs were asked for, or those of --items, are there and undamaged.
void verify(const std::string& folder, const std::string& items) {
    const ProgressBar bar("generate --verify");
    const WantedItems wanted =
        items.empty() ? WantedItems(AskedItems()) : WantedItems(read_range(items));
    const DatasetIndex index = read_dataset(folder, ShardCheck::Contents, wanted);
    for (const std::string& doubt : index.doubts) warn(doubt);
    outcome()["items"] = index.wanted;
    outcome()["items_in_all"] = index.items;
    outcome()["shards"] = index.shards.size();
    outcome()["problems"] = index.problems;
    for (const std::string& problem : index.problems) print("{}\n", problem);
    if (!index.problems.empty()) {
        throw core::Failure(folder, fmt::format("has {} problems", index.problems.size()));
    }
    print("{} is whole: {} items in {} shards{}\n",
          folder,
          index.wanted,
          index.shards.size(),
          index.wanted < index.items
              ? fmt::format("; the other {} were {}",
                            index.items - index.wanted,
                            items.empty() ? "not asked for so far" : "not looked at")
              : "");
}

void merge(const std::string& folder) {
    const ProgressBar bar("generate --merge");
    const DatasetIndex index = read_dataset(folder, ShardCheck::ManifestOnly);
    const std::string path = write_index(index, folder);
    note_written({path});
    outcome()["items"] = index.items;
    outcome()["shards"] = index.shards.size();
    print("wrote {} ({} items in {} shards)\n", path, index.items, index.shards.size());
}

void run(const GenerateArguments& arguments) {
    if (!arguments.verify.empty()) return verify(arguments.verify, arguments.items);
    if (!arguments.merge.empty()) return merge(arguments.merge);
    if (arguments.recipe.empty() || arguments.folder.empty()) {
        throw core::Error("nlos generate",
                          "found no RECIPE or no -o",
                          "must have both, or --verify DIR or --merge DIR");
    }
    make(arguments);
}

void declare_generate(Command& command) {
    auto& arguments = command.runs<GenerateArguments>(run);
    command.settings = core::settings_help(Recipe{});
    add_file_option(command, "RECIPE", arguments.recipe, "What is drawn and stored (.json)");
    add_output_folder_option(command, arguments.folder, "Folder of the data set");
    command.add_option("--shard",
                       arguments.shard,
                       "I/N: make the part I of N, from 0 to N - 1; without it, the part of the "
                       "present task of a Slurm array, or everything");
    command.add_option(
        "--items",
        arguments.items,
        "A:B: make, or verify, only the items from A to B - 1; not made by two processes at once "
        "within a shard");
    add_shorthands(command, kGenerateShorthands, arguments.overrides);
    add_folder_option(
        command,
        "--verify",
        arguments.verify,
        "Check the shards of this folder: of all items that were asked for, or of --items");
    add_folder_option(command, "--merge", arguments.merge, "Write index.json of this folder");
    arguments.slurm_option =
        command
            .add_option("--slurm",
                        arguments.slurm,
                        "Only print a script for sbatch, an array of TASKS (default: one per "
                        "shard, at most 100) with --threads processors each")
            ->type_name("TASKS")
            ->expected(0, 1);
    add_threads_option(command, arguments.threads);
    add_set_option(command, arguments.overrides);
}

}  // namespace

extern const CommandRow kGenerateCommand{"generate",
                                         "Make a data set of captures of random scenes",
                                         "nlos generate data/recipes/shapes.json -o shapes",
                                         declare_generate};

}  // namespace apps
