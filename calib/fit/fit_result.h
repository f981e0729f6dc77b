// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/fit_settings.h"
#include "calib/model/fitted_values.h"
#include "calib/statistics/uncertainty.h"
#include "renderer/core/capture/capture.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <string>
#include <vector>

namespace calib {

/// What one start of several led to.
struct FitStart {
    std::string name;
    double cost = 0.0;
};

/// The fitted quantities.
struct FittedValues {
    std::vector<FittedObject> objects;
    std::vector<FittedPoint> points;
    Estimates estimates;               ///< of the scene as a whole: "scale" is data per radiance
    renderer::SceneGeometry geometry;  ///< the fitted scene
};

/// The fitted model beside the data.
struct FitAgreement {
    core::TimeAxis axis;          ///< of data and model
    std::vector<double> data;     ///< [pair][bin]
    std::vector<double> model;    ///< 0 where nothing was observed, as the data
    core::ObservedBins observed;  ///< of both
    std::string residual;         ///< poisson or least_squares
    double deviance = 0.0;
    double expected_deviance = 0.0;
    double expected_deviance_sigma = 0.0;

    std::size_t num_observed() const {
        return core::observed_count(
            observed, data.size() / static_cast<std::size_t>(axis.num_bins), axis.num_bins);
    }
};

/// How the solver got there.
struct FitCourse {
    int iterations = 0;
    double seconds = 0.0;
    bool converged = false;
    std::string message;
    std::vector<FitStart> starts;
    std::size_t num_elements = 0;
};

/// What fit_scene() found.
///
/// Uncertainties are those of `parameters`; of the logarithms of sizes, albedos and widths.
struct FitResult : FittedValues, FitAgreement, FitCourse, Uncertainty {
    std::vector<std::string> parameters;  ///< names of the free ones
    std::vector<std::string> warnings;
};

/// What is fitted to what.
struct FitInput {
    core::Capture capture;
    renderer::SceneDescription scene;  ///< its wall albedo counts; the capture's points do
    renderer::SceneGeometry geometry;
    FitSettings settings;
    std::vector<double> offset_m;  ///< per pair, path length beside that between wall points; or {}
    std::vector<core::Vec3> start_points;  ///< surface points of a reconstruction; or {}
};

}  // namespace calib
