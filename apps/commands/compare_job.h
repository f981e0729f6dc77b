// SPDX-License-Identifier: MIT
#pragma once

#include "calib/compare_fit.h"
#include "nlos/compare/compare.h"
#include "nlos/layouts/capture_settings.h"
#include "nlos/pictures/panel.h"
#include "renderer/material/scene_geometry.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Scores, what casts doubt on them, and a picture of what they say.
struct Comparison {
    nlos::Metrics metrics;
    std::vector<std::string> warnings{};
    std::vector<nlos::Panel> panels{};  ///< of a volume or a fit against a scene
};

/// Distance that counts as a match of points, unless told otherwise [m].
inline constexpr double kDefaultThreshold_m = 0.01;

/// A geometry as one surface, sampled evenly to be compared with others.
core::PointCloud surface_samples(const renderer::SceneGeometry& geometry);

/// Scores a fit's poses and, beside them, its surfaces.
///
/// errors   of the fit, by calib::compare_fit()
nlos::Metrics score_fit(const calib::FitResult& fit,
                        const calib::FitErrors& errors,
                        double threshold_m);

/// Scores file A against file B: a volume, mesh, point cloud or fit against a scene.json (its
/// ray-traced truth; for a fit, its objects), or a volume, mesh, point cloud or capture against
/// another.
///
/// metrics_path         METRICS.json to write; empty: none. A picture goes beside it when a volume
///                      or fit is scored against a scene.
/// fscore_threshold_m   distance that counts as a match of points; nothing: 0.01 m for surfaces and
///                      clouds, the voxel diagonal for volumes
/// settings             how A is read when it is a capture
/// picture              where to write that picture in another format; empty: nowhere
/// throws               core::Error when the two cannot be compared, or have no picture to write
Comparison compare_files(const std::string& a,
                         const std::string& b,
                         const std::string& metrics_path,
                         std::optional<double> fscore_threshold_m = std::nullopt,
                         const nlos::CaptureReadSettings& settings = {},
                         const std::string& picture = "");

}  // namespace apps
