// SPDX-License-Identifier: MIT
// Path velocities against closed forms and against moved scenes.
#include "renderer/core/random.h"
#include "renderer/core/system/parallel.h"
#include "renderer/film/time_gate.h"
#include "tests/renderer/doppler_scenes.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace {

using core::kPi;
using core::Vec3;
using doppler_test::doppler_settings;
using doppler_test::four_points;
using doppler_test::moving_scene;
using doppler_test::nine_pixels;
using renderer::Estimator;
using test_support::image_of;
using test_support::Parallelogram;

const core::TimeAxis kAllLengths{0.0, 30.0, 1};
const Vec3 kVelocity(1.3, -0.8, 4.0);

// A square of 2 mm around `center`, small enough to have one velocity.
renderer::Object small_patch(const Vec3& center, const Vec3& velocity) {
    const Vec3 u(2e-3, 0, 4e-4);
    const Vec3 v(0, 2e-3, -3e-4);
    renderer::Object patch =
        test_support::parallelogram_object({center - 0.5 * (u + v), u, v, 0.8});
    patch.velocity_m_per_s = velocity;
    return patch;
}

// Centre of the bins that hold a pair's light, weighted by it.
double mean_velocity(const core::VelocityHistogram& velocity, std::size_t pair) {
    const auto histogram = velocity.values.histogram(pair);
    double sum = 0.0;
    for (std::size_t i = 0; i < histogram.size(); ++i) {
        sum += double{histogram[i]} * velocity.axis.bin_center_m_per_s(static_cast<double>(i));
    }
    return sum / test_support::sum_of(histogram);
}

TEST(OpticalPath, VelocityIsTheRateAtWhichTheLengthChanges) {
    core::Rng rng(test_support::seed_of("PathExtent"), 0, 0);
    const auto random = [&] { return Vec3(rng.uniform(), rng.uniform(), rng.uniform()); };
    for (int trial = 0; trial < 100; ++trial) {
        std::vector<Vec3> points;
        std::vector<Vec3> velocities;
        for (int i = 0; i < 5; ++i) {
            points.push_back(random());
            velocities.push_back(random() - random());
        }
        const auto optical_path_after = [&](double seconds) {
            renderer::OpticalPath optical_path;
            for (std::size_t i = 1; i < points.size(); ++i) {
                const Vec3 from = points[i - 1] + seconds * velocities[i - 1];
                optical_path.add_segment(
                    points[i] + seconds * velocities[i] - from, velocities[i - 1], velocities[i]);
            }
            return optical_path;
        };
        constexpr double kStep_s = 1e-6;
        const double by_difference =
            (optical_path_after(kStep_s).opl_m - optical_path_after(-kStep_s).opl_m) /
            (2.0 * kStep_s);
        EXPECT_NEAR(optical_path_after(0.0).velocity_m_per_s, by_difference, 1e-8);
    }
}

TEST(FrequencyShift, IsThatOfTheCarrier) {
    // At 1 m/s of path velocity 193 THz shift by 643.8 kHz and 24 GHz by 80.06 Hz, downwards.
    EXPECT_NEAR(core::frequency_shift_hz(193e12, 1.0), -643778.7, 0.1);
    EXPECT_NEAR(core::frequency_shift_hz(24e9, -2.5), 200.1384, 1e-4);
    EXPECT_EQ(core::frequency_shift_hz(24e9, 0.0), 0.0);
}

class DopplerOf : public testing::TestWithParam<Estimator> {};

