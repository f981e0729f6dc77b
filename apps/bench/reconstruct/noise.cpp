// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/scene.h"
#include "apps/commands.h"
#include "apps/scene_truth.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/reconstruct.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

namespace apps {
namespace {

/// How well one method reconstructs at one noise level; means over the seeds.
struct NoiseScore {
    double peak_counts = 0.0;    ///< expected counts in the brightest bin
    double depth_mae_m = 0.0;    ///< mean absolute depth error [m]
    double mask_iou = 0.0;       ///< overlap of the masks at 20 % of the maximum
    double mask_iou_best = 0.0;  ///< the same at the best threshold
};
NLOS_FIGURES(NoiseScore, peak_counts, depth_mae_m, mask_iou, mask_iou_best);

struct NoiseCurve {
    std::string method;              ///< method and prior
    std::vector<NoiseScore> scores;  ///< by rising light
};
NLOS_FIGURES(NoiseCurve, method, scores);

/// The Wiener filter's ratio chosen from the data against the best of a search.
struct SnrSearch {
    double peak_counts = 0.0;         ///< expected counts in the brightest bin
    double snr = 0.0;                 ///< chosen from the data
    double depth_mae_m = 0.0;         ///< depth error with it [m]
    double mask_iou_best = 0.0;       ///< overlap with it
    double best_mae_snr = 0.0;        ///< of those tried, the one of least depth error
    double best_depth_mae_m = 0.0;    ///< depth error with that [m]
    double best_iou_snr = 0.0;        ///< of those tried, the one of largest overlap
    double best_mask_iou_best = 0.0;  ///< overlap with that
};
NLOS_FIGURES(SnrSearch,
             peak_counts,
             snr,
             depth_mae_m,
             mask_iou_best,
             best_mae_snr,
             best_depth_mae_m,
             best_iou_snr,
             best_mask_iou_best);

struct NoiseBench {
    std::string scene;                ///< scene file
    int repeats = 1;                  ///< seeds per figure
    std::vector<NoiseCurve> curves;   ///< every method
    std::vector<SnrSearch> searches;  ///< regularisation of lct
};
NLOS_FIGURES(NoiseBench, scene, repeats, curves, searches);

/// What `nlos bench noise` is to measure.
struct NoiseBenchSettings {
    std::string scene = "scenes/bars/scene.json";  ///< a confocal scan of a planar grid
    int repeats = 1;                               ///< seeds per figure
};

constexpr std::array kPeaks{1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
constexpr std::array kSnrs{0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0};

constexpr std::array kMethods{"lct", "solver", "dlct", "fk", "phasor", "fbp", "bp"};

/// One scene's clean capture, its noisy versions, and the truth to score against.
class Range {
 public:
    explicit Range(const std::string& scene_path)
        : truth_(scene_path), clean_(render(scene_path)) {}

    core::Capture noisy(double peak_counts, int seed) const {
        nlos::DetectorSettings settings;
        settings.photons = photons_for_peak(clean_, peak_counts);
        settings.seed = static_cast<std::uint64_t>(seed);
        return nlos::detect(clean_, settings);
    }

    /// Adds 1/repeats of a reconstruction's scores; returns the ratio it chose, if it has one.
    double add_scores(const core::Capture& capture,
                      const std::vector<std::string>& overrides,
                      int repeats,
                      NoiseScore& score) const {
        nlos::ReconstructSettings settings;
        for (const std::string& text : overrides) core::apply_override(settings, text);
        const nlos::Reconstruction result = nlos::reconstruct(capture, settings, {});
        const nlos::VolumeAxes& axes = result.volume.axes;
        const nlos::Metrics metrics = nlos::compare_to_truth(
            result, truth_.depth_map(axes.world_from_wall, axes.x_m, axes.y_m));
        constexpr double kNothingFound_m = 1.0;
        score.depth_mae_m += metrics.depth_mae_m.value_or(kNothingFound_m) / repeats;
        score.mask_iou += metrics.mask_iou.value_or(0.0) / repeats;
        score.mask_iou_best += metrics.mask_iou_best.value_or(0.0) / repeats;
        return result.settings.snr.value_or(0.0);
    }

 private:
    static core::Capture render(const std::string& scene_path) {
        const BenchScene scene(scene_path);
        return scene.render(scene.settings());
    }

    SceneTruth truth_;
    core::Capture clean_;
};

/// Means over the seeds, and over the ratios that were chosen.
std::pair<NoiseScore, double> score_at(const Range& range,
                                       double peak_counts,
                                       const std::vector<std::string>& overrides,
                                       int repeats) {
    NoiseScore score;
    score.peak_counts = peak_counts;
    double snr = 0.0;
    for (int seed = 0; seed < repeats; ++seed) {
        const core::Capture capture = range.noisy(peak_counts, seed);
        snr += range.add_scores(capture, overrides, repeats, score) / repeats;
    }
    return {score, snr};
}

SnrSearch search_snr(const Range& range, double peak_counts, int repeats) {
    const auto [chosen, snr] = score_at(range, peak_counts, {"method=lct"}, repeats);
    SnrSearch search{peak_counts, snr, chosen.depth_mae_m, chosen.mask_iou_best, 0, 0, 0, 0};
    search.best_depth_mae_m = std::numeric_limits<double>::max();
    for (const double candidate : kSnrs) {
        const std::vector<std::string> overrides{"method=lct", fmt::format("snr={}", candidate)};
        const NoiseScore score = score_at(range, peak_counts, overrides, repeats).first;
        if (score.depth_mae_m < search.best_depth_mae_m) {
            search.best_depth_mae_m = score.depth_mae_m;
            search.best_mae_snr = candidate;
        }
        if (score.mask_iou_best > search.best_mask_iou_best) {
            search.best_mask_iou_best = score.mask_iou_best;
            search.best_iou_snr = candidate;
        }
    }
    return search;
}

Plot plot_of(const NoiseBench& bench, const std::string& title, double NoiseScore::*value) {
    Plot plot{title + ", " + bench.scene, "counts in the brightest bin", title, {}};
    for (const NoiseCurve& curve : bench.curves) {
        plot.lines.push_back(line_of(curve.method, curve.scores, &NoiseScore::peak_counts, value));
    }
    return plot;
}

/// Reconstructs a scene from 1 to 1000 counts in the brightest bin by every method, each with the
/// settings it chooses itself, and scores it against the truth.
BenchResult measure_noise(const NoiseBenchSettings& settings, const core::Progress& progress) {
    const Range range(settings.scene);
    const int repeats = settings.repeats;
    NoiseBench bench{settings.scene, repeats, {}, {}};
    for (const std::string method : kMethods) {
        NoiseCurve& curve = bench.curves.emplace_back(NoiseCurve{method, {}});
        for (const double peak : kPeaks) {
            if (progress.should_stop()) throw core::Failure("bench", "interrupted");
            curve.scores.push_back(score_at(range, peak, {"method=" + method}, repeats).first);
        }
        progress.update(static_cast<double>(bench.curves.size()) / (kMethods.size() + 1), method);
    }
    for (const double peak : kPeaks) {
        if (progress.should_stop()) throw core::Failure("bench", "interrupted");
        bench.searches.push_back(search_snr(range, peak, repeats));
    }
    return {
        core::write_value(bench),
        {{"_depth", plot_of(bench, "mean absolute depth error [m]", &NoiseScore::depth_mae_m)},
         {"_mask", plot_of(bench, "mask IoU at the best threshold", &NoiseScore::mask_iou_best)}},
        {}};
}

void declare(CLI::App& command, NoiseBenchSettings& settings) {
    add_setting(command, "--scene", settings.scene, "Scene description")->type_name("FILE");
    add_setting(command, "--repeats", settings.repeats, "Seeds per figure", {1, 1000});
}

}  // namespace

void add_bench_noise_command(CLI::App& bench) {
    add_benchmark<NoiseBenchSettings>(bench,
                                      {"noise",
                                       "Every reconstruction method against the number of photons",
                                       "nlos bench noise -o out/bench"},
                                      declare,
                                      measure_noise);
}

}  // namespace apps
