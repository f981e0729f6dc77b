// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// How well one method reconstructs at one noise level; means over the seeds.
struct NoiseScore {
    double peak_counts = 0.0;
    double depth_mae_m = 0.0;
    double mask_iou = 0.0;
    double mask_iou_best = 0.0;
};

template <class Visitor>
void for_each_field(NoiseScore& score, Visitor&& visit) {
    visit("peak_counts", score.peak_counts, "expected counts in the brightest bin");
    visit("depth_mae_m", score.depth_mae_m, "mean absolute depth error [m]");
    visit("mask_iou", score.mask_iou, "overlap of the masks at 20 % of the maximum");
    visit("mask_iou_best", score.mask_iou_best, "the same at the best threshold");
}

struct NoiseCurve {
    std::string method;
    std::vector<NoiseScore> scores;
};

template <class Visitor>
void for_each_field(NoiseCurve& curve, Visitor&& visit) {
    visit("method", curve.method, "method and prior");
    visit("scores", curve.scores, "by rising light");
}

/// The Wiener filter's ratio chosen from the data against the best of a search.
struct SnrSearch {
    double peak_counts = 0.0;
    double snr = 0.0;
    double depth_mae_m = 0.0;
    double mask_iou_best = 0.0;
    double best_mae_snr = 0.0;
    double best_depth_mae_m = 0.0;
    double best_iou_snr = 0.0;
    double best_mask_iou_best = 0.0;
};

template <class Visitor>
void for_each_field(SnrSearch& search, Visitor&& visit) {
    visit("peak_counts", search.peak_counts, "expected counts in the brightest bin");
    visit("snr", search.snr, "chosen from the data");
    visit("depth_mae_m", search.depth_mae_m, "depth error with it [m]");
    visit("mask_iou_best", search.mask_iou_best, "overlap with it");
    visit("best_mae_snr", search.best_mae_snr, "of those tried, the one of least depth error");
    visit("best_depth_mae_m", search.best_depth_mae_m, "depth error with that [m]");
    visit("best_iou_snr", search.best_iou_snr, "of those tried, the one of largest overlap");
    visit("best_mask_iou_best", search.best_mask_iou_best, "overlap with that");
}

struct NoiseBench {
    std::string scene;
    int repeats = 1;
    std::vector<NoiseCurve> curves;
    std::vector<SnrSearch> searches;
};

template <class Visitor>
void for_each_field(NoiseBench& bench, Visitor&& visit) {
    visit("scene", bench.scene, "scene file");
    visit("repeats", bench.repeats, "seeds per figure");
    visit("curves", bench.curves, "every method");
    visit("searches", bench.searches, "regularisation of lct");
}

/// Reconstructs a scene from 1 to 1000 counts in the brightest bin by every method, each with the
/// settings it chooses itself, and scores it against the truth.
///
/// scene_path   of a confocal scan of a planar grid
/// repeats      seeds per figure
NoiseBench bench_noise(const std::string& scene_path, int repeats, const core::Progress& progress);

/// Tables and plots of it.
BenchResult noise_result(const NoiseBench& bench);

}  // namespace apps
