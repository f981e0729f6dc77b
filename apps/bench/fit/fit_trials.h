// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit.h"
#include "calib/forward/forward_model.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Rigid motion of a trial's rectangle from its place in the model.
struct TrialPose {
    core::Vec3 position_m{0.0, 0.0, 0.8};
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// The standard fitting problem: a rectangle of 0.4 m x 0.3 m before a 16 x 16 confocal scan of 1
/// m, response 94 ps, 292 bins of 32 ps, as much ambient light as signal.
struct TrialSetup {
    double photons = 1e5;
    std::vector<double> blur_schedule_m{0.12, 0.04, 0.0};
    std::string start = "given";
    std::optional<double> element_tolerance;
    calib::ResidualKind residual = calib::ResidualKind::Poisson;
};

/// The rectangle as a mesh of cells in the plane z = 0 of its node, which is at `pose`.
renderer::Object trial_rectangle(const TrialPose& pose, int cells_x, int cells_y);

core::WallScan trial_scan();
core::TimeAxis trial_axis();
inline constexpr double kTrialFwhm_ps = 94.0;  // of the response

/// Tilted by 25 degrees at 0.8 m.
TrialPose standard_pose();
/// Up to 0.2 m and 35 degrees from facing the wall, any spin.
TrialPose random_pose(std::uint64_t seed);
/// `pose` displaced by a length and an angle in random directions.
TrialPose displaced(const TrialPose& pose, double distance_m, double angle_deg, std::uint64_t seed);

/// The light of a trial after the response, and counts that a detector records of light.
core::Capture expected_light(const TrialPose& truth);
core::Capture expected_light(const renderer::Object& truth);
/// jitter_fwhm_ps   response that the light has not gone through yet; 0: none
core::Capture counted_capture(const TrialSetup& setup,
                              const core::Capture& light,
                              double jitter_fwhm_ps,
                              std::uint64_t seed);

/// A fit of the rectangle to a capture, started from `start`.
calib::FitInput trial_input(const TrialSetup& setup,
                            const core::Capture& capture,
                            const TrialPose& start);

/// How far a fit is off, modulo the rectangle's symmetry.
struct TrialError {
    double lateral_m = 0.0;  ///< across the wall's normal, both directions together
    double depth_m = 0.0;    ///< along it
    double spin_deg = 0.0;   ///< about the rectangle's normal
    double tilt_deg = 0.0;   ///< of that normal, both directions together
    core::Vec3 position_m;   ///< fitted minus true
    core::Vec3 turn_deg;     ///< about the world's axes
    double distance_m() const { return position_m.norm(); }
    double angle_deg() const { return turn_deg.norm(); }
};
TrialError trial_error(const calib::FitResult& fit, const TrialPose& truth);

}  // namespace apps
