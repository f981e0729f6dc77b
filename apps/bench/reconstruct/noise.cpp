// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/reconstruct/reconstruct_trials.h"
#include "apps/bench/scene.h"
#include "apps/scene_truth.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/methods/methods.h"
#include "renderer/core/settings/settings_json.h"

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

/// What `nlos bench noise` is to measure.
struct NoiseBenchSettings {
    std::string scene = "scenes/bars/scene.json";  ///< a confocal scan of a planar grid
    int repeats = 1;                               ///< seeds per figure
};

constexpr std::array kPeaks{1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
constexpr std::array kSnrs{0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0};

/// One scene's clean capture, its noisy versions, and the truth to score against.
class Range {
 public:
    explicit Range(const std::string& scene_path)
        : truth_(scene_path), clean_(BenchScene(scene_path).render()) {}

    core::Capture noisy(double peak_counts, int seed) const {
        nlos::DetectorSettings settings;
        settings.photons = photons_for_peak(clean_, peak_counts);
        settings.seed = static_cast<std::uint64_t>(seed);
        return nlos::detect(clean_, settings);
    }

    /// Adds 1/repeats of a reconstruction's scores; returns the ratio it chose, if it has one.
    double add_scores(const core::Capture& capture,
                      const Overrides& overrides,
                      int repeats,
                      NoiseScore& score) const {
        const nlos::Reconstruction result = run_reconstruction(capture, overrides).result;
        const nlos::Metrics metrics =
            nlos::compare_to_truth(result, truth_.surface(result.volume.axes));
        constexpr double kNothingFound_m = 1.0;
        score.depth_mae_m += metrics.depth_mae_m.value_or(kNothingFound_m) / repeats;
        score.mask_iou += metrics.mask_iou.value_or(0.0) / repeats;
        score.mask_iou_best += metrics.mask_iou_best.value_or(0.0) / repeats;
        return result.settings.snr.value_or(0.0);
    }

 private:
    SceneTruth truth_;
    core::Capture clean_;
};

/// Means over the seeds, and over the ratios that were chosen.
std::pair<NoiseScore, double> score_at(const Range& range,
                                       double peak_counts,
                                       const Overrides& overrides,
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

/// The Wiener filter's ratio chosen from the data against the best of a search: those of least
/// depth error and of largest overlap.
core::Json search_snr(const Range& range, double peak_counts, int repeats) {
    const auto [chosen, snr] = score_at(range, peak_counts, {"method=lct"}, repeats);
    NoiseScore best{peak_counts, std::numeric_limits<double>::max(), 0.0, 0.0};
    double best_mae_snr = 0.0;
    double best_iou_snr = 0.0;
    for (const double candidate : kSnrs) {
        const Overrides overrides{"method=lct", fmt::format("snr={}", candidate)};
        const NoiseScore score = score_at(range, peak_counts, overrides, repeats).first;
        if (score.depth_mae_m < best.depth_mae_m) {
            best.depth_mae_m = score.depth_mae_m;
            best_mae_snr = candidate;
        }
        if (score.mask_iou_best > best.mask_iou_best) {
            best.mask_iou_best = score.mask_iou_best;
            best_iou_snr = candidate;
        }
    }
    return {{"peak_counts", peak_counts},
            {"snr", snr},
            {"depth_mae_m", chosen.depth_mae_m},
            {"mask_iou_best", chosen.mask_iou_best},
            {"best_mae_snr", best_mae_snr},
            {"best_depth_mae_m", best.depth_mae_m},
            {"best_iou_snr", best_iou_snr},
            {"best_mask_iou_best", best.mask_iou_best}};
}

nlos::Plot plot_of(const std::vector<NoiseCurve>& curves,
                   const std::string& scene,
                   const std::string& title,
                   double NoiseScore::*value) {
    nlos::Plot plot{title + ", " + scene, "counts in the brightest bin", title, {}};
    for (const NoiseCurve& curve : curves) {
        plot.lines.push_back(
            nlos::line_of(curve.method, curve.scores, &NoiseScore::peak_counts, value));
    }
    return plot;
}

/// Reconstructs a scene from 1 to 1000 counts in the brightest bin by every method, each with the
/// settings it chooses itself, and scores it against the truth.
BenchResult measure_noise(const NoiseBenchSettings& settings, const core::Progress& progress) {
    const Range range(settings.scene);
    const int repeats = settings.repeats;
    std::vector<NoiseCurve> curves;
    for (const nlos::MethodTraits* traits : nlos::kMethods) {
        const std::string method(core::enum_name(traits->method));
        NoiseCurve& curve = curves.emplace_back(NoiseCurve{method, {}});
        for (const double peak : kPeaks) {
            progress.update(fraction_of(curves.size() - 1, nlos::kMethods.size() + 1), method);
            curve.scores.push_back(score_at(range, peak, {"method=" + method}, repeats).first);
        }
    }
    core::Json searches = core::Json::array();
    for (const double peak : kPeaks) {
        progress.update(fraction_of(nlos::kMethods.size(), nlos::kMethods.size() + 1),
                        "snr of lct");
        searches.push_back(search_snr(range, peak, repeats));
    }
    const auto plot = [&](const std::string& title, double NoiseScore::*value) {
        return plot_of(curves, settings.scene, title, value);
    };
    return {{{"scene", settings.scene},
             {"repeats", repeats},  // seeds per figure
             {"curves", core::write_value(curves)},
             {"searches", searches}},
            {{"_depth", plot("mean absolute depth error [m]", &NoiseScore::depth_mae_m)},
             {"_mask", plot("mask IoU at the best threshold", &NoiseScore::mask_iou_best)}},
            {}};
}

void declare_noise_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_noise);
    add_setting(command, "--scene", settings.scene, "Scene description")->type_name("FILE");
    add_setting(command, "--repeats", settings.repeats, "Seeds per figure", {1, 1000});
}

}  // namespace

extern const CommandRow kNoiseBench{"noise",
                                    "Every reconstruction method against the number of photons",
                                    "nlos bench noise -o out/bench",
                                    declare_noise_bench};

}  // namespace apps
