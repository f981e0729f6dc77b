// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/reconstruct.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "apps/bench/scene.h"
#include "apps/scene_truth.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/formats/capture_file.h"
#include "nlos/methods/methods.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/depth_map.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/parallel.h"
#include "renderer/scene/scene_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace apps {
namespace {

using core::Vec3;

constexpr double kDepth_m = 0.7;
constexpr double kPatch_m = 0.012;
constexpr int kPoints = 64;

bool is_on_letter(double x, double y) {
    const bool is_stem = std::abs(x) < 0.066 && std::abs(y) < 0.306;
    const bool is_bar = std::abs(x) < 0.306 && y > 0.174 && y < 0.306;
    return is_stem || is_bar;
}

std::vector<Vec3> patches() {
    std::vector<Vec3> centres;
    for (int ix = -26; ix <= 26; ++ix) {
        for (int iy = -26; iy <= 26; ++iy) {
            const Vec3 centre(kPatch_m * ix, kPatch_m * iy, kDepth_m);
            if (is_on_letter(centre.x(), centre.y())) centres.push_back(centre);
        }
    }
    return centres;
}

/// The letter T that methods are compared on: 12 mm patches, 0.7 m before a wall of 1 m with
/// 64 x 64 points and 512 bins of 8 mm, light without cosines, 1 / (r_l^2 r_s^2).
///
/// pattern   confocal, or single with the laser on the wall's centre
core::Capture letter_t_capture(core::ScanPattern pattern) {
    renderer::SceneDescription description;
    description.scan.pattern = {pattern};
    description.scan.sensing_points = {kPoints, kPoints};
    core::Capture capture;
    capture.scan = renderer::make_scan(description);
    const core::WallScan& scan = capture.scan.wall();
    capture.time_axis = {0.0, 0.008, 512};
    capture.transient = core::Transient(scan.num_pairs(), capture.time_axis.num_bins);
    const std::vector<Vec3> letter = patches();
    core::parallel_for(scan.num_pairs(), [&](std::size_t pair) {
        const Vec3& l = scan.illumination_point(pair);
        const Vec3& s = scan.sensing_point(pair);
        const auto histogram = capture.transient.histogram(pair);
        for (const Vec3& patch : letter) {
            const double out = (patch - l).norm();
            const double back = (patch - s).norm();
            const double bin = (out + back) / capture.time_axis.bin_width_m - 0.5;
            const auto first = static_cast<std::size_t>(bin);
            if (first + 1 >= histogram.size()) continue;
            const double light = 1.0 / (out * out * back * back);
            const double late = bin - static_cast<double>(first);
            histogram[first] += static_cast<float>(light * (1.0 - late));
            histogram[first + 1] += static_cast<float>(light * late);
        }
    });
    return capture;
}

/// Its true depth: |x| < 66 mm with |y| < 306 mm, or |x| < 306 mm with 174 mm < y < 306 mm.
core::DepthMap letter_t_depth(const nlos::VolumeAxes& axes) {
    core::DepthMap depth(axes.x_m, axes.y_m);
    depth.world_from_wall = axes.world_from_wall;
    depth.normals.assign(depth.depth_m.size(), Vec3::Zero());
    for (std::size_t ix = 0; ix < axes.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < axes.y_m.size(); ++iy) {
            const Vec3 at = axes.world_from_wall * Vec3(axes.x_m[ix], axes.y_m[iy], kDepth_m);
            if (!is_on_letter(at.x(), at.y())) continue;
            depth.depth_m[depth.index(ix, iy)] = kDepth_m;
            depth.normals[depth.index(ix, iy)] = -Vec3::UnitZ();
        }
    }
    return depth;
}

struct AccuracyTarget {
    double max_mae_m = 0.0;
    double min_iou_best = 0.0;
    double max_normal_median_deg = 0.0;
};

/// A capture and what its volumes are compared with.
struct Exam {
    std::string name;
    core::Capture capture;
    std::function<core::TrueSurface(const nlos::VolumeAxes&)> truth;
};

Exam exam_of_scene(const std::string& folder, const std::string& name) {
    const std::string path = folder + "/" + name + "/scene.json";
    const auto truth = std::make_shared<SceneTruth>(path);
    return {name, BenchScene(path).render(), [truth](const nlos::VolumeAxes& axes) {
                return truth->surface(axes);
            }};
}

Exam with_counts(Exam exam, double peak_counts) {
    nlos::DetectorSettings settings;
    settings.photons = photons_for_peak(exam.capture, peak_counts);
    exam.capture = nlos::detect(exam.capture, settings);
    exam.name += fmt::format(", {:g} counts", peak_counts);
    return exam;
}

