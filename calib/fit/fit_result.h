// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/fit_settings.h"
#include "calib/statistics/uncertainty.h"
#include "renderer/core/capture/capture.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <limits>
#include <string>
#include <vector>

namespace calib {

/// One standard deviation of something that was not free, or that the data do not determine.
inline constexpr double kFixed = 0.0;
inline constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// Where an object ended up; all values with one standard deviation beside them.
struct FittedObject {
    std::string name;
    core::Vec3 position_m = core::Vec3::Zero();                    ///< node origin, world
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< world from node
    double size = 1.0;                                             ///< relative to the model's
    double albedo = 1.0;
    std::vector<double> heights_m;  ///< of free vertices
    core::Vec3 position_sigma_m = core::Vec3::Zero();
    core::Vec3 rotation_sigma_deg = core::Vec3::Zero();  ///< about the world's axes
    double size_sigma = kFixed;
    double albedo_sigma = kFixed;
    std::vector<double> heights_sigma_m;
};

/// A small isotropic scatterer.
struct FittedPoint {
    core::Vec3 position_m = core::Vec3::Zero();
    double albedo = 0.0;  ///< albedo times area [m^2]
    core::Vec3 position_sigma_m = core::Vec3::Zero();
    double albedo_sigma = kFixed;
};

/// A number and its standard deviation.
struct Estimate {
    double value = 0.0;
    double sigma = kFixed;
};

/// What one start of several led to.
struct FitStart {
    std::string name;
    double cost = 0.0;
};

/// The fitted quantities.
struct FittedValues {
    std::vector<FittedObject> objects;
    std::vector<FittedPoint> points;
    Estimate scale{1.0};  ///< data per model radiance; 1 unless free
    Estimate time_zero_m;
    Estimate ambient;
    Estimate response_fwhm_ps;
    Estimate wall_bow_m;
    Estimate wall_scale{1.0};
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