// u = -v . (u_l + u_s), the rate of |l - p| + |p - s| for p moving with v.
TEST_P(DopplerOf, MovingPatchHasTheClosedForm) {
    const Vec3 p(0.15, -0.1, 0.6);
    for (const auto pattern : {core::ScanPattern::Confocal, core::ScanPattern::Single}) {
        const core::Scan scan = four_points(pattern);
        const renderer::Scene scene({{small_patch(p, kVelocity)}, {}}, scan, {});
        core::VelocityAxis axis;
        axis.bin_width_m_per_s = 0.002;
        axis.num_bins = 10000;
        const auto capture =
            renderer::render(
                scene, scan, {kAllLengths, axis}, doppler_settings(GetParam(), 4096, 3), {})
                .capture;
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            const auto length_after = [&](double seconds) {
                const Vec3 x = p + seconds * kVelocity;
                return (x - scan.wall().sensing_point(pair)).norm() +
                       (x - scan.wall().illumination_point(pair)).norm();
            };
            const double expected = (length_after(1e-6) - length_after(-1e-6)) / 2e-6;
            const double found = mean_velocity(*capture.velocity, pair);
            // Directions differ over the patch by 2 mm / 0.6 m; their mean by far less.
            EXPECT_NEAR(found, expected, 1e-3);
            for (const double carrier_hz : {193e12, 24e9}) {
                EXPECT_NEAR(core::frequency_shift_hz(carrier_hz, found),
                            -carrier_hz * expected / 299792458.0,
                            carrier_hz * 1e-3 / 299792458.0);
            }
            const auto histogram = capture.velocity->values.histogram(pair);
            for (std::size_t i = 0; i < histogram.size(); ++i) {
                const double center = axis.bin_center_m_per_s(static_cast<double>(i));
                if (std::abs(center - expected) > 0.03) {
                    EXPECT_EQ(histogram[i], 0.0F);
                }
            }
            EXPECT_NEAR(test_support::sum_of(histogram) /
                            test_support::sum_of(capture.transient.histogram(pair)),
                        1.0,
                        1e-6);
        }
    }
}

TEST_P(DopplerOf, StaticSceneIsALineAtZero) {
    for (const core::Scan& scan : {four_points(core::ScanPattern::Single), nine_pixels()}) {
        const auto capture = renderer::render(moving_scene(scan, 0.0),
                                              scan,
                                              {kAllLengths, core::VelocityAxis{}},
                                              doppler_settings(GetParam(), 640, 5),
                                              {})
                                 .capture;
        const core::VelocityAxis& axis = capture.velocity->axis;
        const auto line = static_cast<std::size_t>(*axis.bin_of(0.0));
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            const auto histogram = capture.velocity->values.histogram(pair);
            EXPECT_FLOAT_EQ(histogram[line], capture.transient.histogram(pair)[0]);
            EXPECT_FLOAT_EQ(static_cast<float>(test_support::sum_of(histogram)), histogram[line]);
        }
        EXPECT_GT(test_support::sum_of(capture.transient.values()), 0.0);
    }
}

TEST_P(DopplerOf, PowerEqualsThatOfTheTimeHistogram) {
    const core::TimeAxis time{1.2, 0.15, 12};
    core::VelocityAxis axis{-20.0, 2.5, 16, true};
    for (const core::Scan& scan : {four_points(core::ScanPattern::Confocal), nine_pixels()}) {
        const renderer::Scene scene = moving_scene(scan);
        const auto settings = doppler_settings(GetParam(), 640, 5);
        axis.with_time = true;
        const auto joint = renderer::render(scene, scan, {time, axis}, settings, {}).capture;
        axis.with_time = false;
        const auto alone = renderer::render(scene, scan, {time, axis}, settings, {}).capture;
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            for (std::size_t t = 0; t < 12; ++t) {
                double sum = 0.0;
                for (std::size_t v = 0; v < 16; ++v) {
                    sum += double{joint.velocity->values.histogram(pair)[v * 12 + t]};
                }
                const double power = double{joint.transient.histogram(pair)[t]};
                EXPECT_NEAR(sum, power, 1e-5 * power + 1e-20);
            }
            EXPECT_NEAR(test_support::sum_of(alone.velocity->values.histogram(pair)),
                        test_support::sum_of(alone.transient.histogram(pair)),
                        1e-5 * test_support::sum_of(alone.transient.histogram(pair)));
        }
    }
}

// What lies outside the velocity axis still belongs to H.
TEST_P(DopplerOf, TimeHistogramKeepsWhatTheVelocityAxisLeavesOut) {
    const core::Scan scan = four_points(core::ScanPattern::Single);
    const renderer::Scene scene = moving_scene(scan);
    const auto settings = doppler_settings(GetParam(), 6400, 3);
    const auto wide =
        renderer::render(scene, scan, {kAllLengths, core::VelocityAxis{}}, settings, {});
    const core::VelocityAxis narrow{0.0, 0.5, 2};
    const auto cut = renderer::render(scene, scan, {kAllLengths, narrow}, settings, {});
    const double all = test_support::sum_of(wide.capture.transient.values());
    EXPECT_NEAR(test_support::sum_of(cut.capture.transient.values()) / all, 1.0, 0.1);
    EXPECT_LT(test_support::sum_of(cut.capture.velocity->values.values()), 0.8 * all);
    EXPECT_GT(test_support::sum_of(cut.capture.velocity->values.values()), 0.05 * all);
}

