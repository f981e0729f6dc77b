// SPDX-License-Identifier: MIT
#include "apps/bench/field/rendering_table.h"

#include "apps/bench/field/bin_agreement.h"
#include "apps/bench/field/rendering_task.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace apps {
namespace {

constexpr double kOnePercent = 0.01;
// Four times the paths halve an unbiased error; one that keeps more than this of it has a floor.
constexpr double kLeastGain = 0.7;

std::vector<RenderedScene> rendered_scenes(int points, bool quick) {
    if (quick) return {{"letter", 3, points, 5e-4}};
    return {{"letter", 3, points, 5e-4},
            {"letter", 5, points, 1e-3},
            {"animal", 3, points, 5e-4},
            {"animal", 5, points, 2e-3},
            {"bars", 3, points, 1e-3},
            {"bars", 5, points, 5e-3},
            {"room", 5, 0, 5e-3}};
}

std::vector<std::string> own_methods(const RenderedScene& task) {
    if (task.is_image()) return {"path"};
    if (task.max_bounces > 3) return {"auto", "path"};
    return {"third_bounce", "auto", "path"};
}

std::vector<PeerSampling> samplings_of(const RenderedScene& task) {
    constexpr int kFew = 500;
    constexpr int kFewPerPixel = 64;
    if (task.is_image()) return {{"bsdf", kFewPerPixel, true}};
    return {{"hidden", kFew, task.scene == "letter"}, {"bsdf", 4 * kFew, true}};
}

// What 1 % costs by the runs of one method, the last of which tried hardest.
RenderingSummary summary_of(const std::vector<RenderingRow>& runs) {
    const RenderingRow& last = runs.back();
    RenderingSummary summary{last.scene, last.max_bounces, last.program, last.method};
    summary.reason = last.reason;
    if (!summary.reason.empty()) return summary;
    if (last.target_error) {
        summary.cpu_s_at_1_percent = last.cpu_s;
        if (*last.rel_l2 > kOnePercent) {
            summary.reason = fmt::format("asked for 1 %, got {:.2f} %", 100.0 * *last.rel_l2);
        }
        return summary;
    }
    const bool has_floor =
        runs.size() > 1 && *last.rel_l2 > kLeastGain * runs.front().rel_l2.value_or(
                                                           std::numeric_limits<double>::infinity());
    if (has_floor) {
        summary.reason = fmt::format("biased: four times the paths leave {:.1f} % of error",
                                     100.0 * *last.rel_l2);
    } else {
        summary.cpu_s_at_1_percent = *last.cpu_s * std::pow(*last.rel_l2 / kOnePercent, 2);
    }
    return summary;
}

void compare_with_ours(std::vector<RenderingSummary>& of_task) {
    double ours = std::numeric_limits<double>::infinity();
    for (const RenderingSummary& s : of_task) {
        if (s.program == "nlos" && s.cpu_s_at_1_percent)
            ours = std::min(ours, *s.cpu_s_at_1_percent);
    }
    for (RenderingSummary& s : of_task) {
        if (s.cpu_s_at_1_percent) s.times_ours = *s.cpu_s_at_1_percent / ours;
    }
}

}  // namespace

RenderingTable measure_renderings(Baselines& baselines,
                                  int points,
                                  bool quick,
                                  const core::Progress& progress) {
    RenderingTable table;
    const std::vector<RenderedScene> tasks = rendered_scenes(points, quick);
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        const auto begin = [&](const std::string& what) {
            progress.update(fraction_of(t, tasks.size()), tasks[t].name() + ", " + what);
        };
        begin("reference");
        RenderingTask task(baselines, tasks[t]);
        std::vector<RenderingSummary> summaries;
        const auto add = [&](const std::vector<RenderingRow>& runs) {
            table.rows.insert(table.rows.end(), runs.begin(), runs.end());
            summaries.push_back(summary_of(runs));
        };
        begin("nlos");
        for (const std::string& method : own_methods(tasks[t])) {
            add({task.run_own(method, 2 * kOnePercent), task.run_own(method, kOnePercent)});
        }
        for (const PeerSampling& sampling : samplings_of(tasks[t])) {
            begin("mitransient " + sampling.name);
            add({task.run_peer(sampling, sampling.few_samples),
                 task.run_peer(sampling, 4 * sampling.few_samples)});
            if (sampling.is_unbiased) {
                table.agreement.push_back(task.agree(sampling));
            } else if (RenderingSummary& summary = summaries.back(); summary.reason.empty()) {
                summary.cpu_s_at_1_percent.reset();
                summary.reason = "biased where surfaces hide one another";
            }
        }
        compare_with_ours(summaries);
        table.summaries.insert(table.summaries.end(), summaries.begin(), summaries.end());
    }
    judge_agreement(table.agreement);
    return table;
}

}  // namespace apps
