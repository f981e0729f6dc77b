// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/letter_scene.h"
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_run.h"
#include "apps/bench/scene.h"
#include "apps/scene_truth.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/formats/capture_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace apps {
namespace {

struct AccuracyTarget {
    double max_mae_m = 0.0;
    double min_iou_best = 0.0;
    double max_normal_median_deg = 0.0;
};

void judge(const AccuracyTarget& target, ReconstructAccuracy& row) {
    bool holds = true;
    const auto add = [&](const std::string& text, bool is_met) {
        row.target += (row.target.empty() ? "" : ", ") + text;
        holds = holds && is_met;
    };
    if (target.min_iou_best > 0.0) {
        add(fmt::format("IoU >= {:g}", target.min_iou_best),
            row.mask_iou_best >= target.min_iou_best);
    }
    if (target.max_mae_m > 0.0) {
        add(fmt::format("MAE <= {:g} mm", 1e3 * target.max_mae_m),
            row.depth_mae_m <= target.max_mae_m);
    }
    if (target.max_normal_median_deg > 0.0) {
        add(fmt::format("normals <= {:g} deg", target.max_normal_median_deg),
            row.normal_median_deg <= target.max_normal_median_deg);
    }
    if (!row.target.empty()) row.met = holds ? "yes" : "no";
}

/// A capture and what its volumes are compared with.
struct Exam {
    std::string name;
    core::Capture capture;
    std::function<core::DepthMap(const nlos::VolumeAxes&)> truth;
};

Exam exam_of_scene(const std::string& folder, const std::string& name) {
    const std::string path = folder + "/" + name + "/scene.json";
    const BenchScene scene(path);
    const auto truth = std::make_shared<SceneTruth>(path);
    return {name, scene.render(scene.settings()), [truth](const nlos::VolumeAxes& axes) {
                return truth->depth_map(axes.world_from_wall, axes.x_m, axes.y_m);
            }};
}

Exam with_counts(Exam exam, double peak_counts) {
    const auto values = exam.capture.transient.values();
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    nlos::DetectorSettings settings;
    settings.photons = peak_counts * sum / static_cast<double>(*std::ranges::max_element(values));
    exam.capture = nlos::detect(exam.capture, settings);
    exam.name += fmt::format(", {:g} counts", peak_counts);
    return exam;
}

Exam exam_of_letter_t(const std::string& name, core::Capture capture) {
    return {name, std::move(capture), [](const nlos::VolumeAxes& axes) {
                return letter_t_depth(axes.world_from_wall, axes.x_m, axes.y_m);
            }};
}

/// The methods that serve an exam, and what is asked of them.
struct Candidate {
    std::string method;
    Overrides overrides;
    AccuracyTarget target;
};

ReconstructAccuracy measure_accuracy(const Exam& exam, const Candidate& candidate) {
    const ReconstructRun one = run_reconstruction(exam.capture, candidate.overrides);
    const nlos::Metrics metrics =
        nlos::compare_to_truth(one.result, exam.truth(one.result.volume.axes));
    constexpr double kNothingFound_m = 1.0;
    ReconstructAccuracy row;
    row.scene = exam.name;
    row.method = candidate.method;
    row.depth_mae_m = metrics.depth_mae_m.value_or(kNothingFound_m);
    row.depth_median_m = metrics.depth_median_m.value_or(kNothingFound_m);
    row.depth_rmse_m = metrics.depth_rmse_m.value_or(kNothingFound_m);
    row.mask_iou = metrics.mask_iou.value_or(0.0);
    row.mask_iou_best = metrics.mask_iou_best.value_or(0.0);
    row.normal_median_deg = metrics.normal_median_deg.value_or(180.0);
    row.cpu_seconds = one.cpu_seconds;
    judge(candidate.target, row);
    return row;
}

struct AccuracyCase {
    std::function<Exam()> exam;
    std::vector<Candidate> candidates;
};

std::vector<AccuracyCase> accuracy_cases(const ReconstructBenchSettings& settings) {
    const std::string folder = settings.scenes_folder;
    const Candidate lct{"lct", {"method=lct"}, {}};
    const Candidate tv{"solver", {"method=solver"}, {}};
    const Candidate dlct{"dlct", {"method=dlct"}, {}};
    const Candidate fk{"fk", {"method=fk"}, {}};
    const Candidate phasor{"phasor", {"method=phasor"}, {}};
    const Candidate fbp{"fbp", {"method=fbp"}, {}};
    const Candidate bp{"bp", {"method=bp"}, {}};
    const auto with = [](Candidate candidate, AccuracyTarget target) {
        candidate.target = target;
        return candidate;
    };
    // What y-tal reaches on the same letter, or better where more was asked.
    const std::vector<Candidate> on_letter_t{with(lct, {0.7e-3, 0.95, 0.0}),
                                             tv,
                                             dlct,
                                             with(fk, {2.0e-3, 0.95, 0.0}),
                                             phasor,
                                             fbp,
                                             with(bp, {2.4e-3, 0.67, 0.0})};
    const std::vector<Candidate> on_animal{with(lct, {10e-3, 0.0, 0.0}),
                                           with(tv, {6e-3, 0.0, 0.0}),
                                           with(dlct, {0.0, 0.0, 10.0}),
                                           fk,
                                           phasor,
                                           fbp,
                                           bp};
    const std::vector<Candidate> all{lct, tv, dlct, fk, phasor, fbp, bp};
    const auto scene = [folder](const std::string& name) {
        return [folder, name] { return exam_of_scene(folder, name); };
    };
    std::vector<AccuracyCase> cases{
        {[] { return exam_of_letter_t("letter T", letter_t_capture(core::ScanPattern::Confocal)); },
         on_letter_t},
        {[] {
             return exam_of_letter_t("letter T, single laser",
                                     letter_t_capture(core::ScanPattern::Single));
         },
         {with(phasor, {2.8e-3, 0.83, 0.0}), fbp}},
        {scene("animal"), on_animal},
        {[folder] { return with_counts(exam_of_scene(folder, "animal"), 20.0); }, on_animal},
        {scene("letter"), all},
        {scene("bars"), all},
        {scene("corner"), all},
        {scene("curved"), {phasor, fbp, bp}}};
    if (!settings.capture.empty()) {
        const std::string path = settings.capture;
        cases.push_back(
            {[path] { return exam_of_letter_t(path, nlos::read_capture(path)); }, on_letter_t});
    }
    return cases;
}

}  // namespace

std::vector<ReconstructAccuracy> measure_accuracies(const ReconstructBenchSettings& settings,
                                                    const core::Progress& progress) {
    const std::vector<AccuracyCase> cases = accuracy_cases(settings);
    std::vector<ReconstructAccuracy> accuracies;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Exam exam = cases[i].exam();
        progress.update(static_cast<double>(i) / static_cast<double>(cases.size()), exam.name);
        for (const Candidate& candidate : cases[i].candidates) {
            if (progress.should_stop()) throw core::Failure("bench", "interrupted");
            accuracies.push_back(measure_accuracy(exam, candidate));
        }
    }
    return accuracies;
}

}  // namespace apps
