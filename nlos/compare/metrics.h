// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace nlos {

/// Scores of a result against the truth; empty where a score does not apply.
struct Metrics {
    std::optional<double> depth_mae_m;     ///< inside the true and the reconstructed mask
    std::optional<double> depth_median_m;  ///< of the absolute error
    std::optional<double> depth_rmse_m;
    std::optional<double> depth_coverage;   ///< fraction of the true area that these errors are of
    std::optional<double> mask_iou;         ///< foreground above 20 % of the maximum projection
    std::optional<double> mask_iou_stated;  ///< of the columns that the result gives a depth
    std::optional<double> mask_iou_best;    ///< at the threshold that suits the truth best
    std::optional<double> mask_iou_best_threshold;  ///< that threshold, of the maximum
    std::optional<double> normal_mae_deg;
    std::optional<double> normal_median_deg;
    std::optional<double> chamfer_m;
    std::optional<double> fscore;
    std::optional<double> completeness;  ///< fraction of the true surface that was found
    std::optional<double> accuracy;      ///< fraction of the found surface that is true
    std::optional<double> accuracy_m;    ///< mean distance of the found surface to the true one
    std::optional<double> fscore_threshold_m;  ///< of fscore, completeness and accuracy
    std::optional<double> fscore_10mm;         ///< at 10 mm, whatever the grid
    std::optional<double> fscore_resolution;   ///< at resolution_m, the same for all methods
    std::optional<double> resolution_m;        ///< how far apart the data tell positions
    std::optional<double> psnr_db;
    std::optional<double> ssim;
    std::optional<double> peak_distance_m;
    std::optional<double> position_error_m;
    std::optional<double> rotation_error_deg;
    std::optional<double> size_error;
    std::optional<double> albedo_error;
    std::optional<double> rel_l2;
    std::optional<double> rel_mse;
    std::optional<double> track_rmse_m;        ///< of the positions of named targets
    std::optional<double> track_median_m;      ///< of the same distances
    std::optional<double> track_coverage;      ///< fraction of true positions in 95 % ellipsoids
    std::optional<double> track_latency_s;     ///< from a target's appearance to its naming
    std::optional<double> track_false_alarms;  ///< fraction of frames that name too many targets
    std::optional<double> track_missed;        ///< fraction of true targets that were not named
    std::optional<double> seconds;
    std::optional<std::uint64_t> peak_rss_bytes;
};

/// Scores that choose with the truth at hand what nobody chooses without it: files keep them, and
/// nothing that people compare by shows them.
inline bool looks_at_truth(std::string_view name) {
    return name == "mask_iou_best" || name == "mask_iou_best_threshold";
}

template <class Visitor>
void for_each_field(Metrics& m, Visitor&& visit) {
    visit("depth_mae_m", m.depth_mae_m, "mean absolute depth error in both masks [m]");
    visit("depth_median_m", m.depth_median_m, "median absolute depth error [m]");
    visit("depth_rmse_m", m.depth_rmse_m, "root mean square depth error [m]");
    visit(
        "depth_coverage", m.depth_coverage, "fraction of the true area whose columns have a depth");
    visit("mask_iou", m.mask_iou, "intersection over union of the masks at 20 % of the maximum");
    visit("mask_iou_stated", m.mask_iou_stated, "the same of the columns that have a depth");
    visit("mask_iou_best", m.mask_iou_best, "the same at the threshold that suits the truth best");
    visit("mask_iou_best_threshold",
          m.mask_iou_best_threshold,
          "that threshold, as a fraction of the maximum");
    visit("normal_mae_deg", m.normal_mae_deg, "mean angle between normals [deg]");
    visit("normal_median_deg", m.normal_median_deg, "median angle between normals [deg]");
    visit("chamfer_m", m.chamfer_m, "mean of the two mean nearest-neighbour distances [m]");
    visit("fscore", m.fscore, "harmonic mean of completeness and accuracy");
    visit("completeness", m.completeness, "fraction of the true surface within the threshold");
    visit("accuracy", m.accuracy, "fraction of the found surface within the threshold");
    visit("accuracy_m", m.accuracy_m, "mean distance of the found surface to the true one [m]");
    visit("fscore_threshold_m", m.fscore_threshold_m, "distance that counts as a match [m]");
    visit("fscore_10mm", m.fscore_10mm, "F-score where 10 mm count as a match");
    visit("fscore_resolution",
          m.fscore_resolution,
          "F-score where the data's resolution counts as a match");
    visit("resolution_m", m.resolution_m, "how far apart the data tell positions [m]");
    visit("psnr_db", m.psnr_db, "of the maximum projection on [0, 1] [dB]");
    visit("ssim", m.ssim, "structural similarity of the maximum projection on [0, 1]");
    visit("peak_distance_m", m.peak_distance_m, "from the brightest voxel to the truth [m]");
    visit("position_error_m", m.position_error_m, "of a fitted object [m]");
    visit("rotation_error_deg", m.rotation_error_deg, "of a fitted object, modulo symmetry [deg]");
    visit("size_error", m.size_error, "relative, of a fitted object");
    visit("albedo_error", m.albedo_error, "relative, of a fitted object");
    visit("rel_l2", m.rel_l2, "relative L2 distance of two captures or volumes");
    visit("rel_mse", m.rel_mse, "mean square distance over mean square reference");
    visit("track_rmse_m", m.track_rmse_m, "root mean square error of tracked positions [m]");
    visit("track_median_m", m.track_median_m, "median distance of tracked positions [m]");
    visit("track_coverage", m.track_coverage, "fraction of true positions in the 95 % ellipsoids");
    visit("track_latency_s", m.track_latency_s, "from a target's appearance to its naming [s]");
    visit("track_false_alarms",
          m.track_false_alarms,
          "fraction of frames that name too many targets");
    visit("track_missed", m.track_missed, "fraction of true targets that were not named");
    visit("seconds", m.seconds, "time the result took [s]");
    visit("peak_rss_bytes", m.peak_rss_bytes, "memory the result took [bytes]");
}

}  // namespace nlos
