// SPDX-License-Identifier: MIT
// What `auto` knows of sampling, and how it chooses between that and integration.
#include "renderer/sampling_costs.h"

#include "renderer/render.h"
#include "renderer/third_bounce/third_bounce.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;
using renderer::Estimator;
using renderer::SamplingCosts;
using renderer::ThirdBounceScope;

constexpr core::TimeAxis kHistogram{0.9, 0.01, 120};
constexpr core::TimeAxis kGate{1.4, 0.002, 1};

/// Two plates, one before the other, seen from 6 x 6 points.
struct Plates {
    core::Scan scan;
    renderer::Scene scene;

    Plates() : scan(test_support::confocal_scan(points())), scene(geometry(), scan, {}) {}

    static std::vector<Vec3> points() {
        std::vector<Vec3> points;
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j < 6; ++j)
                points.emplace_back(0.15 * (i - 2.5), 0.15 * (j - 2.5), 0.0);
        }
        return points;
    }
    static renderer::SceneGeometry geometry() {
        renderer::SceneGeometry geometry;
        for (const double depth : {0.6, 0.8}) {
            renderer::Object plate;
            const double left = depth - 0.9;
            plate.mesh.vertices = {{left, -0.2, depth},
                                   {left + 0.3, -0.2, depth + 0.1},
                                   {left + 0.3, 0.2, depth + 0.1},
                                   {left, 0.2, depth}};
            plate.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
            plate.material.albedo = 0.6;
            geometry.objects.push_back(plate);
        }
        return geometry;
    }
    renderer::RenderResult render(const core::TimeAxis& axis,
                                  const renderer::RenderSettings& settings) const {
        return renderer::render(scene, scan, {axis, {}}, settings, {});
    }
    SamplingCosts costs(const core::TimeAxis& axis) const {
        const core::Progress progress;
        return renderer::find_sampling_costs({scene, scan, {axis, {}}, {}, progress},
                                             ThirdBounceScope::All);
    }
};

TEST(SamplingCosts, ConnectionsCostLessInGatesOnly) {
    const Plates plates;
    EXPECT_TRUE(plates.costs(kGate).connects());
    EXPECT_FALSE(plates.costs(kHistogram).connects());
    EXPECT_LT(plates.costs(kGate).least(), 0.1 * plates.costs(kGate).by_paths);
    EXPECT_TRUE(std::isinf(plates.costs({5.0, 0.01, 4}).least()));
}

// Costs in counted seconds: of both axes the ratio must be that of the errors of as many samples,
// within what some hundred samples tell.
TEST(SamplingCosts, GoWithTheSquaredErrorOfAsManySamples) {
    const Plates plates;
    const auto squared_error = [&](const core::TimeAxis& axis) {
        renderer::RenderSettings settings;
        settings.target_error = 1e-3;
        const auto expected = plates.render(axis, settings);
        settings.target_error.reset();
        settings.method = Estimator::Path;
        settings.samples = 4096;
        double sum = 0.0;
        for (settings.seed = 0; settings.seed < 4; ++settings.seed) {
            const auto paths = plates.render(axis, settings);
            sum += std::pow(test_support::relative_l2(paths.capture.transient.values(),
                                                      expected.capture.transient.values()),
                            2);
        }
        return sum;
    };
    const double ratio = squared_error(kGate) / squared_error(kHistogram);
    const double predicted = plates.costs(kGate).by_paths / plates.costs(kHistogram).by_paths;
    EXPECT_LT(std::abs(std::log(predicted / ratio)), std::log(4.0)) << predicted << ", " << ratio;
}

TEST(SamplingCosts, AutoIntegratesWhereThatIsWorthIt) {
    const Plates plates;
    for (const auto& [axis, target, expected] :
         {std::tuple(kGate, 0.1, Estimator::Ellipsoidal),
          std::tuple(kGate, 1e-4, Estimator::ThirdBounce),
          std::tuple(kHistogram, 0.01, Estimator::ThirdBounce)}) {
        renderer::RenderSettings settings;
        settings.target_error = target;
        const auto result = plates.render(axis, settings);
        ASSERT_EQ(result.sources.size(), 1U);
        EXPECT_EQ(result.sources[0].estimator, expected) << target;
        EXPECT_LE(*result.estimated_error, target);
        settings.seed = 7;  // chosen alike for every seed
        EXPECT_EQ(plates.render(axis, settings).sources[0].estimator, expected);
    }
}

TEST(SamplingCosts, IntegrationEndsWhereItsWorkIsTooMuch) {
    const Plates plates;
    renderer::RenderSettings settings;
    settings.target_error = 1e-3;
    const auto integrate = [&](double work_s) {
        return renderer::integrate_third_bounce(
            plates.scene, plates.scan.wall(), kHistogram, settings, {}, {.work_s = work_s});
    };
    EXPECT_TRUE(integrate(1e-9).is_too_much);
    EXPECT_FALSE(integrate(1e3).is_too_much);
}

}  // namespace
