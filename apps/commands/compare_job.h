// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/compare/compare.h"

#include <string>

namespace apps {

/// Scores file A against file B: a volume, mesh, point cloud or fit against a scene.json (its
/// ray-traced truth; for a fit, its objects), or a volume, mesh, point cloud or capture against
/// another.
///
/// metrics_path         METRICS.json to write; empty: none. A picture goes beside it when a volume
///                      or fit is scored against a scene.
/// fscore_threshold_m   distance that counts as a match for surfaces and clouds; volumes take their
///                      voxel diagonal
/// throws               core::Error when the two cannot be compared
nlos::Metrics compare_files(const std::string& a,
                            const std::string& b,
                            const std::string& metrics_path,
                            double fscore_threshold_m);

}  // namespace apps
