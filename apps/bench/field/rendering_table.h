// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/baselines.h"
#include "apps/bench/output.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/json_fwd.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// One run of a renderer.
struct RenderingRow {
    std::string scene{};
    int max_bounces = 0;
    std::string program{};
    std::string method{};
    std::optional<int> samples{};           ///< paths per wall point or pixel
    std::optional<double> target_error{};   ///< relative L2 that was asked for instead
    std::optional<double> rel_l2{};         ///< error over all of H
    std::optional<double> energy_ratio{};   ///< all light over that of the reference
    std::optional<double> cpu_s{};          ///< of the rendering, without compilation
    std::optional<double> mpaths_per_s{};   ///< millions of paths per second of it
    std::optional<double> compile_cpu_s{};  ///< of just-in-time compilation
    std::optional<double> process_cpu_s{};  ///< of the whole process
    std::optional<double> peak_mb{};        ///< memory of the whole process
    std::string reason{};                   ///< why there is no result
};
NLOS_FIGURES(RenderingRow,
             scene,
             max_bounces,
             program,
             method,
             samples,
             target_error,
             rel_l2,
             energy_ratio,
             cpu_s,
             mpaths_per_s,
             compile_cpu_s,
             process_cpu_s,
             peak_mb,
             reason);

/// What an error of 1 % costs.
struct RenderingSummary {
    std::string scene{};
    int max_bounces = 0;
    std::string program{};
    std::string method{};
    std::optional<double> cpu_s_at_1_percent{};
    std::optional<double> times_ours{};  ///< over that of the fastest of ours
    std::string reason{};                ///< why it does not get there
};
NLOS_FIGURES(
    RenderingSummary, scene, max_bounces, program, method, cpu_s_at_1_percent, times_ours, reason);

/// All that renderers were asked for.
struct RenderingTable {
    std::vector<RenderingRow> rows;
    std::vector<RenderingSummary> summaries;
    std::vector<core::Json> agreement;  ///< of a peer's histograms with ours, see bin_agreement.h
};

/// Renders letter, animal and bars to orders 3 and 5 from a single laser by all renderers, and the
/// room, lit by a point light, as an image.
///
/// points    along either side of the wall, a multiple of 4
/// quick     the letter to order 3 alone
RenderingTable measure_renderings(Baselines& baselines,
                                  int points,
                                  bool quick,
                                  const core::Progress& progress);

}  // namespace apps
