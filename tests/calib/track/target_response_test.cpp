// SPDX-License-Identifier: MIT
#include "calib/track/target_response.h"

#include "tests/calib/track/track_example.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace {

using core::Vec3;
using test_support::response_of;
using test_support::small_sensor;

const Vec3 kTarget(0.3, -0.2, 0.8);

// The fraction of a pulse at `opl_m` in every bin, added up with a weight.
void add_pulse(const calib::TrackSensor& sensor,
               double opl_m,
               double weight,
               std::size_t zone,
               std::vector<double>& sum) {
    for (int b = 0; b < sensor.axis.num_bins; ++b) {
        const double to =
            core::gaussian_cdf(sensor.axis.bin_begin_m(b + 1) - opl_m, sensor.sigma_m);
        const double from = core::gaussian_cdf(sensor.axis.bin_begin_m(b) - opl_m, sensor.sigma_m);
        sum[zone * static_cast<std::size_t>(sensor.axis.num_bins) + static_cast<std::size_t>(b)] +=
            weight * (to - from);
    }
}

double falloff(const Vec3& wall_point) {
    const Vec3 d = kTarget - wall_point;
    return d.z() / std::pow(d.norm(), 3);
}

std::vector<double> evaluated(const calib::TargetResponse& response) {
    std::vector<double> values(response.size(), 0.0);
    response.evaluate(kTarget, values, {});
    return values;
}

void expect_same(const std::vector<double>& found, const std::vector<double>& truth) {
    const double most = *std::max_element(truth.begin(), truth.end());
    ASSERT_GT(most, 0.0);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_NEAR(found[i], truth[i], 2e-3 * most) << i;
    }
}

TEST(TargetResponse, RetroreflectorsAgreeWithTheSumOverWallPoints) {
    const auto sensor = small_sensor();
    const auto footprints = calib::footprints_at(sensor, sensor.setup->pose);
    std::vector<double> truth(response_of(sensor).size(), 0.0);
    for (std::size_t z = 0; z < footprints.zones.size(); ++z) {
        const auto& zone = footprints.zones[z];
        for (std::size_t i = 0; i < zone.seen.size(); ++i) {
            const Vec3& s = zone.seen.positions[i];
            const double opl_m = (s - footprints.laser_m).norm() + zone.seen.device_m[i] +
                                 2.0 * (kTarget - s).norm();
            add_pulse(sensor,
                      opl_m,
                      zone.seen.weights[i] * zone.seen_irradiance[i] * falloff(s),
                      z,
                      truth);
        }
    }
    expect_same(evaluated(response_of(sensor)), truth);
}

TEST(TargetResponse, DiffuseTargetsAgreeWithTheDoubleSumOverPairs) {
    for (const auto light : {core::SensorIllumination::Flood, core::SensorIllumination::Zones}) {
        const auto sensor = small_sensor(light);
        const auto footprints = calib::footprints_at(sensor, sensor.setup->pose);
        calib::TargetSettings target;
        target.kind = calib::TargetKind::Diffuse;
        const auto response = response_of(sensor, target);
        std::vector<double> truth(response.size(), 0.0);
        for (std::size_t z = 0; z < footprints.zones.size(); ++z) {
            const auto& seen = footprints.zones[z].seen;
            for (std::size_t other = 0; other < footprints.zones.size(); ++other) {
                if (light == core::SensorIllumination::Zones && other != z) continue;
                const auto& lit = footprints.zones[other].lit;
                for (std::size_t s = 0; s < seen.size(); ++s) {
                    for (std::size_t l = 0; l < lit.size(); ++l) {
                        const double opl_m = lit.device_m[l] + seen.device_m[s] +
                                             (kTarget - lit.positions[l]).norm() +
                                             (kTarget - seen.positions[s]).norm();
                        const double weight = lit.weights[l] * seen.weights[s] *
                                              falloff(lit.positions[l]) *
                                              falloff(seen.positions[s]);
                        add_pulse(sensor, opl_m, weight, z, truth);
                    }
                }
            }
        }
        expect_same(evaluated(response), truth);
    }
}

TEST(TargetResponse, GradientMatchesFiniteDifferences) {
    for (const auto kind : {calib::TargetKind::Retroreflective, calib::TargetKind::Diffuse}) {
        calib::TargetSettings target;
        target.kind = kind;
        target.radius_m = 0.1;
        const auto response = response_of(small_sensor(), target);
        std::vector<double> values(response.size(), 0.0);
        std::vector<Vec3> gradient(response.size(), Vec3::Zero());
        response.evaluate(kTarget, values, gradient);
        constexpr double kStep_m = 5e-3;
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> ahead(response.size(), 0.0);
            std::vector<double> behind = ahead;
            response.evaluate(kTarget + kStep_m * Vec3::Unit(axis), ahead, {});
            response.evaluate(kTarget - kStep_m * Vec3::Unit(axis), behind, {});
            double most = 0.0;
            for (const Vec3& g : gradient) most = std::max(most, std::abs(g[axis]));
            for (std::size_t i = 0; i < values.size(); ++i) {
                EXPECT_NEAR(
                    gradient[i][axis], (ahead[i] - behind[i]) / (2.0 * kStep_m), 0.02 * most)
                    << i;
            }
        }
    }
}

}  // namespace
