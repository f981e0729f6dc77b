// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "renderer/core/parallel.h"
#include "tests/nlos/confocal_scene.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// What must hold for every method on every kind of scan it serves.

namespace nlos {
namespace {

using core::ScanPattern;
using core::Vec3;

constexpr std::size_t kColumns = 24;
constexpr double kPitch_m = 0.04;
const core::TimeAxis kAxis{0.0, 0.016, 144};

struct LawCase {
    std::string name;
    ScanPattern pattern;
    std::vector<std::string> overrides;
    bool is_non_negative;
};

class ReconstructionLaw : public testing::TestWithParam<LawCase> {
 protected:
    static core::Capture dark_capture(const core::Transform& pose = core::Transform::Identity()) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({kColumns, kColumns}, {kPitch_m, kPitch_m}, pose), kAxis);
        capture.scan.pattern = GetParam().pattern;
        if (GetParam().pattern == ScanPattern::Single) {
            capture.scan.illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0}, pose);
        }
        if (GetParam().pattern == ScanPattern::Exhaustive) {
            capture.scan.illumination = nlos_test::wall_grid({3, 2}, {0.3, 0.4}, pose);
        }
        capture.transient = core::Transient(capture.scan.num_pairs(), kAxis.num_bins);
        return capture;
    }

    static Reconstruction run(const core::Capture& capture) {
        ReconstructSettings settings;
        settings.volume.z_range_m = {0.3, 0.9};
        for (const std::string& text : GetParam().overrides) {
            core::apply_override(settings, text);
        }
        return reconstruct(capture, settings, {});
    }

    static Vec3 peak(const Reconstruction& result) {
        const std::vector<float> projection = max_projection(result.volume);
        const auto column = static_cast<std::size_t>(
            std::max_element(projection.begin(), projection.end()) - projection.begin());
        const std::size_t ny = result.volume.axes.y_m.size();
        return result.depth.point_world(column / ny, column % ny);
    }

    /// A random place straight before a wall point, some columns away from the wall's edges.
    static Vec3 random_place(std::mt19937_64& generator) {
        std::uniform_int_distribution<int> column(5, kColumns - 6);
        std::uniform_real_distribution<double> depth(0.4, 0.75);
        const auto coordinate = [&] { return (column(generator) - 11.5) * kPitch_m; };
        const double x = coordinate();
        const double y = coordinate();
        return {x, y, depth(generator)};
    }

    static void expect_finite(const Reconstruction& result, const char* what) {
        for (const float value : result.volume.values) {
            ASSERT_TRUE(std::isfinite(value)) << what;
            if (GetParam().is_non_negative) {
                ASSERT_GE(value, 0.0F) << what;
            }
        }
    }
};

TEST_P(ReconstructionLaw, APointIsBrightestAtItsPlace) {
    std::mt19937_64 generator(test_support::seed_of("APointIsBrightestAtItsPlace"));
    for (int i = 0; i < 20; ++i) {
        const Vec3 place = random_place(generator);
        core::Capture capture = dark_capture();
        nlos_test::add_scatterer(capture, place, 4.0);
        const Vec3 found = peak(run(capture));
        EXPECT_NEAR(found.x(), place.x(), 1e-6) << place.transpose();
        EXPECT_NEAR(found.y(), place.y(), 1e-6) << place.transpose();
        EXPECT_NEAR(found.z(), place.z(), 0.1 * kAxis.bin_width_m) << place.transpose();
    }
}

TEST_P(ReconstructionLaw, AWallElsewhereGivesTheSameVolume) {
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(3.0, -2.0, 1.5));
    pose.rotate(Eigen::AngleAxisd(2.1, Vec3(0.3, 1.0, -0.2).normalized()));
    const Vec3 place(0.06, -0.1, 0.55);
    core::Capture here = dark_capture();
    core::Capture there = dark_capture(pose);
    nlos_test::add_scatterer(here, place, 4.0);
    nlos_test::add_scatterer(there, pose * place, 4.0);
    const Reconstruction result = run(there);
    EXPECT_LT((peak(result) - pose * peak(run(here))).norm(), 1e-4);
}

