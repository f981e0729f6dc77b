// SPDX-License-Identifier: MIT
#include "apps/bench/field/rendering_table.h"

#include "apps/bench/field/bin_agreement.h"
#include "apps/bench/field/one_sided_mesh.h"
#include "apps/bench/output.h"
#include "apps/bench/scene.h"
#include "apps/bench/statistics.h"
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/ply_file.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

namespace apps {
namespace {

using std::optional;

constexpr double kOnePercent = 0.01;
// Four times the paths halve an unbiased error; one that keeps more than this of it has a floor.
constexpr double kLeastGain = 0.7;
constexpr std::size_t kBlock = 4;
constexpr double kLeastShare = 0.02;  // of a block's light, for a cell of its own
constexpr int kRuns = 32;
// Rays that start 0.02 mm off the wall see what is 0.44 m away larger by twice their ratio: what
// hidden-geometry sampling may lose of all light, known no better than that.
constexpr double kRayOffsetLoss = 1e-4;

/// A scene to an order, and what is known of the truth.
struct RenderedScene {
    std::string scene;
    int max_bounces = 3;
    int points = 0;
    double reference_error = 0.0;  ///< relative L2 of what errors are measured against

    std::string name() const { return fmt::format("{}_order_{}", scene, max_bounces); }
    std::string path() const { return "scenes/" + scene + "/scene.json"; }
    std::vector<std::string> overrides() const {
        return {"scan.pattern=single",
                fmt::format("scan.sensing_points=[{0},{0}]", points),
                fmt::format("render.max_bounces={}", max_bounces)};
    }
};

/// How hard a renderer is to try.
struct Effort {
    optional<int> samples;
    optional<double> target_error;
};

std::vector<RenderedScene> rendered_scenes(int points, bool quick) {
    if (quick) return {{"letter", 3, points, 5e-4}};
    return {{"letter", 3, points, 5e-4},
            {"letter", 5, points, 1e-3},
            {"animal", 3, points, 5e-4},
            {"animal", 5, points, 2e-3},
            {"bars", 3, points, 1e-3},
            {"bars", 5, points, 5e-3}};
}

/// How a peer draws directions, and how many paths it takes: few, and four times as many.
struct PeerSampling {
    std::string name;
    int few_samples = 0;
    bool is_unbiased = true;  ///< in scenes whose surfaces hide one another, too
};

/// Two independent references, and the tools to run renderers on a task.
class RenderingTask {
 public:
    RenderingTask(Contenders& contenders, RenderedScene task)
        : contenders_(contenders), task_(std::move(task)), scene_(task_.path(), task_.overrides()) {
        stem_ = contenders_.folder() + "/" + task_.name();
        for (std::uint64_t seed = 0; seed < 2; ++seed) {
            renderer::RenderSettings settings = scene_.settings();
            settings.method = renderer::Estimator::Auto;
            settings.target_error = task_.reference_error;
            settings.by_order = true;  // else it leaves orders out that it knows to be small
            settings.seed = 1000 + seed;
            references_.push_back(scene_.render(settings).transient);
            if (task_.max_bounces == 3) break;  // deterministic
        }
    }

    RenderingRow run_own(const std::string& method, double target_error) {
        const std::string output = fmt::format("{}_{}.h5", stem_, method);
        std::vector<std::string> arguments{"render",
                                           core::shipped_file(task_.path()),
                                           "-o",
                                           output,
                                           "--method",
                                           method,
                                           "--set",
                                           fmt::format("render.target_error={}", target_error)};
        for (const std::string& setting : task_.overrides()) arguments.push_back(setting);
        RenderingRow row = row_of("nlos",
                                  method,
                                  {{}, target_error},
                                  contenders_.run_own(task_.name() + " " + method, arguments));
        if (row.reason.empty()) score(nlos::read_capture(output).transient, row);
        return row;
    }

    RenderingRow run_peer(const PeerSampling& sampling, int samples) {
        const auto [run, runs] = ask_peer(sampling, samples, {0});
        RenderingRow row = row_of("mitransient", sampling.name, {samples, {}}, run);
        if (!row.reason.empty()) return row;
        const auto compile = run.said.find("compile_cpu_s");
        if (compile != run.said.end() && compile->is_number()) row.compile_cpu_s = *compile;
        score(runs.front(), row);
        return row;
    }

    core::Json agree(const PeerSampling& sampling) {
        std::vector<int> seeds;
        for (int seed = 1; seed <= kRuns; ++seed) seeds.push_back(seed);
        const auto [run, runs] = ask_peer(sampling, 2 * sampling.few_samples, seeds);
        core::Json row{{"scene", task_.scene},
                       {"max_bounces", task_.max_bounces},
                       {"program", "mitransient"},
                       {"method", sampling.name},
                       {"runs", 0},  // independent seeds
                       {"energy_ratio", nullptr},
                       {"energy_z", nullptr},
                       {"cells", 0},
                       {"rms_z", nullptr},
                       {"worst_z", nullptr},
                       {"worst_by_chance", nullptr},
                       {"consistent", false},
                       {"reason", run.failure}};
        if (!run.failure.empty()) return row;
        const auto side = static_cast<std::size_t>(task_.points);
        const BinAgreement found = bin_agreement_of(
            mean_reference(), runs, {side, side}, kBlock, kLeastShare, kRayOffsetLoss);
        row["runs"] = kRuns;
        row["energy_ratio"] = found.energy_ratio;
        row["energy_z"] = found.energy_z;
        row["cells"] = found.num_cells;
        row["rms_z"] = found.rms_z;
        row["worst_z"] = found.worst_z;
        return row;
    }

