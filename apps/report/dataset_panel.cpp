// SPDX-License-Identifier: MIT
#include "apps/report/dataset_panel.h"

#include "apps/dataset/dataset_index.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/settings/json_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

/// The outline of a histogram's bars.
nlos::Plot outline(const std::string& key, const DrawnHistogram& histogram) {
    nlos::Plot plot = nlos::area_plot(key, key, "number");
    const double width = std::max(histogram.high - histogram.low, 1e-12);
    const auto count = static_cast<double>(histogram.counts.size());
    for (std::size_t bin = 0; bin < histogram.counts.size(); ++bin) {
        for (const std::size_t edge : {bin, bin + 1}) {
            plot.lines.front().add(histogram.low + width * static_cast<double>(edge) / count,
                                   static_cast<double>(histogram.counts[bin]));
        }
    }
    return plot;
}

std::vector<Fact> dataset_facts(const DatasetIndex& index, const DatasetTotals& totals) {
    const auto items = static_cast<double>(std::max<std::uint64_t>(1, totals.items));
    std::vector<Fact> facts{
        {"Items", fmt::format("{} of {}", totals.items, index.items)},
        {"Shards", fmt::format("{}", index.shards.size())},
        {"Size", short_number(static_cast<double>(totals.bytes) / 1e6) + " MB"},
        {"Processor time of an item", short_number(totals.profile.total() / items) + " s"},
        {"Of that", fractions_text(totals.profile)}};
    if (totals.dark_items > 0) {
        facts.emplace_back("Items without light", fmt::format("{}", totals.dark_items));
    }
    if (totals.clipped_counts > 0) {
        facts.emplace_back("Clipped counts", fmt::format("{}", totals.clipped_counts));
    }
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
           file_name == "index.json" || file_name.starts_with("preview.");
}

DatasetPanel dataset_panel(const std::string& folder) {
    const DatasetIndex index = read_dataset(folder, ShardCheck::ManifestOnly);
    DatasetPanel result;
    result.panel.file = "data set";
    const DatasetTotals totals = totals_of(index);
    result.panel.facts = dataset_facts(index, totals);
    result.panel.settings = index.recipe;
    result.panel.notes = index.problems;
    result.panel.notes.insert(result.panel.notes.end(), index.doubts.begin(), index.doubts.end());
    for (const auto& [name, reason] : totals.broken_meshes) {
        result.panel.notes.push_back(name + " was skipped: " + reason);
    }
    std::error_code ignored;
    const std::string preview = preview_path(folder, ".png");
    if (fs::exists(preview, ignored)) result.panel.picture_png = read_bytes(preview);
    std::vector<nlos::Panel> panels;
    for (const auto& [key, histogram] : drawn_histograms(index)) {
        panels.emplace_back(outline(key, histogram));
    }
    if (!panels.empty()) result.histograms_png = nlos::encode_panels(panels, 3);
    return result;
}

}  // namespace apps
