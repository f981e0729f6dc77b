// SPDX-License-Identifier: MIT
#pragma once

#include "apps/sweep/sweep.h"
#include "apps/sweep/sweep_summary.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/parallel.h"
#include "tests/support/command_line.h"

#include <fmt/core.h>

#include <string>
#include <vector>

namespace test_support {

/// A small sweep of two scans, noise or none, and two methods, in a folder of its own.
class SweepFolder : public CommandLine {
 protected:
    static core::Json small_sweep() {
        return core::parse_json(R"({
            "scene": "scene.json",
            "fixed": {
                "scene.time_axis": {"opl_start_m": 1.2, "bin_width_m": 0.016, "num_bins": 64},
                "noise.ambient": 0.01,
                "reconstruct.volume.z_range_m": [0.6, 0.8]
            },
            "grid": {
                "scene.scan.sensing_points": [[8, 8], [6, 6]],
                "noise.photons_per_point": [20, null],
                "reconstruct.method": ["lct", "bp"]
            }
        })",
                                "small sweep");
    }

    // Writes the sweep and its scene; `changes` replace whole keys.
    std::string make_sweep(const core::Json& changes = core::Json::object()) const {
        make_scene("scene.json", core::Json::object());
        core::Json sweep = small_sweep();
        sweep.update(changes);
        write_file_bytes(file("sweep.json"), sweep.dump());
        return file("sweep.json");
    }

    apps::SweepPlan make_plan(const core::Json& changes = core::Json::object()) const {
        return {make_sweep(changes), {}};
    }

    // Does one share, into a folder below this one.
    apps::SweepProgress do_share(const apps::SweepPlan& plan,
                                 const std::string& folder,
                                 const apps::WorkShare& share = {},
                                 int threads = 0) const {
        const core::ThreadLimit limit(threads);
        return apps::do_share(plan, apps::SweepResults(plan, file(folder)), share, {});
    }

    std::string run_file(const std::string& folder, std::size_t run) const {
        return file(fmt::format("{}/runs/{:06}.json", folder, run));
    }

    // The results of all runs as they are written, but for what is measured.
    std::vector<std::string> results(const apps::SweepPlan& plan, const std::string& folder) const {
        std::vector<std::string> texts;
        for (std::size_t run = 0; run < plan.num_runs(); ++run) {
            texts.push_back(
                without_measurements(core::read_json_file(run_file(folder, run))).dump());
        }
        return texts;
    }

    static core::Json without_measurements(core::Json json) {
        for (const char* key : {"seconds_render", "seconds_noise", "seconds_reconstruct"}) {
            json.erase(key);
        }
        for (const char* key : {"seconds", "peak_rss_bytes"}) json["metrics"].erase(key);
        return json;
    }
};

}  // namespace test_support
