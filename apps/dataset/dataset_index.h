// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/manifest.h"
#include "renderer/core/settings/json_file.h"

#include <string>
#include <variant>
#include <vector>

namespace apps {

/// All shards of a data set, as their manifests describe them.
struct DatasetIndex {
    core::Json recipe;
    std::string fingerprint;
    std::uint64_t items = 0;   ///< that the recipe asks for
    std::uint64_t wanted = 0;  ///< of which so many were looked for
    std::vector<Manifest> shards;
    std::vector<std::string> problems;  ///< what is missing or damaged; one printable line each
    std::vector<std::string> doubts;    ///< what else a user should know
};

/// Which items are looked for: all of the recipe, those that runs were asked for (all where no
/// shard is there), or some.
struct AllItems {};
struct AskedItems {};
using WantedItems = std::variant<AllItems, AskedItems, ItemRange>;

/// Reads what a data set's folder holds.
///
/// check    also reads every shard and compares its checksum
/// wanted   shards of other items may be missing
/// throws   core::Error when the folder holds no data set, or less than the wanted range
enum class ShardCheck { ManifestOnly, Contents };
DatasetIndex read_dataset(const std::string& folder,
                          ShardCheck check,
                          const WantedItems& wanted = AllItems());

/// Writes index.json: the recipe, every shard with its items, bytes and checksum, where the time
/// went, meshes that were skipped, and histograms of what was drawn.
///
/// throws   core::Failure when the index has problems
/// returns  the path
std::string write_index(const DatasetIndex& index, const std::string& folder);

/// What all shards together say.
struct DatasetTotals : ItemTotals {
    std::uint64_t items = 0;
    std::uint64_t bytes = 0;
};
DatasetTotals totals_of(const DatasetIndex& index);

/// A histogram of numbers between the least and the greatest.
struct DrawnHistogram {
    double low = 0.0;
    double high = 0.0;
    std::vector<std::size_t> counts;
};
std::map<std::string, DrawnHistogram> drawn_histograms(const DatasetIndex& index);

}  // namespace apps
