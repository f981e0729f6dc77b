// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/page_views.h"
#include "apps/report/bench_panels.h"
#include "apps/report/dataset_panel.h"
#include "apps/report/result_panels.h"
#include "apps/report/sweep_panels.h"
#include "nlos/compare/compare.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/json_file.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A METRICS.json.
struct ScoredResult {
    std::string file;
    std::string name;              ///< to show: the file's, without suffix and a leading `metrics_`
    std::string result;            ///< name of the scored file; empty when unknown
    std::string reference;         ///< name of what it was scored against
    std::string reference_path{};  ///< as the file says it
    nlos::Metrics metrics;
    std::string picture_png;  ///< of the picture beside it; empty: none
};

/// Any other JSON file.
struct JsonDocument {
    std::string file;
    core::Json content;
};

/// A file that should be a result and is none.
struct UnreadableFile {
    std::string file;
    std::string error;
};

/// What lies in a results folder, in the order of the files' names.
struct ResultsFolder {
    std::string name;
    std::optional<DatasetPanel> dataset;  ///< when the folder holds one
    std::vector<ScoredResult> scores;
    std::vector<ResultPanel> captures;
    std::vector<ResultPanel> volumes;
    std::vector<ResultPanel> fits;
    std::vector<ResultPanel> tracks;
    std::vector<BenchPanel> benches;
    std::vector<SweepPanel> sweeps;
    core::Json hard_cases;        ///< the table that hard_cases_tests --report writes; null: none
    std::vector<Figure> figures;  ///< but for those that belong to a file shown
    std::vector<JsonDocument> documents;
    std::vector<UnreadableFile> unreadable;
    PageViews views;  ///< an animation per capture and a result per volume, in their order

    bool empty() const {
        return !dataset && scores.empty() && captures.empty() && volumes.empty() && fits.empty() &&
               tracks.empty() && benches.empty() && sweeps.empty() && hard_cases.empty() &&
               figures.empty() && documents.empty() && unreadable.empty();
    }
};

/// Names volumes, and what is scored of them, by their method; several of one method also by the
/// settings in which they differ, or, where they differ in none, by their files.
void label_by_method(ResultsFolder& results);

/// Reads every capture, volume, fit, JSON file and picture of a folder (not of folders inside it).
///
/// scene     scene.json with the truth; empty: the first that metrics or captures name and that is
///           still there
/// returns   what was found; files that cannot be read are listed with their error
/// throws    core::Error when the folder does not exist or holds nothing of these, and as reading
///           `scene` does
ResultsFolder read_results_folder(const std::string& folder, const std::string& scene = "");

/// The same of files, of which a scene.json is the truth.
///
/// settings   of captures
ResultsFolder read_result_files(const std::vector<std::string>& paths,
                                const nlos::CaptureReadSettings& settings = {});

}  // namespace apps
