// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render.h"
#include "tests/support/test_scenes.h"

#include <vector>

namespace restir_test {

// Two surfaces that light each other, an occluder before them, and a relay wall.
inline constexpr double kSpeed = 0.2;

inline std::vector<renderer::Object> make_objects() {
    std::vector<renderer::Object> objects = test_support::facing_surfaces();
    objects[1].role = renderer::Role::BackWall;
    objects[0].velocity_m_per_s = core::Vec3(0.0, 0.1, -kSpeed);
    return objects;
}

inline renderer::SceneGeometry geometry(bool glossy) {
    renderer::SceneGeometry result{make_objects(), {}};
    if (glossy) {
        result.objects[0].material.model = renderer::model_of({.metallic = true});
        result.objects[0].material.roughness = 0.5;
    }
    return result;
}

inline core::Scan wall_scan(core::ScanPattern pattern) {
    std::vector<core::Vec3> points;
    for (int i = 0; i < 9; ++i) {
        points.emplace_back(-0.3 + 0.2 * (i % 3), -0.2 + 0.2 * (i / 3), 0.0);
    }
    if (pattern == core::ScanPattern::Confocal) return test_support::confocal_scan(points);
    if (pattern == core::ScanPattern::Single) {
        return test_support::single_scan({0.1, 0.05, 0.0}, points);
    }
    return test_support::exhaustive_scan({{0.1, 0.05, 0.0}, {-0.2, 0.1, 0.0}}, points);
}

inline core::Scan image() {
    core::PinholeCamera camera;
    camera.position_m = core::Vec3(0.1, 0.1, -0.5);
    camera.look_at_m = core::Vec3(0.05, 0, 0.8);
    camera.light_m = core::Vec3(-0.3, 0.3, -0.1);
    camera.resolution = {4, 4};
    return core::ImageScan{camera};
}

// All pixels see one surface, and no edge crosses them.
inline core::Scan close_up() {
    core::PinholeCamera camera = image().as<core::ImageScan>()->camera;
    camera.look_at_m = core::Vec3(0.08, 0.12, 0.83);
    camera.fov_y_deg = 1.5;
    return core::ImageScan{camera};
}

inline renderer::RenderSettings restir_settings(renderer::Estimator method,
                                                int samples,
                                                int max_bounces) {
    renderer::RenderSettings settings;
    settings.method = method;
    settings.samples = samples;
    settings.max_bounces = max_bounces;
    settings.restir.shared_walks = 64;
    settings.restir.neighbours = 2;
    settings.restir.reuse_bins = true;
    return settings;
}

inline const core::TimeAxis kHistogram{1.2, 0.15, 12};
inline const core::TimeAxis kGate{1.7, 0.1, 1};

}  // namespace restir_test
