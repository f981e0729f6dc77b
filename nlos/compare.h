// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"
#include "renderer/core/capture.h"
#include "renderer/core/depth_map.h"
#include "renderer/core/mesh.h"

#include <cstdint>
#include <optional>

namespace nlos {

/// Scores of a result against the truth; empty where a score does not apply.
struct Metrics {
    std::optional<double> depth_mae_m;     ///< inside the true and the reconstructed mask
    std::optional<double> depth_median_m;  ///< of the absolute error
    std::optional<double> depth_rmse_m;
    std::optional<double> mask_iou;       ///< foreground above 20 % of the maximum projection
    std::optional<double> mask_iou_best;  ///< at the best threshold of the maximum projection
    std::optional<double> normal_mae_deg;
    std::optional<double> normal_median_deg;
    std::optional<double> chamfer_m;
    std::optional<double> fscore;
    std::optional<double> fscore_threshold_m;
    std::optional<double> psnr_db;
    std::optional<double> ssim;
    std::optional<double> peak_distance_m;
    std::optional<double> position_error_m;
    std::optional<double> rotation_error_deg;
    std::optional<double> size_error;
    std::optional<double> albedo_error;
    std::optional<double> rel_l2;
    std::optional<double> rel_mse;
    std::optional<double> seconds;
    std::optional<std::uint64_t> peak_rss_bytes;
};

template <class Visitor>
void for_each_field(Metrics& m, Visitor&& visit) {
    visit("depth_mae_m", m.depth_mae_m, "mean absolute depth error in both masks [m]");
    visit("depth_median_m", m.depth_median_m, "median absolute depth error [m]");
    visit("depth_rmse_m", m.depth_rmse_m, "root mean square depth error [m]");
    visit("mask_iou", m.mask_iou, "intersection over union of the masks at 20 % of the maximum");
    visit("mask_iou_best", m.mask_iou_best, "the same at the best threshold");
    visit("normal_mae_deg", m.normal_mae_deg, "mean angle between normals [deg]");
    visit("normal_median_deg", m.normal_median_deg, "median angle between normals [deg]");
    visit("chamfer_m", m.chamfer_m, "mean of the two mean nearest-neighbour distances [m]");
    visit("fscore", m.fscore, "harmonic mean of precision and recall at the threshold");
    visit("fscore_threshold_m", m.fscore_threshold_m, "distance that counts as a match [m]");
    visit("psnr_db", m.psnr_db, "of the maximum projection on [0, 1] [dB]");
    visit("ssim", m.ssim, "structural similarity of the maximum projection on [0, 1]");
    visit("peak_distance_m", m.peak_distance_m, "from the brightest voxel to the truth [m]");
    visit("position_error_m", m.position_error_m, "of a fitted object [m]");
    visit("rotation_error_deg", m.rotation_error_deg, "of a fitted object, modulo symmetry [deg]");
    visit("size_error", m.size_error, "relative, of a fitted object");
    visit("albedo_error", m.albedo_error, "relative, of a fitted object");
    visit("rel_l2", m.rel_l2, "relative L2 distance of two captures or volumes");
    visit("rel_mse", m.rel_mse, "mean square distance over mean square reference");
    visit("seconds", m.seconds, "time the result took [s]");
    visit("peak_rss_bytes", m.peak_rss_bytes, "memory the result took [bytes]");
}

/// Scores a reconstructed volume against the scene's depth map.
///
/// Masks: the true one is the truth's foreground, the reconstructed one the columns whose maximum
/// projection exceeds 20 % of its maximum. Depth and normal errors are taken where both masks and
/// `result.depth` have a value. The true image is the albedo seen (1 when unknown), divided by its
/// maximum; the surface samples are the truth's foreground columns; a match is a voxel diagonal.
///
/// result   volume with depth and points; its normals, if any, point towards the wall
/// truth    what the wall's orthographic view sees at exactly the volume's (x, y) columns
/// returns  no value for a score that lacks its data: an empty mask, no points, no positive voxel
/// throws   core::Error when the columns or the walls differ
Metrics compare_to_truth(const Reconstruction& result, const core::DepthMap& truth);

/// Scores surface points against surface samples of the truth (Chamfer, F-score, normals).
///
/// result, truth  points in the same frame; normals are compared at nearest neighbours,
///                whichever side they point to
/// threshold_m    distance that counts as a match [m]
/// returns        no score when either has no point
/// source         F-score [Knapitsch2017]
Metrics compare_points(const core::PointCloud& result,
                       const core::PointCloud& truth,
                       double threshold_m);

/// Scores one volume against another on the same grid: projections, depths, points, voxels.
///
/// Both masks are at 20 % of their own maximum; peak_distance_m is the distance of the two
/// brightest voxels; rel_l2 and rel_mse compare the voxels as they are, without scaling.
///
/// throws    core::Error when the grids or the walls differ
Metrics compare_volumes(const Reconstruction& result, const Reconstruction& reference);

/// Relative differences of two captures; rel_l2 = |a-b|/|b|, rel_mse its square. Pairs are those of
/// the same wall points, in whatever order they stand; where the points differ, those of one index.
///
/// throws    core::Error when shapes, units or time axes differ
Metrics compare_captures(const core::Capture& result, const core::Capture& reference);

}  // namespace nlos
