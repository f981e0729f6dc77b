// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/settings_json.h"

namespace test_support {

/// Points (X, Y) 0.1 m apart on the plane z = 0, x before y; corner at (x0, 0.2).
inline core::WallPoints example_grid(std::size_t nx, std::size_t ny, double x0 = -0.1) {
    core::WallPoints points;
    points.grid = {nx, ny};
    for (std::size_t i = 0; i < nx; ++i) {
        for (std::size_t j = 0; j < ny; ++j) {
            points.positions.emplace_back(
                x0 + 0.1 * static_cast<double>(i), 0.2 + 0.1 * static_cast<double>(j), 0.0);
        }
    }
    points.normals.assign(points.size(), core::Vec3::UnitZ());
    return points;
}

inline core::WallPoints as_list(core::WallPoints points) {
    points.grid.reset();
    return points;
}

/// A small capture, every histogram value different: 3 x 2 sensing points and 5 bins.
inline core::Capture example_capture(core::ScanPattern pattern) {
    core::Capture capture;
    core::WallScan scan;
    scan.pattern = pattern;
    scan.sensing = example_grid(3, 2);
    if (pattern == core::ScanPattern::Confocal) scan.illumination = scan.sensing;
    if (pattern == core::ScanPattern::Single) scan.illumination = example_grid(1, 1, 0.3);
    if (pattern == core::ScanPattern::Exhaustive) scan.illumination = example_grid(2, 2, 0.3);
    capture.scan = scan;
    capture.time_axis = {0.25, 0.008, 5};
    capture.transient = core::Transient(capture.scan.num_pairs(), capture.time_axis.num_bins);
    float next = 0.5F;
    for (float& value : capture.transient.values()) value = next += 1.0F;
    capture.scene_info["seed"] = 7;
    return capture;
}

/// A confocal square around the origin, y upwards as our scans have it: 3 x 3 points and 4 bins of
/// whole numbers.
inline core::Capture example_square() {
    core::Capture capture;
    core::WallPoints points;
    points.grid = {3, 3};
    for (int i = 0; i < 9; ++i) {
        points.positions.emplace_back(0.2 * (i / 3 - 1), 0.2 * (i % 3 - 1), 0.0);
    }
    points.normals.assign(9, core::Vec3::UnitZ());
    capture.scan.wall().sensing = points;
    capture.scan.wall().illumination = points;
    capture.time_axis = {0.125, 0.0047, 4};
    capture.transient = core::Transient(9, 4);
    float next = 0.0F;
    for (float& value : capture.transient.values()) value = next += 3.0F;
    return capture;
}

/// The image of a camera of 3 x 2 pixels, every value different.
inline core::Capture example_image() {
    core::Capture capture = example_capture(core::ScanPattern::Single);
    core::PinholeCamera camera;
    camera.position_m = core::Vec3(0.5, 1.0, -2.0);
    camera.look_at_m = core::Vec3(0.0, 0.25, 1.0);
    camera.fov_y_deg = 40.0;
    camera.resolution = {3, 2};
    camera.light_m = core::Vec3(0.0, 2.0, 0.0);
    capture.scan = core::ImageScan{camera};
    return capture;
}

inline core::Json camera_json(const core::Capture& image) {
    return core::write_value(image.scan.as<core::ImageScan>()->camera);
}

}  // namespace test_support
