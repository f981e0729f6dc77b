// SPDX-License-Identifier: MIT
#include "apps/bench/fit/fit_trials.h"

#include "nlos/detector/detector.h"
#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

using core::Vec3;

constexpr double kWidth_m = 0.4;
constexpr double kHeight_m = 0.3;

Vec3 random_direction(core::Rng& rng) {
    return core::sample_sphere({1.0 - rng.uniform(), rng.uniform()});
}

Eigen::Quaterniond turn(double angle, const Vec3& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

}  // namespace

renderer::Object trial_rectangle(const TrialPose& pose, int cells_x, int cells_y) {
    renderer::Object object;
    object.name = "target";
    object.material.albedo = 0.5;
    object.world_from_node.linear() = pose.rotation.toRotationMatrix();
    object.world_from_node.translation() = pose.position_m;
    for (int j = 0; j <= cells_y; ++j) {
        for (int i = 0; i <= cells_x; ++i) {
            const Vec3 p(kWidth_m * (static_cast<double>(i) / cells_x - 0.5),
                         kHeight_m * (static_cast<double>(j) / cells_y - 0.5),
                         0.0);
            object.mesh.vertices.push_back(object.world_from_node * p);
        }
    }
    const auto index = [&](int i, int j) {
        return static_cast<std::uint32_t>(j * (cells_x + 1) + i);
    };
    for (int j = 0; j < cells_y; ++j) {
        for (int i = 0; i < cells_x; ++i) {
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    }
    return object;
}

core::WallScan trial_scan() {
    constexpr int kPoints = 16;
    renderer::SceneDescription description;
    description.scan.sensing_points = {kPoints, kPoints};
    return renderer::make_scan(description).wall();
}

core::TimeAxis trial_axis() {
    return {0.7, core::opl_from_seconds(32e-12), 292};
}

TrialPose standard_pose() {
    TrialPose pose;
    pose.rotation = turn(25.0 / core::kDegreesPerRadian, Vec3(0.6, 0.8, 0.0));
    return pose;
}

TrialPose random_pose(std::uint64_t seed) {
    core::Rng rng(seed, 1, 0);
    const auto symmetric = [&] { return 2.0 * rng.uniform() - 1.0; };
    TrialPose pose;
    pose.position_m = {0.2 * symmetric(), 0.2 * symmetric(), 0.8 + 0.2 * symmetric()};
    const double azimuth = core::kPi * symmetric();
    const double tilt = 35.0 / core::kDegreesPerRadian * std::sqrt(rng.uniform());
    pose.rotation = turn(tilt, Vec3(std::cos(azimuth), std::sin(azimuth), 0.0)) *
                    turn(core::kPi * symmetric(), Vec3::UnitZ());
    return pose;
}

TrialPose displaced(const TrialPose& pose,
                    double distance_m,
                    double angle_deg,
                    std::uint64_t seed) {
    core::Rng rng(seed, 2, 0);
    TrialPose moved = pose;
    moved.position_m += distance_m * random_direction(rng);
    moved.position_m.z() = std::max(moved.position_m.z(), 0.15);
    moved.rotation =
        turn(angle_deg / core::kDegreesPerRadian, random_direction(rng)) * pose.rotation;
    return moved;
}

core::Capture expected_light(const TrialPose& truth) {
    return expected_light(trial_rectangle(truth, 12, 9));  // the model's has one cell
}

core::Capture expected_light(const renderer::Object& truth) {
    core::Capture capture;
    capture.scan = trial_scan();
    capture.time_axis = trial_axis();
    capture.transient = core::Transient(capture.scan.num_pairs(), capture.time_axis.num_bins);
    renderer::SceneGeometry geometry;
    geometry.objects = {truth};
    calib::FitSettings settings;
    settings.free.objects = {{"target", {"translation"}}};
    const calib::SceneModel model(geometry, settings);
    calib::ForwardSettings forward;
    forward.axis = capture.time_axis;
    forward.sigma_m = core::sigma_m_from_fwhm_ps(kTrialFwhm_ps);
    forward.offset_m.assign(capture.scan.num_pairs(), 0.0);
    forward.tolerance = 1e-3;
    forward.radiance_factor = std::pow(core::kPi, -3.0);
    const core::WallScan& scan = capture.scan.wall();
    calib::ForwardModel light(model, scan, calib::WallMotion(scan), forward);
    const calib::SceneState state = calib::without_added_light(model.start());
    light.refresh(state);
    light.update(state, renderer::Gradients::Without);

    const auto bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    std::vector<double> expected(capture.scan.num_pairs() * bins);
    core::parallel_for(capture.scan.num_pairs(), [&](std::size_t pair) {
        calib::PairModel result;
        light.evaluate(pair, result);
        std::copy(result.mean.begin(),
                  result.mean.end(),
                  expected.begin() + static_cast<std::ptrdiff_t>(pair * bins));
    });
    std::transform(
        expected.begin(), expected.end(), capture.transient.values().begin(), [](double value) {
            return static_cast<float>(std::max(0.0, value));
        });
    return capture;
}

core::Capture counted_capture(const TrialSetup& setup,
                              const core::Capture& light,
                              double jitter_fwhm_ps,
                              std::uint64_t seed) {
    nlos::DetectorSettings detector;
    detector.photons = setup.photons;
    detector.response.jitter_fwhm_ps = jitter_fwhm_ps;
    detector.ambient = setup.photons / static_cast<double>(light.transient.values().size());
    detector.seed = seed;
    return nlos::detect(light, detector);
}

calib::FitInput trial_input(const TrialSetup& setup,
                            const core::Capture& capture,
                            const TrialPose& start) {
    calib::FitInput input;
    input.capture = capture;
    input.geometry.objects = {trial_rectangle(start, 1, 1)};
    calib::FitSettings& settings = input.settings;
    settings.scene = "trial";
    settings.free.objects = {{"target", {"pose", "albedo"}}};
    settings.response.jitter_fwhm_ps = kTrialFwhm_ps;
    settings.blur_schedule_m = setup.blur_schedule_m;
    settings.start = setup.start;
    settings.element_tolerance = setup.element_tolerance;
    settings.residual = setup.residual;
    return input;
}

TrialError trial_error(const calib::FitResult& fit, const TrialPose& truth) {
    const calib::FittedObject& object = fit.objects.front();
    TrialError error;
    error.position_m = object.position_m - truth.position_m;
    error.depth_m = std::abs(error.position_m.z());
    error.lateral_m = error.position_m.head<2>().norm();
    double best = 10.0;
    for (const Vec3& axis : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        const Eigen::Quaterniond half =
            axis.isZero() ? Eigen::Quaterniond::Identity() : turn(core::kPi, axis);
        const Eigen::AngleAxisd difference(object.rotation * half * truth.rotation.inverse());
        const double angle = std::min(difference.angle(), 2.0 * core::kPi - difference.angle());
        if (angle >= best) continue;
        best = angle;
        const double sign = difference.angle() > core::kPi ? -1.0 : 1.0;
        error.turn_deg = core::kDegreesPerRadian * angle * sign * difference.axis();
    }
    const Vec3 normal = truth.rotation * Vec3::UnitZ();
    error.spin_deg = std::abs(normal.dot(error.turn_deg));
    error.tilt_deg = (error.turn_deg - normal.dot(error.turn_deg) * normal).norm();
    return error;
}

}  // namespace apps
