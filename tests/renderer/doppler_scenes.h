// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <vector>

namespace doppler_test {

/// Two surfaces that light each other and move apart, an occluder at rest before them.
inline renderer::Scene moving_scene(const core::Scan& scan, double speed = 1.0) {
    std::vector<renderer::Object> objects = test_support::facing_surfaces();
    objects[0].velocity_m_per_s = speed * core::Vec3(1.0, 0.5, -2.0);
    objects[1].velocity_m_per_s = speed * core::Vec3(-2.0, 0.0, 1.0);
    return renderer::Scene({objects, {}}, scan, {});
}

inline core::Scan four_points(core::ScanPattern pattern) {
    const std::vector<core::Vec3> points{
        {-0.3, -0.2, 0}, {0.1, 0.0, 0}, {-0.1, 0.3, 0}, {0.2, 0.25, 0}};
    if (pattern == core::ScanPattern::Confocal) return test_support::confocal_scan(points);
    return test_support::single_scan({0.1, 0.05, 0.0}, points);
}

inline core::Scan nine_pixels() {
    core::PinholeCamera camera;
    camera.position_m = core::Vec3(0.1, 0.1, -0.5);
    camera.look_at_m = core::Vec3(0.05, 0, 0.8);
    camera.light_m = core::Vec3(-0.3, 0.3, -0.1);
    camera.resolution = {3, 3};
    return test_support::image_of(camera);
}

inline renderer::RenderSettings doppler_settings(renderer::Estimator method,
                                                 int samples,
                                                 int max_bounces) {
    renderer::RenderSettings settings;
    settings.method = method;
    settings.samples = samples;
    settings.max_bounces = max_bounces;
    settings.variance = true;
    settings.seed = test_support::seed_of("Doppler");
    settings.restir.shared_walks = 64;
    settings.restir.neighbours = 2;
    settings.restir.reuse_bins = true;
    return settings;
}

}  // namespace doppler_test
