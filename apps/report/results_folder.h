// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/bench_cards.h"
#include "apps/report/dataset_card.h"
#include "apps/report/result_cards.h"
#include "apps/report/sweep_cards.h"
#include "nlos/compare/compare.h"
#include "renderer/core/settings.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace apps {

/// A METRICS.json.
struct ScoredResult {
    std::string file;
    std::string name;       ///< to show: the file's, without suffix and a leading `metrics_`
    std::string result;     ///< name of the scored file; empty when unknown
    std::string reference;  ///< name of what it was scored against
    nlos::Metrics metrics;
    std::string picture_png;  ///< of the picture beside it; empty: none
};

/// Any other JSON file.
struct JsonDocument {
    std::string file;
    core::Json content;
};

/// What lies in a results folder, in the order of the files' names.
struct ResultsFolder {
    std::string name;
    std::optional<DatasetCard> dataset;  ///< when the folder holds one
    std::vector<ScoredResult> scores;
    std::vector<ResultCard> captures;
    std::vector<ResultCard> volumes;
    std::vector<ResultCard> fits;
    std::vector<ResultCard> tracks;
    std::vector<BenchCard> benches;
    std::vector<SweepCard> sweeps;
    core::Json hard_cases;        ///< the table that hard_cases_tests --report writes; null: none
    std::vector<Figure> figures;  ///< but for those that belong to a file shown
    std::vector<JsonDocument> documents;
    std::vector<Fact> unreadable;  ///< file and what is wrong with it

    bool empty() const {
        return !dataset && scores.empty() && captures.empty() && volumes.empty() && fits.empty() &&
               tracks.empty() && benches.empty() && sweeps.empty() && hard_cases.empty() &&
               figures.empty() && documents.empty() && unreadable.empty();
    }
};

/// Reads every capture, volume, fit, JSON file and picture of a folder (not of folders inside it).
///
/// returns   what was found; files that cannot be read are listed with their error
/// throws    core::Error when the folder does not exist or holds nothing of these
ResultsFolder read_results_folder(const std::string& folder);

}  // namespace apps
