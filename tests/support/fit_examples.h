// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit.h"
#include "calib/forward/forward_model.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace test_support {

/// A rectangle of 0.4 m x 0.3 m named `name`, its node at the centre, turned by `tilt_rad` about
/// the axis (0.6, 0.8, 0).
inline renderer::Object tilted_rectangle(const std::string& name,
                                         const core::Vec3& center,
                                         double tilt_rad,
                                         double albedo = 0.5) {
    const Eigen::AngleAxisd turn(tilt_rad, core::Vec3(0.6, 0.8, 0.0));
    const core::Vec3 u = turn * core::Vec3(0.4, 0.0, 0.0);
    const core::Vec3 v = turn * core::Vec3(0.0, 0.3, 0.0);
    renderer::Object object = parallelogram_object({center - 0.5 * (u + v), u, v, albedo});
    object.name = name;
    object.world_from_node.linear() = turn.toRotationMatrix();
    object.world_from_node.translation() = center;
    return object;
}

/// A confocal grid of n x n points over 1 m.
inline core::WallScan confocal_grid(int n) {
    renderer::SceneDescription description;
    description.scan.sensing_points = {n, n};
    return renderer::make_scan(description).wall();
}

inline constexpr core::TimeAxis kFitAxis{0.9, 0.0192, 120};
inline constexpr double kFitFwhm_ps = 94.0;

/// Expected data of a model at its start, as forward_model computes them.
inline core::Capture expected_capture(const renderer::SceneGeometry& geometry,
                                      const core::WallScan& scan,
                                      double photons,
                                      double ambient) {
    calib::FitSettings settings;
    settings.free.parameters.clear();
    settings.free.objects = {{geometry.objects.front().name, {"translation"}}};
    const calib::SceneModel model(geometry, settings);
    calib::ForwardSettings forward;
    forward.axis = kFitAxis;
    forward.sigma_m = core::sigma_m_from_fwhm_ps(kFitFwhm_ps);
    forward.offset_m.assign(scan.num_pairs(), 0.0);
    forward.tolerance = 2e-3;
    calib::ForwardModel light(model, scan, calib::WallMotion(scan), forward);
    light.refresh(model.start());
    light.update(model.start(), renderer::Gradients::Without);
    core::Capture capture;
    capture.scan = scan;
    capture.time_axis = kFitAxis;
    capture.transient = core::Transient(scan.num_pairs(), kFitAxis.num_bins);
    std::vector<double> expected;
    calib::PairModel pair;
    for (std::size_t i = 0; i < scan.num_pairs(); ++i) {
        light.evaluate(i, pair);
        expected.insert(expected.end(), pair.mean.begin(), pair.mean.end());
    }
    const double sum = std::accumulate(expected.begin(), expected.end(), 0.0);
    for (std::size_t i = 0; i < expected.size(); ++i) {
        capture.transient.values()[i] = static_cast<float>(photons * expected[i] / sum + ambient);
    }
    capture.unit = core::TransientUnit::Counts;
    return capture;
}

/// Photon counts around expected ones; `seed` names them.
inline core::Capture counted(const core::Capture& expected, std::string_view seed) {
    core::Capture capture = expected;
    std::mt19937_64 engine(seed_of(seed));
    for (float& value : capture.transient.values()) {
        value =
            static_cast<float>(std::poisson_distribution<int>(static_cast<double>(value))(engine));
    }
    return capture;
}

/// A fit of `geometry`, whose poses are the start, to a capture.
inline calib::FitInput fit_input(const core::Capture& capture,
                                 const renderer::SceneGeometry& geometry) {
    calib::FitInput input;
    input.capture = capture;
    input.geometry = geometry;
    input.settings.scene = "test";
    input.settings.free.objects = {{geometry.objects.front().name, {"pose", "albedo"}}};
    input.settings.response.jitter_fwhm_ps = kFitFwhm_ps;
    return input;
}

/// "front" and "back", in one another's shade.
inline renderer::SceneGeometry two_objects() {
    renderer::SceneGeometry geometry;
    geometry.objects = {tilted_rectangle("front", core::Vec3(0.1, 0.0, 0.6), 0.4),
                        tilted_rectangle("back", core::Vec3(-0.1, 0.1, 0.8), -0.3, 0.8)};
    return geometry;
}

/// Every parameter free at once: those of two_objects(), of one point and of the scene. What
/// deforms is free of the back, what moves of the front.
inline calib::FitSettings all_free() {
    calib::FitSettings settings;
    calib::FreeObject front{"front", {}};
    calib::FreeObject back{"back", {"albedo"}};
    for (const calib::Parameter* row : calib::parameters()) {
        if (row->owner == calib::Owner::Scene) settings.free.parameters.insert(row->name);
        if (row->owner != calib::Owner::Body) continue;
        (row->effect == calib::Effect::Deforms ? back : front).parameters.insert(row->name);
    }
    settings.free.objects = {front, back};
    settings.free.point_scatterers = 1;
    return settings;
}

/// Whether one of the lines contains a text.
inline bool mentions(const std::vector<std::string>& lines, const std::string& part) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
        return line.find(part) != std::string::npos;
    });
}

}  // namespace test_support
