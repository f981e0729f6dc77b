// SPDX-License-Identifier: MIT
#include "apps/bench/field/captures_table.h"

#include "apps/bench/field/peak_depths.h"
#include "apps/bench/field/reconstruction_table.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace apps {
namespace {

namespace fs = std::filesystem;

constexpr double kNearest_m = 0.15;  // what is nearer is the wall's own light
constexpr float kBrightColumn = 0.5F;

// Bins added up while they stay below half the wall points' distance, as our methods do, and left
// out before 0, which some methods refuse, and from `end_m` on.
core::Capture with_coarse_bins(const core::Capture& capture, double end_m) {
    const double half_m = 0.5 * point_distance_m(capture.scan.wall());
    const double width_m = capture.time_axis.bin_width_m;
    const auto factor =
        static_cast<std::size_t>(std::clamp(std::floor(half_m / width_m), 1.0, 64.0));
    core::Capture coarse;
    coarse.scan = capture.scan;
    coarse.unit = capture.unit;
    coarse.time_axis = capture.time_axis;
    const auto first =
        static_cast<std::size_t>(std::clamp(std::ceil(-capture.time_axis.opl_start_m / width_m),
                                            0.0,
                                            static_cast<double>(capture.time_axis.num_bins - 1)));
    coarse.time_axis.opl_start_m += static_cast<double>(first) * width_m;
    coarse.time_axis.bin_width_m *= static_cast<double>(factor);
    const double length_m = std::max(0.0, end_m - coarse.time_axis.opl_start_m);
    coarse.time_axis.num_bins =
        std::min((coarse.time_axis.num_bins - static_cast<int>(first)) / static_cast<int>(factor),
                 static_cast<int>(std::ceil(length_m / coarse.time_axis.bin_width_m)));
    const auto bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    const auto coarse_bins = static_cast<std::size_t>(coarse.time_axis.num_bins);
    coarse.transient = core::Transient(capture.transient.num_pairs(), coarse.time_axis.num_bins);
    const auto from = capture.transient.values();
    const auto to = coarse.transient.values();
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        for (std::size_t b = 0; b < coarse_bins * factor; ++b) {
            to[pair * coarse_bins + b / factor] += from[pair * bins + first + b];
        }
    }
    return coarse;
}

std::optional<double> bright_depth_m(const core::DepthMap& depth, const nlos::Volume& volume) {
    const std::vector<float> brightness = nlos::max_projection(volume);
    const float brightest = *std::max_element(brightness.begin(), brightness.end());
    std::vector<double> depths;
    for (std::size_t c = 0; c < brightness.size(); ++c) {
        if (depth.is_foreground(c) && brightness[c] > kBrightColumn * brightest) {
            depths.push_back(depth.depth_m[c]);
        }
    }
    if (depths.empty()) return std::nullopt;
    return core::median(std::move(depths));
}

}  // namespace

std::vector<KnownCapture> read_known_captures(const std::string& folder) {
    const std::string path = (fs::path(folder) / "captures.json").string();
    const core::Json json = core::read_json_file(path);
    const auto list = json.find("captures");
    if (list == json.end() || !list->is_array() || list->empty()) {
        throw core::Error(path, "lists no captures", "must have a list under \"captures\"");
    }
    std::vector<KnownCapture> captures;
    for (const core::Json& entry : *list) {
        KnownCapture& one = captures.emplace_back();
        const std::string where = fmt::format("{}: captures[{}]", path, captures.size() - 1);
        core::read_value(entry, where, one);
        core::require(one.depth_m > 0.0, where + ".depth_m", one.depth_m, "above 0");
        if (one.name.empty()) one.name = one.file;
        one.file = (fs::path(folder) / one.file).string();
    }
    return captures;
}

std::vector<CaptureRow> measure_captures(Baselines& baselines,
                                         const std::string& folder,
                                         const core::Progress& progress,
                                         std::map<std::string, BenchPicture>& pictures) {
    std::vector<CaptureRow> rows;
    const std::vector<KnownCapture> known = read_known_captures(folder);
    for (std::size_t c = 0; c < known.size(); ++c) {
        const KnownCapture& one = known[c];
        const double farthest_m = 2.0 * one.depth_m;
        const core::Capture capture =
            with_coarse_bins(nlos::read_capture(one.file, one.capture), 3.0 * farthest_m);
        const std::string pattern(capture.scan.name());
        const std::string name = fmt::format("capture_{}", c + 1);
        SharedCapture shared(
            baselines, name, name, capture, {kNearest_m, farthest_m, std::nullopt});
        std::vector<nlos::Panel> panels;
        for (const ReconstructionMethod& method : reconstruction_methods()) {
            progress.update(fraction_of(c, known.size()),
                            fmt::format("{}, {} {}", one.name, method.program, method.method));
            CaptureRow row{one.name, pattern, method.program, method.method, one.depth_m};
            const MethodVolume result = shared.run(method);
            if (enter_run(result.run, row)) {
                row.found_depth_m = bright_depth_m(peak_depths(result.volume), result.volume);
                if (row.found_depth_m) row.error_mm = 1e3 * (*row.found_depth_m - one.depth_m);
                panels.push_back(projection_panel(method, result.volume));
            }
            rows.push_back(std::move(row));
        }
        if (!panels.empty()) pictures["_" + name] = {std::move(panels), 4};
    }
    return rows;
}

}  // namespace apps
