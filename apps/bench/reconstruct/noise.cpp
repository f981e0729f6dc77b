// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/noise.h"

#include "apps/bench/scene.h"
#include "apps/scene_truth.h"
#include "nlos/compare/compare.h"
#include "nlos/detector/detector.h"
#include "nlos/reconstruct.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

namespace apps {
namespace {

constexpr std::array kPeaks{1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0};
constexpr std::array kSnrs{0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0};

struct Contender {
    const char* name;
    std::vector<std::string> overrides;
};

std::vector<Contender> contenders() {
    return {{"lct", {"method=lct"}},
            {"solver", {"method=solver"}},
            {"dlct", {"method=dlct"}},
            {"fk", {"method=fk"}},
            {"phasor", {"method=phasor"}},
            {"fbp", {"method=fbp"}},
            {"bp", {"method=bp"}}};
}

/// One scene's clean capture, its noisy versions, and the truth to score against.
class Range {
 public:
    explicit Range(const std::string& scene_path) : truth_(scene_path), clean_(render(scene_path)) {
        const auto values = clean_.transient.values();
        const double sum = std::accumulate(values.begin(), values.end(), 0.0);
        photons_per_peak_ = sum / static_cast<double>(*std::ranges::max_element(values));
    }

    core::Capture noisy(double peak_counts, int seed) const {
        nlos::DetectorSettings settings;
        settings.photons = peak_counts * photons_per_peak_;
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
    double photons_per_peak_ = 0.0;
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
        PlotLine& line = plot.lines.emplace_back();
        line.title = curve.method;
        for (const NoiseScore& score : curve.scores) {
            line.x.push_back(score.peak_counts);
            line.y.push_back(score.*value);
        }
    }
    return plot;
}

}  // namespace

BenchResult measure_noise(const NoiseBenchSettings& settings, const core::Progress& progress) {
    const Range range(settings.scene);
    const int repeats = settings.repeats;
    NoiseBench bench{settings.scene, repeats, {}, {}};
    const std::vector<Contender> all = contenders();
    const auto stages = static_cast<double>(all.size() + 1);
    for (const Contender& contender : all) {
        NoiseCurve& curve = bench.curves.emplace_back();
        curve.method = contender.name;
        for (const double peak : kPeaks) {
            if (progress.should_stop()) throw core::Failure("bench", "interrupted");
            curve.scores.push_back(score_at(range, peak, contender.overrides, repeats).first);
        }
        progress.update(static_cast<double>(bench.curves.size()) / stages, contender.name);
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

}  // namespace apps
