// SPDX-License-Identifier: MIT
#include "apps/report/dataset_card.h"

#include "apps/dataset/dataset_index.h"
#include "nlos/pictures/picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace apps {
namespace {

namespace fs = std::filesystem;

/// The outline of a histogram's bars.
nlos::CurvePanel outline(const std::string& key, const DrawnHistogram& histogram) {
    nlos::CurvePanel panel;
    panel.title = key;
    panel.x_label = key;
    panel.y_label = "number";
    const double width = std::max(histogram.high - histogram.low, 1e-12);
    const auto count = static_cast<double>(histogram.counts.size());
    for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
        for (const std::size_t edge : {bin, bin + 1}) {
            panel.x.push_back(histogram.low + width * static_cast<double>(edge) / count);
            panel.y.push_back(static_cast<double>(histogram.counts[bin]));
        }
    }
    return panel;
}

std::string steps_text(const ItemProfile& profile, double total) {
    std::string text;
    for (const auto& [step, name] : core::EnumNames<ItemStep>::value) {
        const double share = total > 0.0 ? profile[static_cast<std::size_t>(step)] / total : 0.0;
        text += fmt::format("{}{} {:.1f} %", text.empty() ? "" : ", ", name, 100.0 * share);
    }
    return text;
}

std::vector<Fact> dataset_facts(const DatasetIndex& index) {
    std::uint64_t items = 0;
    double bytes = 0.0;
    std::size_t dark = 0;
    std::size_t clipped = 0;
    for (const Manifest& shard : index.shards) {
        items += shard.items.size();
        bytes += static_cast<double>(shard.bytes);
        dark += shard.dark_items;
        clipped += shard.clipped_counts;
    }
    const ItemProfile profile = total_profile(index);
    const double seconds = std::accumulate(profile.begin(), profile.end(), 0.0);
    std::vector<Fact> facts{
        {"Items", fmt::format("{} of {}", items, index.items)},
        {"Shards", fmt::format("{}", index.shards.size())},
        {"Size", short_number(bytes / 1e6) + " MB"},
        {"Processor time of an item",
         short_number(seconds / static_cast<double>(std::max<std::uint64_t>(1, items))) + " s"},
        {"Of that", steps_text(profile, seconds)}};
    if (dark > 0) facts.emplace_back("Items without light", fmt::format("{}", dark));
    if (clipped > 0) facts.emplace_back("Clipped counts", fmt::format("{}", clipped));
    return facts;
}

}  // namespace

bool is_dataset(const std::string& folder) {
    std::error_code ignored;
    const fs::path recipe = fs::path(folder) / "recipe.json";
    if (!fs::is_regular_file(recipe, ignored)) return false;
    const auto json = core::json_if_valid(read_bytes(recipe.string()));
    return json && json->is_object() && json->contains("fingerprint") && json->contains("recipe");
}

bool belongs_to_dataset(const std::string& file_name) {
    return file_name.starts_with("shard-") || file_name == "recipe.json" ||
           file_name == "index.json" || file_name == "preview.png";
}

DatasetCard dataset_card(const std::string& folder) {
    const DatasetIndex index = read_dataset(folder, ShardCheck::ManifestOnly);
    DatasetCard result;
    result.card.file = "data set";
    result.card.facts = dataset_facts(index);
    result.card.settings = index.recipe;
    result.card.notes = index.problems;
    result.card.notes.insert(result.card.notes.end(), index.doubts.begin(), index.doubts.end());
    std::map<std::string, std::string> broken;
    for (const Manifest& shard : index.shards) {
        broken.insert(shard.broken_meshes.begin(), shard.broken_meshes.end());
    }
    for (const auto& [name, reason] : broken) {
        result.card.notes.push_back(name + " was skipped: " + reason);
    }
    std::error_code ignored;
    if (fs::exists(preview_path(folder), ignored)) {
        result.card.picture_png = read_bytes(preview_path(folder));
    }
    std::vector<nlos::Panel> panels;
    for (const auto& [key, histogram] : drawn_histograms(index)) {
        panels.emplace_back(outline(key, histogram));
    }
    if (!panels.empty()) result.histograms_png = nlos::encode_panels_png(panels, 3);
    return result;
}

}  // namespace apps
