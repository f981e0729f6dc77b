// SPDX-License-Identifier: MIT
#include "apps/dataset/dataset_index.h"

#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/core/system/parallel.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <set>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kHistogramBins = 32;

/// Looks at the manifest of a shard, which must hold the items wanted of it.
std::optional<std::string> find_problem(const DatasetIndex& index,
                                        const std::string& folder,
                                        const std::string& name,
                                        const std::optional<Manifest>& manifest,
                                        const ItemRange& wanted,
                                        ShardCheck check) {
    if (!manifest) return name + " is missing";
    if (manifest->fingerprint != index.fingerprint) return name + " belongs to another recipe";
    const ItemRange& items = manifest->items;
    if (!items.contains(wanted)) {
        return fmt::format("{} holds the items {} to {} instead of {} to {}",
                           name,
                           items.begin,
                           items.end - 1,
                           wanted.begin,
                           wanted.end - 1);
    }
    return check == ShardCheck::Contents ? find_damage(*manifest, folder)
                                         : find_wrong_size(*manifest, folder);
}

/// The ranges that make up the wanted items.
std::vector<ItemRange> wanted_ranges(const WantedItems& wanted,
                                     const ItemRange& all,
                                     const std::vector<std::optional<Manifest>>& manifests) {
    if (const auto* range = std::get_if<ItemRange>(&wanted)) return {*range};
    std::vector<ItemRange> asked;
    if (std::holds_alternative<AskedItems>(wanted)) {
        for (const auto& manifest : manifests) {
            if (manifest) asked.push_back(manifest->asked.value_or(all));
        }
    }
    return asked.empty() ? std::vector{all} : asked;
}

/// What of a shard is wanted: from the first item of any range to the last; nothing when none is.
std::optional<ItemRange> wanted_of(const ItemRange& shard, const std::vector<ItemRange>& ranges) {
    std::optional<ItemRange> wanted;
    for (const ItemRange& range : ranges) {
        const ItemRange part{std::max(range.begin, shard.begin), std::min(range.end, shard.end)};
        if (part.begin >= part.end) continue;
        if (!wanted) wanted = part;
        wanted = {std::min(wanted->begin, part.begin), std::max(wanted->end, part.end)};
    }
    return wanted;
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

DatasetIndex read_dataset(const std::string& folder, ShardCheck check, const WantedItems& wanted) {
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
    const ItemRange all{0, index.items};
    const auto* range = std::get_if<ItemRange>(&wanted);
    if (range != nullptr && !all.contains(*range)) {
        throw core::Error("items",
                          fmt::format("found {} to {}", range->begin, range->end),
                          fmt::format("must lie within 0 to {}", all.end));
    }
    const std::uint64_t count = (index.items + per_shard - 1) / per_shard;
    std::vector<std::optional<Manifest>> manifests(count);
    core::parallel_for(count, [&](std::size_t shard) {
        manifests[shard] = read_manifest(manifest_path(folder, shard));
    });
    const std::vector<ItemRange> ranges = wanted_ranges(wanted, all, manifests);
    std::vector<std::optional<ItemRange>> parts(count);
    std::vector<std::optional<std::string>> problems(count);
    core::parallel_for(count, [&](std::size_t shard) {
        const ItemRange items{shard * per_shard, std::min(index.items, (shard + 1) * per_shard)};
        parts[shard] = wanted_of(items, ranges);
        if (!parts[shard]) return;
        problems[shard] =
            find_problem(index, folder, shard_name(shard), manifests[shard], *parts[shard], check);
    });
    for (std::uint64_t shard = 0; shard < count; ++shard) {
        if (!parts[shard]) continue;
        index.wanted += parts[shard]->size();
        if (problems[shard]) index.problems.push_back(core::printable(*problems[shard]));
        if (manifests[shard]) index.shards.push_back(std::move(*manifests[shard]));
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
            const double position = high > low ? (value - low) / (high - low) : 0.0;
            const auto bin = static_cast<std::size_t>(position * kHistogramBins);
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