// The spectrum of a moving surface, its third bounces summed over midpoints.
TEST_P(DopplerOf, SpectrumOfAPlateIsTheQuadrature) {
    const Parallelogram plate{Vec3(-0.3, -0.2, 0.55), Vec3(0.6, 0, 0.2), Vec3(0, 0.5, 0.1), 0.7};
    const core::Scan scan = four_points(core::ScanPattern::Single);
    renderer::Object object = test_support::parallelogram_object(plate);
    object.velocity_m_per_s = kVelocity;
    const renderer::Scene scene({{object}, {}}, scan, {});
    const core::VelocityAxis axis{0.0, 0.25, 40};
    const auto capture =
        renderer::render(
            scene, scan, {kAllLengths, axis}, doppler_settings(GetParam(), 1 << 15, 3), {})
            .capture;
    constexpr int kSteps = 600;
    const Vec3 area = plate.u.cross(plate.v);
    const double level = test_support::sidak_level(1e-3, 4U * 40U);
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        std::vector<double> expected(40);
        const Vec3& l = scan.wall().illumination.positions[0];
        const Vec3& s = scan.wall().sensing.positions[pair];
        for (int i = 0; i < kSteps * kSteps; ++i) {
            const Vec3 x = plate.corner + (i / kSteps + 0.5) / kSteps * plate.u +
                           (i % kSteps + 0.5) / kSteps * plate.v;
            const Vec3 to_l = (l - x).normalized();
            const Vec3 to_s = (s - x).normalized();
            const auto bin = axis.bin_of(-kVelocity.dot(to_l + to_s));
            if (!bin) continue;
            const double cosines = std::abs(to_l.z() * to_s.z() * area.dot(to_l) * area.dot(to_s)) /
                                   area.squaredNorm();
            expected[static_cast<std::size_t>(*bin)] +=
                plate.albedo / (kPi * kPi * kPi) * cosines /
                ((l - x).squaredNorm() * (s - x).squaredNorm()) * area.norm() / (kSteps * kSteps);
        }
        const double total = std::accumulate(expected.begin(), expected.end(), 0.0);
        ASSERT_GT(total, 0.0);
        for (std::size_t bin = 0; bin < expected.size(); ++bin) {
            const double found = double{capture.velocity->values.histogram(pair)[bin]};
            if (expected[bin] < 0.01 * total) {
                EXPECT_LT(found, 0.02 * total) << pair << " " << bin;
                continue;
            }
            const double sigma =
                std::sqrt(double{capture.velocity->variance->histogram(pair)[bin]});
            EXPECT_LT(sigma, 0.1 * expected[bin]);
            const double z = (found - expected[bin]) / std::hypot(sigma, 3e-3 * expected[bin]);
            EXPECT_GT(test_support::normal_tail(z), level)
                << "pair " << pair << ", bin " << bin << ": " << found << " against "
                << expected[bin];
        }
    }
}

TEST_P(DopplerOf, SameBitsForAnyNumberOfThreads) {
    const core::Scan scan = four_points(core::ScanPattern::Confocal);
    const renderer::Scene scene = moving_scene(scan);
    core::VelocityAxis axis;
    axis.with_time = true;
    const auto render = [&](int num_threads) {
        const core::ThreadLimit limit(num_threads);
        return renderer::render(scene,
                                scan,
                                {core::TimeAxis{1.2, 0.15, 12}, axis},
                                doppler_settings(GetParam(), 128, 4),
                                {})
            .capture;
    };
    const auto one = render(1);
    const auto seven = render(7);
    EXPECT_TRUE(std::ranges::equal(one.velocity->values.values(), seven.velocity->values.values()));
    EXPECT_TRUE(
        std::ranges::equal(one.velocity->variance->values(), seven.velocity->variance->values()));
}

INSTANTIATE_TEST_SUITE_P(Estimators,
                         DopplerOf,
                         testing::Values(Estimator::Path,
                                         Estimator::Ellipsoidal,
                                         Estimator::Restir),
                         [](const auto& test) { return std::string(core::enum_name(test.param)); });

