// SPDX-License-Identifier: MIT
#include "apps/bench/field/reconstruction_table.h"

#include "apps/bench/field/peak_depths.h"
#include "apps/bench/scene.h"
#include "apps/terminal.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/methods/methods.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/statistics.h"
#include "renderer/scene/ground_truth.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace apps {
namespace {

using nlos::ImagePanel;
using nlos::Panel;
using std::optional;

const std::string kClean = "clean";
constexpr double kCleanError = 1e-3;  // relative L2 of captures without noise
constexpr std::uint64_t kNoiseSeed = 1;
constexpr double kSamplesPerColumn = 8.0;  // of the truth, along x and along y

/// A scene seen from one grid of points in one pattern.
struct ReconstructedScene {
    std::string scene;
    std::string pattern;
    int points = 0;
    std::vector<std::string> lights;

    std::string name() const { return fmt::format("{}_{}_{}", scene, pattern, points); }
    std::string kind() const { return fmt::format("{}_{}", pattern, points); }
};

std::vector<ReconstructedScene> tasks_of(int points, bool quick) {
    if (quick) {
        return {{"letter", "confocal", points, {kClean, "20"}},
                {"letter", "single", points, {kClean}}};
    }
    std::vector<ReconstructedScene> tasks;
    for (const char* scene : {"letter", "animal", "bars", "corner", "curved"}) {
        for (const char* pattern : {"confocal", "single"}) {
            tasks.push_back({scene, pattern, points, {kClean, "100", "20", "3"}});
        }
    }
    for (const char* pattern : {"confocal", "single"}) {
        tasks.push_back({"letter", pattern, 2 * points, {kClean}});
    }
    return tasks;
}

BenchScene scene_of(const ReconstructedScene& task) {
    std::vector<std::string> overrides{
        "scan.pattern=" + task.pattern, "render.max_bounces=3", "render.by_order=false"};
    // The points of the curved wall are its own.
    if (task.scene != "curved") {
        overrides.push_back(fmt::format("scan.sensing_points=[{0},{0}]", task.points));
    }
    return BenchScene("scenes/" + task.scene + "/scene.json", overrides);
}

core::Capture clean_capture(const BenchScene& scene) {
    renderer::RenderSettings settings = scene.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = kCleanError;
    return scene.render(settings);
}

core::Capture lit_capture(const core::Capture& clean, const std::string& light) {
    if (light == kClean) return clean;
    nlos::DetectorSettings detector;
    detector.photons_per_point = std::stod(light);
    detector.seed = kNoiseSeed;
    return nlos::detect(clean, detector);
}

optional<double> times(optional<double> value, double factor) {
    return value ? optional<double>(factor * *value) : std::nullopt;
}

void score(const MethodVolume& result, const core::TrueSurface& truth, ReconstructionRow& row) {
    nlos::Reconstruction scored;
    scored.volume = result.volume;
    scored.depth = peak_depths(result.volume);
    const nlos::Metrics peaks = nlos::compare_to_truth(scored, truth);
    row.depth_mae_mm = times(peaks.depth_mae_m, 1e3);
    row.depth_coverage = peaks.depth_coverage;
    row.iou = peaks.mask_iou;
    row.iou_best = peaks.mask_iou_best;
    if (result.reported.depth_m.empty()) return;
    scored.depth = result.reported;
    row.stated_mae_mm = times(nlos::compare_to_truth(scored, truth).depth_mae_m, 1e3);
}

Panel truth_panel(const core::DepthMap& truth) {
    std::vector<float> depths(truth.depth_m.begin(), truth.depth_m.end());
    ImagePanel panel = nlos::front_panel(truth.x_m, truth.y_m, depths);
    panel.title = "truth: depth [m]";
    return panel;
}

optional<double> median_of(const std::vector<const ReconstructionRow*>& rows,
                           const std::string& light,
                           optional<double> ReconstructionRow::*figure) {
    std::vector<double> values;
    for (const ReconstructionRow* row : rows) {
        if ((light.empty() || row->light == light) && row->*figure)
            values.push_back(*(row->*figure));
    }
    if (values.empty()) return std::nullopt;
    return core::median(values);
}

}  // namespace