/// A method that serves an exam, and what is asked of it.
struct Candidate {
    std::string method;
    AccuracyTarget target{};
};

/// Every method, of which something is asked of these.
std::vector<Candidate> every_method(const std::vector<Candidate>& with_targets) {
    std::vector<Candidate> all;
    for (const nlos::MethodTraits* traits : nlos::kMethods) {
        Candidate candidate{std::string(core::enum_name(traits->method))};
        for (const Candidate& other : with_targets) {
            if (other.method == candidate.method) candidate.target = other.target;
        }
        all.push_back(std::move(candidate));
    }
    return all;
}

core::Json measure_accuracy(const Exam& exam, const Candidate& candidate) {
    const ReconstructRun one = run_reconstruction(exam.capture, {"method=" + candidate.method});
    const nlos::Metrics metrics =
        nlos::compare_to_truth(one.result, exam.truth(one.result.volume.axes));
    constexpr double kNothingFound_m = 1.0;
    const double depth_mae_m = metrics.depth_mae_m.value_or(kNothingFound_m);
    const double iou_best = metrics.mask_iou_best.value_or(0.0);
    const double normal_median_deg = metrics.normal_median_deg.value_or(180.0);
    core::Json row{{"scene", exam.name},  // with its noise
                   {"method", candidate.method},
                   {"depth_mae_m", depth_mae_m},
                   {"depth_median_m", metrics.depth_median_m.value_or(kNothingFound_m)},
                   {"depth_rmse_m", metrics.depth_rmse_m.value_or(kNothingFound_m)},
                   {"mask_iou", metrics.mask_iou.value_or(0.0)},  // at 20 % of the maximum
                   {"mask_iou_best", iou_best},                   // at the best threshold
                   {"normal_median_deg", normal_median_deg},
                   {"cpu_seconds", one.cpu_seconds},
                   {"target", ""},
                   {"met", ""}};
    const auto& [max_mae_m, min_iou, max_normal_deg] = candidate.target;
    judge(min_iou > 0.0, fmt::format("IoU >= {:g}", min_iou), iou_best >= min_iou, row);
    judge(max_mae_m > 0.0,
          fmt::format("MAE <= {:g} mm", 1e3 * max_mae_m),
          depth_mae_m <= max_mae_m,
          row);
    judge(max_normal_deg > 0.0,
          fmt::format("normals <= {:g} deg", max_normal_deg),
          normal_median_deg <= max_normal_deg,
          row);
    return row;
}

struct AccuracyCase {
    std::function<Exam()> exam;
    std::vector<Candidate> candidates;
};

std::vector<AccuracyCase> accuracy_cases(const ReconstructBenchSettings& settings) {
    const std::string folder = settings.scenes_folder;
    // What y-tal reaches on the same letter, or better where more was asked.
    const std::vector<Candidate> on_letter_t = every_method(
        {{"lct", {0.7e-3, 0.95, 0.0}}, {"fk", {2.0e-3, 0.95, 0.0}}, {"bp", {2.4e-3, 0.67, 0.0}}});
    const std::vector<Candidate> on_animal = every_method(
        {{"lct", {10e-3, 0.0, 0.0}}, {"solver", {6e-3, 0.0, 0.0}}, {"dlct", {0.0, 0.0, 10.0}}});
    const std::vector<Candidate> all = every_method({});
    const auto letter_t = [](const char* name, core::ScanPattern pattern) {
        return [name, pattern] { return Exam{name, letter_t_capture(pattern), letter_t_depth}; };
    };
    const auto scene = [folder](const std::string& name) {
        return [folder, name] { return exam_of_scene(folder, name); };
    };
    return {{letter_t("letter T", core::ScanPattern::Confocal), on_letter_t},
            {letter_t("letter T, single laser", core::ScanPattern::Single),
             {{"phasor", {2.8e-3, 0.83, 0.0}}, {"fbp"}}},
            {scene("animal"), on_animal},
            {[folder] { return with_counts(exam_of_scene(folder, "animal"), 20.0); }, on_animal},
            {scene("letter"), all},
            {scene("bars"), all},
            {scene("corner"), all},
            {scene("curved"), {{"phasor"}, {"fbp"}, {"bp"}}}};
}

}  // namespace

core::Json measure_accuracies(const ReconstructBenchSettings& settings,
                              const core::Progress& progress) {
    const std::vector<AccuracyCase> cases = accuracy_cases(settings);
    core::Json accuracies = core::Json::array();
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Exam exam = cases[i].exam();
        for (const Candidate& candidate : cases[i].candidates) {
            progress.update(fraction_of(i, cases.size()), exam.name);
            accuracies.push_back(measure_accuracy(exam, candidate));
        }
    }
    return accuracies;
}

}  // namespace apps