// A pixel so narrow that it sees a point: u = -v . (u_camera + u_light).
TEST(Doppler, DirectLightOfAMovingSurfaceHasTheClosedForm) {
    core::PinholeCamera camera;
    camera.position_m = Vec3(0.1, -0.2, 1.5);
    camera.look_at_m = Vec3(0.3, 0.2, 0.0);
    camera.light_m = Vec3(-0.4, 0.3, 0.8);
    camera.fov_y_deg = 1e-4;
    camera.resolution = {1, 1};
    const core::Scan scan = image_of(camera);
    renderer::Object floor =
        test_support::parallelogram_object({Vec3(-2, -2, 0), Vec3(4, 0, 0), Vec3(0, 4, 0), 0.6});
    floor.velocity_m_per_s = kVelocity;
    const renderer::Scene scene({{floor}, {}}, scan, {});
    const core::VelocityAxis axis{-10.0, 1e-3, 20000};
    const double expected = -kVelocity.dot((camera.position_m - camera.look_at_m).normalized() +
                                           (*camera.light_m - camera.look_at_m).normalized());
    for (const auto method : {Estimator::Path, Estimator::Ellipsoidal, Estimator::Restir}) {
        const auto capture =
            renderer::render(scene, scan, {kAllLengths, axis}, doppler_settings(method, 64, 1), {})
                .capture;
        EXPECT_NEAR(mean_velocity(*capture.velocity, 0), expected, 1e-3);
    }
}

// The spot moves along with its surface, and with it the end of every path.
TEST(Doppler, LitSpotMovesWithItsSurface) {
    core::PinholeCamera camera;
    camera.position_m = Vec3(0.0, 0.0, 1.5);
    camera.look_at_m = Vec3(0.3, 0.2, 0.0);
    camera.light_spot_m = Vec3(-0.4, 0.3, 0.0);
    camera.fov_y_deg = 1e-4;
    camera.resolution = {1, 1};
    const core::Scan scan = image_of(camera);
    renderer::Object floor =
        test_support::parallelogram_object({Vec3(0, -2, 0), Vec3(2, 0, 0), Vec3(0, 4, 0), 0.6});
    renderer::Object lit =
        test_support::parallelogram_object({Vec3(-2, -2, 0), Vec3(1.9, 0, 0), Vec3(0, 4, 0), 0.6});
    // A slope, so that floor and spot see each other.
    for (Vec3& vertex : lit.mesh.vertices) vertex.z() -= 0.5 * (vertex.x() + 0.4);
    lit.velocity_m_per_s = kVelocity;
    const renderer::Scene scene({{floor, lit}, {}}, scan, {});
    const core::VelocityAxis axis{-10.0, 1e-3, 20000};
    const auto capture =
        renderer::render(
            scene, scan, {kAllLengths, axis}, doppler_settings(Estimator::Path, 64, 2), {})
            .capture;
    const double expected = kVelocity.dot((*camera.light_spot_m - camera.look_at_m).normalized());
    EXPECT_NEAR(mean_velocity(*capture.velocity, 0), expected, 1e-3);
}

TEST(Doppler, RefusesWhatKnowsNoVelocities) {
    const core::Scan scan = four_points(core::ScanPattern::Confocal);
    const core::HistogramAxes axes{kAllLengths, core::VelocityAxis{}};
    EXPECT_ERROR_WITH(
        renderer::render(
            moving_scene(scan), scan, axes, doppler_settings(Estimator::ThirdBounce, 1, 3), {}),
        "must be auto, path, ellipsoidal or restir");
    renderer::RenderSettings shrinking = doppler_settings(Estimator::Restir, 1, 3);
    shrinking.restir.shrink_fraction = 0.5;
    EXPECT_ERROR_WITH(renderer::render(moving_scene(scan), scan, axes, shrinking, {}),
                      "shrink_fraction: found 0.5 for 1 bins and a velocity axis");
    renderer::Object wall =
        test_support::parallelogram_object({Vec3(-1, -1, 0), Vec3(2, 0, 0), Vec3(0, 2, 0), 1.0});
    wall.role = renderer::Role::RelayWall;
    wall.velocity_m_per_s = Vec3(0, 0, 1);
    const renderer::Scene moving_wall(
        {{wall, small_patch(Vec3(0, 0, 1), kVelocity)}, {}}, scan, {});
    EXPECT_ERROR_WITH(
        renderer::render(moving_wall, scan, axes, doppler_settings(Estimator::Path, 1, 3), {}),
        "a relay wall that moves");
}

}  // namespace