TEST_P(ReconstructionLaw, TheAxisMayStartLate) {
    const Vec3 place(0.06, -0.1, 0.55);
    core::Capture whole = dark_capture();
    core::Capture late = dark_capture();
    late.time_axis.opl_start_m = 0.7031;
    late.time_axis.num_bins = 100;
    late.transient = core::Transient(late.scan.num_pairs(), 100);
    nlos_test::add_scatterer(whole, place, 4.0);
    nlos_test::add_scatterer(late, place, 4.0);
    EXPECT_LT((peak(run(late)) - peak(run(whole))).norm(), 0.1 * kAxis.bin_width_m);
}

TEST_P(ReconstructionLaw, DeviceLegsAreTakenOff) {
    core::Capture capture = dark_capture();
    capture.scan.opl_origin = core::OplOrigin::Device;
    capture.scan.laser_position = Vec3(0.2, 0.3, -0.4);
    capture.scan.detector_position = Vec3(-0.3, 0.1, -0.5);
    capture.time_axis.opl_start_m = 0.8;
    const Vec3 place(0.06, -0.1, 0.55);
    nlos_test::add_scatterer(capture, place, 4.0);
    EXPECT_LT((peak(run(capture)) - place).norm(), 0.2 * kAxis.bin_width_m);
}

TEST_P(ReconstructionLaw, TwiceTheLightIsTwiceTheVolume) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    nlos_test::add_scatterer(capture, Vec3(-0.1, 0.14, 0.66), 4.0);
    std::vector<float> once = run(capture).volume.values;
    for (float& value : capture.transient.values()) value *= 2.0F;
    for (float& value : once) value *= 2.0F;
    EXPECT_LT(test_support::relative_l2(run(capture).volume.values, once), 1e-5);
}

TEST_P(ReconstructionLaw, DarknessIsDark) {
    const Reconstruction result = run(dark_capture());
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
    EXPECT_TRUE(result.points.positions.empty());
}

TEST_P(ReconstructionLaw, HardDataGivesFiniteVolumes) {
    core::Capture spike = dark_capture();
    spike.transient.histogram(7).back() = 1.0F;
    expect_finite(run(spike), "a spike in the last bin");
    core::Capture negative = dark_capture();
    for (float& value : negative.transient.values()) value = -1.0F;
    for (const float value : run(negative).volume.values) ASSERT_TRUE(std::isfinite(value));
    core::Capture saturated = dark_capture();
    for (float& value : saturated.transient.values()) value = 65535.0F;
    expect_finite(run(saturated), "saturation");
    core::Capture beyond = dark_capture();
    beyond.time_axis.opl_start_m = 5.0;
    for (float& value : beyond.transient.values()) value = 1.0F;
    expect_finite(run(beyond), "an axis behind the volume");
}

TEST_P(ReconstructionLaw, BitsAreTheSameForAnyNumberOfThreads) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    const auto values = [&](int threads) {
        const core::ThreadLimit limit(threads);
        return run(capture).volume.values;
    };
    EXPECT_EQ(values(1), values(7));
}

std::vector<LawCase> law_cases() {
    const std::string voxels = "volume.voxels=[24,24,75]";
    std::vector<LawCase> cases{
        {"LctConfocal", ScanPattern::Confocal, {"method=lct", voxels, "snr=10"}, true},
        {"DlctConfocal", ScanPattern::Confocal, {"method=dlct", voxels, "snr=10"}, true},
        {"FkConfocal", ScanPattern::Confocal, {"method=fk", voxels}, true}};
    const std::vector<std::pair<std::string, ScanPattern>> patterns{
        {"Confocal", ScanPattern::Confocal},
        {"Single", ScanPattern::Single},
        {"Exhaustive", ScanPattern::Exhaustive}};
    for (const auto& [name, pattern] : patterns) {
        cases.push_back({"Bp" + name, pattern, {"method=bp", voxels}, true});
        cases.push_back({"Fbp" + name, pattern, {"method=fbp", voxels}, false});
        cases.push_back(
            {"PhasorFbp" + name, pattern, {"method=fbp", "filter=phasor", voxels}, true});
        cases.push_back({"Phasor" + name, pattern, {"method=phasor", voxels}, true});
    }
    return cases;
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         ReconstructionLaw,
                         testing::ValuesIn(law_cases()),
                         [](const auto& law) { return law.param.name; });

}  // namespace
}  // namespace nlos