const std::vector<ReconstructionMethod>& reconstruction_methods() {
    static const std::vector<ReconstructionMethod> methods = [] {
        std::vector<ReconstructionMethod> all;
        for (const nlos::MethodTraits* own : nlos::kMethods) {
            all.push_back({"nlos", "", std::string(core::enum_name(own->method))});
        }
        all.push_back({"nlos", "", "auto"});
        for (const char* peer : {"bp", "lct", "fk", "phasor"}) {
            all.push_back({"y-tal", "ytal_reconstruct", peer});
        }
        return all;
    }();
    return methods;
}

double point_distance_m(const core::WallScan& scan) {
    const std::vector<core::Vec3>& points = scan.scanned_points().positions;
    double distance_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < points.size(); ++i) {
        distance_m = std::min(distance_m, (points[i] - points[0]).norm());
    }
    return distance_m;
}

Panel projection_panel(const ReconstructionMethod& method, const nlos::Volume& volume) {
    std::vector<float> brightness = nlos::max_projection(volume);
    const float brightest = *std::max_element(brightness.begin(), brightness.end());
    for (float& value : brightness) value /= brightest > 0.0F ? brightest : 1.0F;
    ImagePanel panel = nlos::front_panel(volume.axes.x_m, volume.axes.y_m, brightness);
    panel.title = method.program + " " + method.method;
    panel.value_range = {0.0, 1.0};
    return panel;
}

SharedCapture::SharedCapture(Baselines& baselines,
                             const std::string& name,
                             std::string kind,
                             const core::Capture& capture,
                             const DepthPlanes& planes)
    : baselines_(baselines),
      stem_(baselines.folder() + "/" + name),
      kind_(std::move(kind)),
      planes_(planes),
      // The wavelength that our phasor field takes.
      wavelength_m_((capture.scan.wall().is_confocal() ? 6.0 : 4.0) *
                    point_distance_m(capture.scan.wall())) {
    const auto side =
        std::lround(std::sqrt(static_cast<double>(capture.scan.wall().scanned_points().size())));
    columns_ = static_cast<int>(side);
    nlos::write_capture(stem_ + ".h5", capture);
    nlos::write_capture(stem_ + "_for_ytal.h5", capture, {.for_ytal = true, .layout = ""});
}

MethodVolume SharedCapture::run(const ReconstructionMethod& method) {
    return method.adapter.empty() ? run_own(method) : run_peer(method);
}

MethodVolume SharedCapture::run_own(const ReconstructionMethod& method) {
    const std::string path = fmt::format("{}_{}.h5", stem_, method.method);
    MethodVolume result;
    std::vector<std::string> arguments{
        "reconstruct",
        stem_ + ".h5",
        "-o",
        path,
        "--method",
        method.method,
        "--set",
        fmt::format("volume.z_range_m=[{},{}]", planes_.begin_m, planes_.end_m)};
    if (planes_.count) {
        arguments.push_back(fmt::format("volume.voxels=[{0},{0},{1}]", columns_, *planes_.count));
    }
    result.run = baselines_.run_own(kind_ + " " + method.method, arguments);
    if (!result.run.failure.empty()) return result;
    nlos::Reconstruction found = nlos::read_volume(path);
    result.volume = std::move(found.volume);
    result.reported = std::move(found.depth);
    // Its voxels are those of the peers, which run last.
    if (method.method == core::enum_name(nlos::kBp.method)) axes_ = result.volume.axes;
    return result;
}

MethodVolume SharedCapture::run_peer(const ReconstructionMethod& method) {
    MethodVolume result;
    if (!axes_) {
        result.run.failure = "there is no backprojection of ours to take the voxels from";
        return result;
    }
    const std::string path = fmt::format("{}_{}_{}.h5", stem_, method.program, method.method);
    core::Json pose = core::Json::array();
    for (int row = 0; row < 4; ++row) {
        const Eigen::RowVector4d values = axes_->world_from_wall.matrix().row(row);
        pose.push_back({values[0], values[1], values[2], values[3]});
    }
    constexpr double kMemoryGb = 8.0;
    result.run = baselines_.run_peer(kind_ + " " + method.method,
                                     method.adapter,
                                     {{"method", method.method},
                                      {"capture", stem_ + "_for_ytal.h5"},
                                      {"output", path},
                                      {"x_m", axes_->x_m},
                                      {"y_m", axes_->y_m},
                                      {"z_m", axes_->z_m},
                                      {"world_from_wall", pose},
                                      {"wavelength_m", wavelength_m_},
                                      {"memory_gb", kMemoryGb}});
    if (!result.run.failure.empty()) return result;
    try {
        result.volume = read_peer_volume(path, *axes_);
    } catch (const core::Error& error) {
        result.run.failure = error.what();
    }
    return result;
}

