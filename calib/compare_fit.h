// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit.h"
#include "renderer/core/mesh.h"
#include "renderer/material/scene_geometry.h"

#include <optional>
#include <vector>

namespace calib {

/// How far a fit is from the true scene; the worst of its objects.
struct FitErrors {
    std::optional<double> position_m;    ///< of the surfaces' centres
    std::optional<double> rotation_deg;  ///< modulo the rotations that map the surface onto itself
    std::optional<double> size;          ///< relative
    std::optional<double> albedo;        ///< relative
    core::PointCloud fitted_points;      ///< samples of the fitted surfaces, for Chamfer distances
    core::PointCloud true_points;
};

/// Compares fitted objects and points with the scene's nodes of the same names.
///
/// fitted        geometry of the fit, posed
/// true_points   point scatterers of the truth, beside its surfaces
/// returns       positions alone for point scatterers: each to the nearest surface of the scene
/// throws        core::Error when no name agrees
FitErrors compare_fit(const FitResult& fit,
                      const renderer::SceneGeometry& fitted,
                      const renderer::SceneGeometry& truth,
                      const std::vector<FittedPoint>& true_points = {});

}  // namespace calib
