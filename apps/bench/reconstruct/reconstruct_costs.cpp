// SPDX-License-Identifier: MIT
#include "apps/bench/lower_bounds.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_run.h"
#include "apps/bench/scene.h"
#include "nlos/compare/compare_scores.h"

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

void judge(const CostTarget& target, ReconstructCost& cost) {
    judge(cost,
          target.max_ratio > 0.0,
          fmt::format("ratio <= {:g}", target.max_ratio),
          cost.ratio <= target.max_ratio);
    judge(cost,
          target.max_bytes > 0.0,
          fmt::format("< {:g} GB", 1e-9 * target.max_bytes),
          cost.peak_bytes < target.max_bytes);
    judge(cost,
          target.min_gpairs_per_s > 0.0,
          fmt::format(">= {:g} G/s", target.min_gpairs_per_s),
          cost.gpairs_per_s >= target.min_gpairs_per_s);
}

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

ReconstructCost measure_cost(const CostCase& job, int repeats) {
    const BenchScene scene(job.scene, job.scene_overrides);
    const core::Capture capture = scene.render(scene.settings());
    ReconstructCost cost;
    cost.name = job.name;
    std::vector<double> cpu_seconds;
    std::vector<double> seconds;
    std::vector<double> limits;
    double spent = 0.0;
    for (int i = 0; i < repeats && spent < kLongEnough_s; ++i) {
        const ReconstructRun one = run_reconstruction(capture, job.overrides);
        cpu_seconds.push_back(one.cpu_seconds);
        seconds.push_back(one.result.seconds);
        spent += one.result.seconds;
        cost.peak_bytes = std::max(cost.peak_bytes, one.peak_bytes);
        cost.stated_bytes = one.result.stated_bytes;
        limits.push_back(reconstruction_limit_seconds(capture, one.result));
        if (job.counts_pairs) {
            cost.gpairs_per_s = 1e-9 * static_cast<double>(capture.scan.num_pairs()) *
                                static_cast<double>(one.result.volume.axes.num_voxels());
        }
    }
    cost.cpu_seconds = nlos::median(cpu_seconds);
    cost.seconds = nlos::median(seconds);
    cost.limit_seconds = nlos::median(limits);
    if (cost.limit_seconds > 0.0) cost.ratio = cost.cpu_seconds / cost.limit_seconds;
    cost.gpairs_per_s /= cost.cpu_seconds;
    judge(job.target, cost);
    return cost;
}

}  // namespace

std::vector<ReconstructCost> measure_costs(const ReconstructBenchSettings& settings,
                                           const core::Progress& progress) {
    const std::vector<CostCase> cases = cost_cases(settings.scenes_folder);
    std::vector<ReconstructCost> costs;
    for (const CostCase& job : cases) {
        if (progress.should_stop()) throw core::Failure("bench", "interrupted");
        progress.update(static_cast<double>(costs.size()) / static_cast<double>(cases.size()),
                        job.name);
        costs.push_back(measure_cost(job, settings.repeats));
    }
    return costs;
}

}  // namespace apps
