// SPDX-License-Identifier: MIT
#include "apps/bench/lower_bounds.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "apps/bench/scene.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/statistics.h"

#include <fmt/core.h>

#include <algorithm>

namespace apps {
namespace {

constexpr double kLongEnough_s = 10.0;  // of repeats

struct CostTarget {
    double max_ratio = 0.0;
    double max_bytes = 0.0;
    double min_gpairs_per_s = 0.0;
};

struct CostCase {
    std::string name;
    std::string scene;
    Overrides scene_overrides;
    Overrides overrides;
    bool counts_pairs = false;
    CostTarget target;
};

std::vector<CostCase> cost_cases(const std::string& folder) {
    const std::string letter = folder + "/letter/scene.json";
    const Overrides wide{"scan.sensing_points=[128,128]"};
    const Overrides single{"scan.pattern=single"};
    const Overrides exhaustive{"scan.pattern=exhaustive",
                               "scan.sensing_points=[16,16]",
                               "scan.illumination_points=[16,16]"};
    const std::string cube = "volume.voxels=[64,64,64]";
    const std::string size = "64x64x512";
    return {
        {"lct " + size, letter, {}, {"method=lct"}, false, {2.0, 0.4e9, 0.0}},
        {"lct 128x128x512", letter, wide, {"method=lct"}, false, {2.0, 1.6e9, 0.0}},
        {"solver " + size, letter, {}, {"method=solver"}, false, {}},
        {"dlct " + size, letter, {}, {"method=dlct"}, false, {}},
        {"fk " + size, letter, {}, {"method=fk"}, false, {0.0, 0.6e9, 0.0}},
        {"fk 128x128x512", letter, wide, {"method=fk"}, false, {}},
        {"bp confocal, 64^3 voxels",
         letter,
         {},
         {"method=bp", kSlices, cube},
         true,
         {0.0, 0.0, 5.0}},
        {"bp single laser, 64^3 voxels",
         letter,
         single,
         {"method=bp", kSlices, cube},
         true,
         {0.0, 0.0, 0.3}},
        {"bp exhaustive 16^4, 32^3 voxels",
         letter,
         exhaustive,
         {"method=bp", kSlices, "volume.voxels=[32,32,32]"},
         true,
         {0.0, 0.0, 0.3}},
        {"fbp confocal, 64^3 voxels", letter, {}, {"method=fbp", kSlices, cube}, true, {}},
        {"phasor single laser, 64 slices",
         letter,
         single,
         {"method=phasor", kSlices, cube},
         false,
         {}},
        {"phasor confocal, 64 slices", letter, {}, {"method=phasor", kSlices, cube}, false, {}},
    };
}

// Medians over the repeats of what one method costs on one capture.
core::Json measure_cost(const CostCase& job, int repeats) {
    const core::Capture capture = BenchScene(job.scene, job.scene_overrides).render();
    std::vector<double> all_cpu_seconds;
    std::vector<double> all_seconds;
    std::vector<double> limits;
    double spent = 0.0;
    double peak_bytes = 0.0;
    double estimated_bytes = 0.0;
    double gpairs = 0.0;
    for (int i = 0; i < repeats && spent < kLongEnough_s; ++i) {
        const ReconstructRun one = run_reconstruction(capture, job.overrides);
        all_cpu_seconds.push_back(one.cpu_seconds);
        all_seconds.push_back(one.result.seconds);
        spent += one.result.seconds;
        peak_bytes = std::max(peak_bytes, one.peak_bytes);
        estimated_bytes = one.result.estimated_bytes;
        limits.push_back(reconstruction_limit_seconds(capture, one.result));
        if (job.counts_pairs) {
            gpairs = 1e-9 * static_cast<double>(capture.scan.num_pairs()) *
                     static_cast<double>(one.result.volume.axes.num_voxels());
        }
    }
    const double cpu_seconds = core::median(all_cpu_seconds);
    const double limit_seconds = core::median(limits);
    const double ratio = limit_seconds > 0.0 ? cpu_seconds / limit_seconds : 0.0;
    const double gpairs_per_s = gpairs / cpu_seconds;
    core::Json row{{"name", job.name},
                   {"cpu_seconds", cpu_seconds},
                   {"seconds", core::median(all_seconds)},
                   {"limit_seconds", limit_seconds},  // of FFTs or multiply-adds; 0: not measured
                   {"ratio", ratio},
                   {"gpairs_per_s", gpairs_per_s},     // pairs times voxels; 0: not counted
                   {"peak_bytes", peak_bytes},         // resident, of the whole process
                   {"stated_bytes", estimated_bytes},  // what reconstruct() announced
                   {"target", ""},
                   {"met", ""}};
    const auto& [max_ratio, max_bytes, min_gpairs] = job.target;
    judge(max_ratio > 0.0, fmt::format("ratio <= {:g}", max_ratio), ratio <= max_ratio, row);
    judge(max_bytes > 0.0, fmt::format("< {:g} GB", 1e-9 * max_bytes), peak_bytes < max_bytes, row);
    judge(
        min_gpairs > 0.0, fmt::format(">= {:g} G/s", min_gpairs), gpairs_per_s >= min_gpairs, row);
    return row;
}

}  // namespace

core::Json measure_costs(const ReconstructBenchSettings& settings, const core::Progress& progress) {
    const std::vector<CostCase> cases = cost_cases(settings.scenes_folder);
    core::Json costs = core::Json::array();
    for (const CostCase& job : cases) {
        progress.update(fraction_of(costs.size(), cases.size()), job.name);
        costs.push_back(measure_cost(job, settings.repeats));
    }
    return costs;
}

}  // namespace apps