 private:
    RenderingRow row_of(const std::string& program,
                        const std::string& method,
                        const Effort& effort,
                        const FieldRun& run) const {
        RenderingRow row{
            task_.scene, task_.max_bounces, program, method, effort.samples, effort.target_error};
        enter_run(run, row);
        return row;
    }

    core::Transient mean_reference() const {
        core::Transient mean = references_.front();
        const auto other = references_.back().values();
        for (std::size_t i = 0; i < other.size(); ++i) {
            mean.values()[i] = 0.5F * (mean.values()[i] + other[i]);
        }
        return mean;
    }

    void score(const core::Transient& found, RenderingRow& row) const {
        const ErrorSums sums = errors_of(found, references_.front(), references_.back());
        row.rel_l2 = std::sqrt(std::max(0.0, sums.rel_mse()));
        row.energy_ratio = sums.sum / sums.reference_sum;
    }

    // One histogram per wall point for every seed; none where the run failed.
    std::pair<FieldRun, std::vector<core::Transient>> ask_peer(const PeerSampling& sampling,
                                                               int samples,
                                                               const std::vector<int>& seeds) {
        core::Json request = scene_request();
        request["sampling"] = sampling.name;
        request["samples"] = samples;
        request["seeds"] = seeds;
        std::vector<std::string> outputs;
        for (const int seed : seeds)
            outputs.push_back(fmt::format("{}_{}_{}.h5", stem_, sampling.name, seed));
        request["outputs"] = outputs;
        std::pair<FieldRun, std::vector<core::Transient>> result;
        auto& [run, transients] = result;
        run =
            contenders_.run_peer(task_.name() + " " + sampling.name, "mitransient_render", request);
        if (!run.failure.empty()) return result;
        try {
            for (const std::string& output : outputs) transients.push_back(read_histograms(output));
        } catch (const std::exception& error) {
            run.failure = error.what();
        }
        return result;
    }

    core::Transient read_histograms(const std::string& path) const {
        const auto side = static_cast<std::size_t>(task_.points);
        const auto bins = static_cast<std::size_t>(scene_.axis().num_bins);
        const std::size_t pairs = side * side;
        const std::vector<float> values =
            nlos::ArrayReader(path).read_floats("H", {bins, side, side});
        core::Transient transient(pairs, scene_.axis().num_bins);
        for (std::size_t b = 0; b < bins; ++b) {
            for (std::size_t p = 0; p < pairs; ++p)
                transient.values()[p * bins + b] = values[b * pairs + p];
        }
        std::filesystem::remove(path);
        return transient;
    }

    core::Json scene_request() const {
        const core::RelayWall& wall = scene_.description().relay_wall;
        const core::Transform pose = wall.world_from_wall();
        const auto list = [](const core::Vec3& v) { return core::Json{v.x(), v.y(), v.z()}; };
        core::Json meshes = core::Json::array();
        for (const renderer::Object& object :
             renderer::load_geometry(scene_.description()).objects) {
            if (object.role == renderer::Role::RelayWall) continue;
            const std::string file = fmt::format("{}_{}.ply", stem_, meshes.size());
            nlos::write_ply(file, turned_to_wall(object.mesh, pose.linear().col(2)));
            meshes.push_back({{"file", file}, {"albedo", object.material.albedo}});
        }
        return {{"max_bounces", task_.max_bounces},
                {"meshes", meshes},
                {"relay_wall",
                 {{"center_m", list(wall.center_m)},
                  {"x_axis", list(pose.linear().col(0))},
                  {"y_axis", list(pose.linear().col(1))},
                  {"normal", list(pose.linear().col(2))},
                  {"size_m", wall.size_m},
                  {"albedo", wall.albedo}}},
                {"illumination_m", list(scene_.scan().illumination.positions.front())},
                {"sensing_points", {task_.points, task_.points}},
                {"opl_start_m", scene_.axis().opl_start_m},
                {"bin_width_m", scene_.axis().bin_width_m},
                {"num_bins", scene_.axis().num_bins}};
    }

    Contenders& contenders_;
    RenderedScene task_;
    BenchScene scene_;
    std::string stem_;
    std::vector<core::Transient> references_;
};

std::vector<PeerSampling> samplings_of(const RenderedScene& task) {
    constexpr int kFew = 500;
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

RenderingTable measure_renderings(Contenders& contenders,
                                  int points,
                                  bool quick,
                                  const core::Progress& progress) {
    RenderingTable table;
    const std::vector<RenderedScene> tasks = rendered_scenes(points, quick);
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        const auto begin = [&](const std::string& what) {
            progress.update(share_of(t, tasks.size()), tasks[t].name() + ", " + what);
        };
        begin("reference");
        RenderingTask task(contenders, tasks[t]);
        std::vector<RenderingSummary> summaries;
        const auto add = [&](const std::vector<RenderingRow>& runs) {
            table.rows.insert(table.rows.end(), runs.begin(), runs.end());
            summaries.push_back(summary_of(runs));
        };
        begin("nlos");
        for (const std::string method : {"third_bounce", "auto", "path"}) {
            if (method == "third_bounce" && tasks[t].max_bounces > 3) continue;
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
