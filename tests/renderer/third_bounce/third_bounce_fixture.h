// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace third_bounce_test {

inline const test_support::Parallelogram kNoOccluder{
    core::Vec3::Zero(), core::Vec3::Zero(), core::Vec3::Zero(), 0.0};
inline const core::TimeAxis kAxis{1.2, 0.02, 40};
inline constexpr double kWallAlbedo = 0.8;

inline renderer::SceneGeometry geometry_of(const std::vector<test_support::Parallelogram>& shapes) {
    renderer::SceneGeometry geometry;
    for (const test_support::Parallelogram& shape : shapes) {
        geometry.objects.push_back(test_support::parallelogram_object(shape));
    }
    return geometry;
}

/// A closed box between two corners, its normals pointing outwards.
inline renderer::Object box_object(const core::Vec3& low, const core::Vec3& high) {
    renderer::Object box;
    for (int i = 0; i < 8; ++i) {
        box.mesh.vertices.emplace_back(
            (i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z());
    }
    box.mesh.triangles = {{0, 2, 1},
                          {1, 2, 3},
                          {4, 5, 6},
                          {5, 7, 6},
                          {0, 1, 4},
                          {1, 5, 4},
                          {2, 6, 3},
                          {3, 6, 7},
                          {0, 4, 2},
                          {2, 4, 6},
                          {1, 3, 5},
                          {3, 7, 5}};
    return box;
}

inline renderer::Scene scene_of(renderer::SceneGeometry geometry, const core::WallScan& scan) {
    renderer::RelayWall wall;
    wall.albedo = kWallAlbedo;
    return {std::move(geometry), scan, wall};
}

inline renderer::RenderSettings settings_for(double target_error) {
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = target_error;
    return settings;
}

inline std::vector<float> render_shapes(const std::vector<test_support::Parallelogram>& shapes,
                                        const core::WallScan& scan,
                                        const core::TimeAxis& axis,
                                        double target_error) {
    const auto result = renderer::render(
        scene_of(geometry_of(shapes), scan), scan, axis, settings_for(target_error), {});
    const auto values = result.capture.transient.values();
    return {values.begin(), values.end()};
}

/// The scan of three wall points that each pattern makes.
class ThirdBounce : public testing::TestWithParam<core::ScanPattern> {
 protected:
    core::WallScan scan() const {
        if (GetParam() == core::ScanPattern::Confocal)
            return test_support::confocal_scan(test_support::kThreeWallPoints);
        if (GetParam() == core::ScanPattern::Single) {
            return test_support::single_scan(core::Vec3(0.1, 0.2, 0.0),
                                             test_support::kThreeWallPoints);
        }
        return test_support::exhaustive_scan(
            {core::Vec3(0.1, 0.2, 0.0), core::Vec3(-0.4, -0.4, 0.0)},
            test_support::kThreeWallPoints);
    }
};

}  // namespace third_bounce_test
