// SPDX-License-Identifier: MIT
#include "apps/dataset/dataset_index.h"

#include "renderer/core/output_file.h"
#include "renderer/core/parallel.h"
#include "renderer/core/settings_json.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHistogramBins = 32;

/// The shard of some number, or what is wrong with it.
struct ShardState {
    std::optional<Manifest> manifest;
    std::optional<std::string> problem;
};

ShardState inspect(const DatasetIndex& index,
                   const std::string& folder,
                   std::uint64_t shard,
                   const ItemRange& wanted,
                   ShardCheck check) {
    ShardState state{read_manifest(manifest_path(folder, shard)), std::nullopt};
    const std::string name = shard_name(shard);
    if (!state.manifest) {
        state.problem = name + " is missing";
    } else if (state.manifest->fingerprint != index.fingerprint) {
        state.problem = name + " belongs to another recipe";
    } else if (!(state.manifest->items == wanted)) {
        const ItemRange& items = state.manifest->items;
        state.problem = fmt::format("{} holds the items {} to {} instead of {} to {}",
                                    name,
                                    items.begin,
                                    items.end - 1,
                                    wanted.begin,
                                    wanted.end - 1);
    } else {
        state.problem = check == ShardCheck::Contents ? find_damage(*state.manifest, folder)
                                                      : find_wrong_size(*state.manifest, folder);
    }
    return state;
}

void add_programs(DatasetIndex& index) {
    std::set<std::string> programs;
    for (const Manifest& shard : index.shards) programs.insert(shard.program);
    if (programs.size() < 2) return;
    index.doubts.push_back(
        fmt::format("shards of several versions are mixed: {} their items may differ in the last "
                    "bits",
                    fmt::join(programs, "; ")));
}

}  // namespace

DatasetIndex read_dataset(const std::string& folder, ShardCheck check) {
    const std::string path = (fs::path(folder) / "recipe.json").string();
    std::error_code ignored;
    if (!fs::exists(path, ignored)) {
        throw core::Error(folder, "holds no recipe.json", "must be a folder of nlos generate");
    }
    DatasetIndex index;
    const core::Json json = core::read_json_file(path);
    std::uint64_t per_shard = 0;
    try {
        index.recipe = json.at("recipe");
        json.at("fingerprint").get_to(index.fingerprint);
        core::read_value(index.recipe.at("items"), path + ": items", index.items);
        core::read_value(index.recipe.at("items_per_shard"), path, per_shard);
    } catch (const core::Json::exception&) {
        per_shard = 0;
    }
    constexpr std::uint64_t kMostShards = 1'000'000;  // as recipes allow
    if (per_shard == 0 || index.items == 0 || index.items / per_shard > kMostShards) {
        throw core::Error(path, "is no recipe of a data set", "must be what nlos generate wrote");
    }
    const std::uint64_t count = (index.items + per_shard - 1) / per_shard;
    std::vector<ShardState> states(count);
    core::parallel_for(count, [&](std::size_t shard) {
        const ItemRange wanted{shard * per_shard, std::min(index.items, (shard + 1) * per_shard)};
        states[shard] = inspect(index, folder, shard, wanted, check);
    });
    for (ShardState& state : states) {
        if (state.problem) index.problems.push_back(core::printable(*state.problem));
        if (state.manifest) index.shards.push_back(std::move(*state.manifest));
    }
    add_programs(index);
    return index;
}

DatasetTotals totals_of(const DatasetIndex& index) {
    DatasetTotals totals;
    for (const Manifest& shard : index.shards) {
        totals.items += shard.items.size();
        totals.bytes += shard.bytes;
        totals.add(shard);
    }
    return totals;
}

std::map<std::string, DrawnHistogram> drawn_histograms(const DatasetIndex& index) {
    std::map<std::string, std::vector<double>> drawn;
    for (const Manifest& shard : index.shards) {
        for (const auto& [key, values] : shard.drawn) {
            drawn[key].insert(drawn[key].end(), values.begin(), values.end());
        }
    }
    std::map<std::string, DrawnHistogram> histograms;
    for (const auto& [key, values] : drawn) {
        if (values.empty()) continue;
        const auto [low, high] = std::ranges::minmax(values);
        std::vector<std::size_t> counts(kHistogramBins);
        for (const double value : values) {
            const double place = high > low ? (value - low) / (high - low) : 0.0;
            const auto bin = static_cast<std::size_t>(place * kHistogramBins);
            ++counts[std::min(bin, kHistogramBins - 1)];
        }
        histograms[key] = {low, high, std::move(counts)};
    }
    return histograms;
}

std::string write_index(const DatasetIndex& index, const std::string& folder) {
    if (!index.problems.empty()) {
        throw core::Failure(
            folder,
            fmt::format("is not whole: {}{}",
                        index.problems.front(),
                        index.problems.size() > 1
                            ? fmt::format(", and {} more", index.problems.size() - 1)
                            : ""));
    }
    core::Json json = {{"fingerprint", index.fingerprint},
                       {"recipe", index.recipe},
                       {"program", index.shards.front().program},
                       {"items", index.items},
                       {"shards", core::Json::array()}};
    for (const Manifest& shard : index.shards) {
        json["shards"].push_back({{"file", shard.file},
                                  {"items", write_value(shard.items)},
                                  {"bytes", shard.bytes},
                                  {"xxh128", shard.checksum}});
    }
    const DatasetTotals totals = totals_of(index);
    json["broken_meshes"] = totals.broken_meshes;
    json["dark_items"] = totals.dark_items;
    json["clipped_counts"] = totals.clipped_counts;
    json["cpu_seconds"] = core::write_value(totals.profile);
    for (const auto& [key, histogram] : drawn_histograms(index)) {
        json["drawn"][key] = {
            {"low", histogram.low}, {"high", histogram.high}, {"counts", histogram.counts}};
    }
    std::string path = (fs::path(folder) / "index.json").string();
    core::write_text_file(path, core::json_text(json));
    return path;
}

}  // namespace apps
