// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/baselines.h"
#include "apps/bench/output.h"
#include "nlos/layouts/capture_settings.h"
#include "renderer/core/progress.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// A capture of the user's whose main surface stands at a known distance.
struct KnownCapture {
    std::string name{};
    std::string file{};
    double depth_m = 0.0;
    nlos::CaptureReadSettings capture;
};

template <class Visitor>
void for_each_field(KnownCapture& known, Visitor&& visit) {
    visit("name", known.name, "what the table calls it");
    visit("file", known.file, "the capture, seen from captures.json");
    visit(
        "depth_m", known.depth_m, core::above(0, "distance of the main surface from the wall [m]"));
    visit("capture", known.capture, "what the capture file leaves open");
}

/// Reads `captures.json` of a folder: a list of them under "captures".
/// throws    core::Error when there is none, or a file or depth is missing
std::vector<KnownCapture> read_known_captures(const std::string& folder);

/// One method on one of the user's captures.
struct CaptureRow {
    std::string capture{};
    std::string pattern{};
    std::string program{};
    std::string method{};
    std::optional<double> known_depth_m{};
    std::optional<double> found_depth_m{};  ///< median over columns above half the brightest voxel
    std::optional<double> error_mm{};       ///< found less known
    std::optional<double> cpu_s{};          ///< of the calculation
    std::optional<double> process_cpu_s{};  ///< of the whole process
    std::optional<double> peak_mb{};        ///< memory of the whole process
    std::string reason{};                   ///< why there is no result
};
NLOS_FIGURES(CaptureRow,
             capture,
             pattern,
             program,
             method,
             known_depth_m,
             found_depth_m,
             error_mm,
             cpu_s,
             process_cpu_s,
             peak_mb,
             reason);

/// Reconstructs the captures of a folder by every method, from nearly at the wall to twice the
/// known distance. Bins are added up to half the wall points' distance first.
///
/// pictures   gets maximum projections side by side, by the end of their files' names
std::vector<CaptureRow> measure_captures(Baselines& baselines,
                                         const std::string& folder,
                                         const core::Progress& progress,
                                         std::map<std::string, BenchPicture>& pictures);

}  // namespace apps
