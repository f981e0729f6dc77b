// SPDX-License-Identifier: MIT
#include "apps/report/result_labels.h"

#include <algorithm>
#include <filesystem>
#include <map>

namespace apps {
namespace {

constexpr std::size_t kMostSettings = 2;  // in a label

/// The settings of a result by their paths: `volume.voxels.0`.
std::map<std::string, std::string> settings_of(const ResultCard& card) {
    std::map<std::string, std::string> settings;
    if (!card.settings.is_structured()) return settings;
    const core::Json flat = card.settings.flatten();
    for (const auto& [pointer, value] : flat.items()) {
        std::string path = pointer.substr(1);
        std::replace(path.begin(), path.end(), '/', '.');
        settings[path] = value.is_string() ? value.get<std::string>() : value.dump();
    }
    return settings;
}

/// The settings that differ between some of the cards.
std::vector<std::string> differing(const std::vector<ResultCard*>& cards) {
    std::map<std::string, std::map<std::string, std::size_t>> values;
    for (const ResultCard* card : cards) {
        for (const auto& [path, value] : settings_of(*card)) ++values[path][value];
    }
    std::vector<std::string> paths;
    for (const auto& [path, counts] : values) {
        const bool same = counts.size() == 1 && counts.begin()->second == cards.size();
        if (!same && paths.size() < kMostSettings) paths.push_back(path);
    }
    return paths;
}

void tell_apart(const std::vector<ResultCard*>& cards) {
    const std::vector<std::string> paths = differing(cards);
    std::map<std::string, std::size_t> count;
    for (ResultCard* card : cards) {
        const std::map<std::string, std::string> settings = settings_of(*card);
        for (const std::string& path : paths) {
            const auto found = settings.find(path);
            if (found != settings.end()) card->label += ", " + path + " " + found->second;
        }
        ++count[card->label];
    }
    for (ResultCard* card : cards) {
        if (count[card->label] == 1) continue;
        card->label += ", " + std::filesystem::path(card->file).stem().string();
    }
}

}  // namespace

void label_by_method(ResultsFolder& results) {
    std::map<std::string, std::vector<ResultCard*>> of_method;
    for (std::size_t i = 0; i < results.volumes.size(); ++i) {
        ResultCard& card = results.volumes[i];
        card.label = results.views.results[i].name;
        if (!card.label.empty()) of_method[card.label].push_back(&card);
    }
    for (const auto& [method, cards] : of_method) {
        if (cards.size() > 1) tell_apart(cards);
    }
    for (std::size_t i = 0; i < results.volumes.size(); ++i) {
        const ResultCard& card = results.volumes[i];
        results.views.results[i].name = card.label.empty() ? card.file : card.label;
        for (ScoredResult& scored : results.scores) {
            if (scored.result == card.file && !card.label.empty()) scored.name = card.label;
        }
    }
}

}  // namespace apps