std::vector<ReconstructionRow> measure_reconstructions(
    Baselines& baselines,
    int points,
    bool quick,
    const core::Progress& progress,
    std::map<std::string, BenchPicture>& pictures) {
    std::vector<ReconstructionRow> rows;
    const std::vector<ReconstructedScene> tasks = tasks_of(points, quick);
    for (std::size_t t = 0; t < tasks.size(); ++t) {
        const ReconstructedScene& task = tasks[t];
        const BenchScene scene = scene_of(task);
        const core::Capture clean = clean_capture(scene);
        // Scans that are converted to confocal ones have columns of their own.
        std::optional<core::TrueSurface> truth;
        std::array<std::vector<double>, 2> columns_of_truth;
        const auto truth_for = [&](const nlos::VolumeAxes& axes) -> const core::TrueSurface& {
            if (columns_of_truth != std::array{axes.x_m, axes.y_m}) {
                columns_of_truth = {axes.x_m, axes.y_m};
                truth = renderer::trace_true_surface(scene.scene(),
                                                     axes.world_from_wall,
                                                     axes.x_m,
                                                     axes.y_m,
                                                     core::spacing_m(axes.x_m) / kSamplesPerColumn);
            }
            return *truth;
        };
        for (const std::string& light : task.lights) {
            SharedCapture capture(baselines,
                                  task.name() + "_" + light,
                                  task.kind(),
                                  lit_capture(clean, light),
                                  DepthPlanes{});
            std::vector<Panel> panels;
            for (const ReconstructionMethod& method : reconstruction_methods()) {
                progress.update(fraction_of(t, tasks.size()),
                                fmt::format("{} {}, {}", task.name(), light, method.method));
                ReconstructionRow row{
                    task.scene, task.pattern, task.points, light, method.program, method.method};
                const MethodVolume result = capture.run(method);
                if (enter_run(result.run, row)) {
                    const core::TrueSurface& seen = truth_for(result.volume.axes);
                    if (panels.empty()) panels.push_back(truth_panel(seen.main));
                    panels.push_back(projection_panel(method, result.volume));
                    score(result, seen, row);
                }
                rows.push_back(std::move(row));
            }
            if ((light == kClean || light == "20") && !panels.empty()) {
                constexpr int kColumns = 5;
                pictures["_" + task.name() + "_" + light] = {std::move(panels), kColumns};
            }
        }
    }
    return rows;
}

std::vector<ReconstructionSummary> summarise(const std::vector<ReconstructionRow>& rows) {
    std::vector<ReconstructionSummary> summaries;
    std::vector<std::vector<const ReconstructionRow*>> groups;
    for (const ReconstructionRow& row : rows) {
        const auto same = [&](const ReconstructionSummary& s) {
            return s.pattern == row.pattern && s.points == row.points && s.program == row.program &&
                   s.method == row.method;
        };
        const auto it = std::ranges::find_if(summaries, same);
        const auto index = static_cast<std::size_t>(it - summaries.begin());
        if (it == summaries.end()) {
            summaries.push_back({row.pattern, row.points, row.program, row.method});
            groups.emplace_back();
        }
        groups[index].push_back(&row);
    }
    for (std::size_t i = 0; i < summaries.size(); ++i) {
        ReconstructionSummary& summary = summaries[i];
        const auto median = [&](const std::string& light, auto figure) {
            return median_of(groups[i], light, figure);
        };
        summary.clean_mae_mm = median(kClean, &ReconstructionRow::depth_mae_mm);
        summary.mae_mm_100 = median("100", &ReconstructionRow::depth_mae_mm);
        summary.mae_mm_20 = median("20", &ReconstructionRow::depth_mae_mm);
        summary.mae_mm_3 = median("3", &ReconstructionRow::depth_mae_mm);
        summary.clean_iou_best = median(kClean, &ReconstructionRow::iou_best);
        summary.iou_best_3 = median("3", &ReconstructionRow::iou_best);
        summary.cpu_s = median("", &ReconstructionRow::cpu_s);
        summary.process_cpu_s = median("", &ReconstructionRow::process_cpu_s);
        summary.peak_mb = median("", &ReconstructionRow::peak_mb);
        for (const ReconstructionRow* row : groups[i]) {
            ++summary.of;
            if (row->reason.empty())
                ++summary.done;
            else if (summary.reason.empty())
                summary.reason = row->reason;
        }
    }
    return summaries;
}

}  // namespace apps
