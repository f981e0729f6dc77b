// SPDX-License-Identifier: MIT
#include "calib/calibrate.h"
#include "renderer/core/settings/settings_json.h"

namespace calib {
namespace {

using core::Json;
using core::Vec3;

Json with_sigma(double value, double sigma) {
    return {{"value", value}, {"sigma", sigma}};
}

// FWHM in picoseconds of a standard deviation in path length.
double fwhm_ps(double sigma_m) {
    return sigma_m / core::sigma_m_from_fwhm_ps(1.0);
}

double ps(double opl_m) {
    return 1e12 * opl_m / core::kSpeedOfLight;
}

Json camera_json(const CameraCalibration& camera) {
    Json homography = Json::array();
    for (int r = 0; r < 3; ++r)
        homography.push_back(core::write_value(Vec3(camera.wall_from_pixel.row(r))));
    return {{"focal_px",
             {with_sigma(camera.focal_x_px, camera.sigma_px[0]),
              with_sigma(camera.focal_y_px, camera.sigma_px[1])}},
            {"center_px",
             {with_sigma(camera.center_x_px, camera.sigma_px[2]),
              with_sigma(camera.center_y_px, camera.sigma_px[3])}},
            {"radial", camera.radial},
            {"reprojection_rms_px", camera.reprojection_rms_px},
            {"wall_from_pixel", homography}};
}

}  // namespace

Json calibration_json(const Calibration& calibration) {
    const SetupGeometry& setup = calibration.setup;
    const auto value = [&](std::size_t i) { return with_sigma(setup.values[i], setup.sigma[i]); };
    Json json;
    json["wall"] = {{"point_m", {0.0, 0.0, 0.0}},
                    {"normal", {0.0, 0.0, 1.0}},
                    {"distance_m", value(0)},
                    {"tilt_x_rad", value(1)},
                    {"tilt_y_rad", value(2)}};
    json["device_m"] = core::write_value(setup.device_m);
    json["time_zero_m"] = value(6);
    json["galvo"] = {{"gain_x", value(7)},
                     {"gain_y", value(8)},
                     {"spin_rad", value(3)},
                     {"foot_m", {value(4), value(5)}}};
    json["points_m"] = Json::array();
    json["normals"] = Json::array();
    for (const Vec3& point : setup.points_m) {
        json["points_m"].push_back(core::write_value(point));
        json["normals"].push_back({0.0, 0.0, 1.0});
    }
    json["opl_offset_m"] = setup.opl_offset_m;
    json["sigma"] = {{"points_m", setup.point_sigma_m}, {"opl_offset_m", setup.opl_offset_sigma_m}};
    const DirectReturns& direct = calibration.direct;
    json["response"] = {{"jitter_fwhm_ps", fwhm_ps(direct.sigma_m)},
                        {"tail_ps", ps(direct.tail_m)},
                        {"sigma",
                         {{"jitter_fwhm_ps", fwhm_ps(direct.sigma_error_m)},
                          {"tail_ps", ps(direct.tail_error_m)}}}};
    json["ambient"] = with_sigma(direct.ambient, direct.ambient_error);
    json["deviance"] = direct.deviance;
    json["expected_deviance"] = direct.expected_deviance;
    const SetupVerdict& verdict = setup.verdict;
    json["range_rms_m"] = verdict.fit.length_rms_m;
    json["range_noise_m"] = verdict.fit.noise_rms_m;
    json["chi_square"] = verdict.fit.chi_square;
    json["degrees_of_freedom"] = verdict.fit.degrees_of_freedom;
    json["sigma_scale"] = verdict.sigma_scale;
    json["outliers"] = verdict.outliers;
    json["warnings"] = calibration.warnings();
    json["condition_number"] = setup.uncertainty.condition_number;
    json["unidentifiable"] = setup.uncertainty.unidentifiable;
    json["camera"] = calibration.camera ? camera_json(*calibration.camera) : Json();
    return json;
}

AppliedCalibration read_calibration(const std::string& path) {
    return applied_calibration(core::read_json_file(path), path);
}

AppliedCalibration applied_calibration(const Json& json, const std::string& where) {
    AppliedCalibration result;
    for (const char* key : {"points_m", "normals", "opl_offset_m", "response"}) {
        if (json.is_object() && json.contains(key)) continue;
        throw core::Error(where, std::string("has no ") + key, "must be what nlos calibrate wrote");
    }
    core::read_value(json["points_m"], where + ": points_m", result.points_m);
    core::read_value(json["normals"], where + ": normals", result.normals);
    core::read_value(json["opl_offset_m"], where + ": opl_offset_m", result.opl_offset_m);
    if (result.points_m.size() != result.normals.size() ||
        result.points_m.size() != result.opl_offset_m.size() || result.points_m.empty()) {
        throw core::Error(where, "has lists of different lengths", "must have one item per point");
    }
    const Json& response = json["response"];
    if (!response.is_object()) core::throw_wrong_type(where + ": response", response, "an object");
    for (const auto& [key, target] :
         {std::pair<const char*, double*>{"jitter_fwhm_ps", &result.response.jitter_fwhm_ps},
          std::pair<const char*, double*>{"tail_ps", &result.response.tail_ps}}) {
        if (response.contains(key)) {
            core::read_value(response[key], where + ": response." + key, *target);
        }
    }
    return result;
}

}  // namespace calib
