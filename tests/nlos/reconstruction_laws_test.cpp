// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "renderer/core/parallel.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/nlos/methods/peak_fit.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

// What must hold for every method on every kind of scan it serves. bp, fbp and, above 0, lct are
// linear; all others are of the first power: twice the light, twice the volume.

namespace nlos {
namespace {

using core::ScanPattern;
using core::Vec3;
using nlos_test::brightest_point;

constexpr std::size_t kColumns = 24;
constexpr double kPitch_m = 0.04;
const core::TimeAxis kAxis{0.0, 0.016, 144};

struct LawCase {
    std::string name;
    ScanPattern pattern;
    std::vector<std::string> overrides;
    bool is_non_negative;
    bool is_linear;       ///< where the volume is not cut off at 0
    int num_places = 8;   ///< tried
    /// Whether the method gathers a point in one bin of squared range, of which there are as many
    /// as bins: anywhere in such a bin is the same to it.
    bool gathers_in_squared_range = false;

    bool is_wave() const { return name.starts_with("Phasor"); }
};

class ReconstructionLaw : public testing::TestWithParam<LawCase> {
 protected:
    static core::Capture dark_capture(const core::Transform& pose = core::Transform::Identity(),
                                      const core::TimeAxis& axis = kAxis) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({kColumns, kColumns}, {kPitch_m, kPitch_m}, pose), axis);
        capture.scan.pattern = GetParam().pattern;
        if (GetParam().pattern == ScanPattern::Single) {
            capture.scan.illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0}, pose);
        }
        if (GetParam().pattern == ScanPattern::Exhaustive) {
            capture.scan.illumination = nlos_test::wall_grid({3, 2}, {0.3, 0.4}, pose);
        }
        capture.transient = core::Transient(capture.scan.num_pairs(), axis.num_bins);
        return capture;
    }

    static Reconstruction run(const core::Capture& capture,
                              const VolumeSettings& volume = {std::array{24, 24, 75},
                                                              std::array{0.3, 0.9}}) {
        ReconstructSettings settings;
        settings.volume = volume;
        for (const std::string& text : GetParam().overrides) {
            core::apply_override(settings, text);
        }
        return reconstruct(capture, settings, {});
    }

    /// The nearest column; one of the two that a point lies between where expectation maximisation
    /// gathers all light in one.
    static double lateral_tolerance_m() {
        const bool gathers =
            GetParam().name.starts_with("Solver") && GetParam().pattern != ScanPattern::Confocal;
        return (gathers ? 1.0 : 0.5) * kPitch_m;
    }

    /// A tenth of a bin in path length, half as much in depth.
    static double depth_tolerance_m(const Vec3& place, const core::TimeAxis& axis = kAxis) {
        const double bin_m2 = std::pow(0.5 * axis.opl_end_m(), 2) / axis.num_bins;
        const double half_bin_m = bin_m2 / (4.0 * place.z());  // dz = dv / (2 z)
        return 0.05 * axis.bin_width_m + (GetParam().gathers_in_squared_range ? half_bin_m : 0.0);
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

    /// Smallest and largest depth at which paths as long as those to `place` meet its column.
    static std::array<double, 2> depths_of_light(const core::Scan& scan,
                                                 const Vec3& place,
                                                 const Vec3& column) {
        std::array<double, 2> range{1e300, 0.0};
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            const Vec3& l = scan.illumination.positions[scan.illumination_index(pair)];
            const Vec3& s = scan.sensing.positions[scan.sensing_index(pair)];
            const auto length = [&](const Vec3& p) { return (l - p).norm() + (p - s).norm(); };
            Vec3 p = column;
            for (int step = 0; step < 5; ++step) {  // of Newton's method
                const double slope = (p - l).normalized().z() + (p - s).normalized().z();
                p.z() -= (length(p) - length(place)) / slope;
            }
            range = {std::min(range[0], p.z()), std::max(range[1], p.z())};
        }
        return range;
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

TEST_P(ReconstructionLaw, APointBeforeAColumnIsBrightestAtItsPlace) {
    std::mt19937_64 generator(test_support::seed_of("APointBeforeAColumnIsBrightestAtItsPlace"));
    double sum = 0.0;
    for (int i = 0; i < GetParam().num_places; ++i) {
        const Vec3 place = random_place(generator);
        core::Capture capture = dark_capture();
        nlos_test::add_scatterer(capture, place, 4.0);
        const Vec3 found = brightest_point(run(capture));
        EXPECT_NEAR(found.x(), place.x(), 1e-6) << place.transpose();
        EXPECT_NEAR(found.y(), place.y(), 1e-6) << place.transpose();
        EXPECT_NEAR(found.z(), place.z(), depth_tolerance_m(place)) << place.transpose();
        sum += found.z() - place.z();
    }
    // No method leans towards the wall or away from it.
    EXPECT_NEAR(sum / GetParam().num_places, 0.0, 0.05 * kAxis.bin_width_m);
}

// Bins about as wide in range as columns are apart, so that the image of a point, as wide as a bin,
// is not lost between columns. A column d beside the point shows it where the sphere around the
// wall point before it passes, d^2 / (2 z) nearer. The fit runs over columns up to d^2 = 2 pitch^2
// and may err by their bend. The image of a wave, a lobe as long as it is wide, widens with depth
// as its aperture shrinks to the eye: width ~ z, which moves the brightest place of a column
// d^2 / z away from the wall.
TEST_P(ReconstructionLaw, APointAnywhereIsBrightestAtItsPlace) {
    const core::TimeAxis axis{0.0, 0.048, 50};
    std::mt19937_64 generator(test_support::seed_of("APointAnywhereIsBrightestAtItsPlace"));
    std::uniform_real_distribution<double> lateral(-0.25, 0.25);
    std::uniform_real_distribution<double> depth(0.4, 0.75);
    for (int i = 0; i < GetParam().num_places; ++i) {
        const double x = lateral(generator);
        const double y = lateral(generator);
        const Vec3 place(x, y, depth(generator));
        core::Capture capture = dark_capture(core::Transform::Identity(), axis);
        nlos_test::add_scatterer(capture, place, 4.0);
        const Vec3 found = nlos_test::fitted_peak(
            run(capture, {std::array{24, 24, 66}, std::array{0.2, 1.0}}).volume);
        EXPECT_NEAR(found.x(), place.x(), lateral_tolerance_m()) << place.transpose();
        EXPECT_NEAR(found.y(), place.y(), lateral_tolerance_m()) << place.transpose();
        const double bend = (GetParam().is_wave() ? 2.0 : 1.0) * kPitch_m * kPitch_m / place.z();
        EXPECT_NEAR(found.z(), place.z(), depth_tolerance_m(place, axis) + bend)
            << place.transpose();
    }
}

// With bins five times finer than columns, a point between columns is in none of them. Each pair of
// wall points says that its light came from where its ellipsoid passes a column, and these differ;
// the image lies somewhere among them.
TEST_P(ReconstructionLaw, APointBetweenColumnsIsSeenWhereItsLightPassesTheNearest) {
    std::mt19937_64 generator(test_support::seed_of("APointBetweenColumnsIsSeen"));
    std::uniform_real_distribution<double> offset(-0.4, 0.4);
    for (int i = 0; i < std::min(5, GetParam().num_places); ++i) {
        const Vec3 column = random_place(generator);
        const double x = column.x() + offset(generator) * kPitch_m;
        const double y = column.y() + offset(generator) * kPitch_m;
        const Vec3 place(x, y, column.z());
        core::Capture capture = dark_capture();
        nlos_test::add_scatterer(capture, place, 4.0);
        const Vec3 found = brightest_point(run(capture));
        EXPECT_NEAR(found.x(), column.x(), 1e-6) << place.transpose();
        EXPECT_NEAR(found.y(), column.y(), 1e-6) << place.transpose();
        const auto [nearest, farthest] = depths_of_light(capture.scan, place, column);
        EXPECT_GT(found.z(), nearest - depth_tolerance_m(place)) << place.transpose();
        EXPECT_LT(found.z(), farthest + depth_tolerance_m(place)) << place.transpose();
    }
}

TEST_P(ReconstructionLaw, AMovedPointMovesItsImage) {
    const Vec3 place(-0.06, 0.06, 0.55);
    const Vec3 step(2.0 * kPitch_m, -3.0 * kPitch_m, 5.0 * 0.008);
    core::Capture before = dark_capture();
    core::Capture after = dark_capture();
    nlos_test::add_scatterer(before, place, 4.0);
    nlos_test::add_scatterer(after, place + step, 4.0);
    EXPECT_LT((brightest_point(run(after)) - brightest_point(run(before)) - step).norm(),
              2.0 * depth_tolerance_m(place));
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
    EXPECT_LT((brightest_point(result) - pose * brightest_point(run(here))).norm(), 1e-4);
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
    EXPECT_LT((brightest_point(run(late)) - brightest_point(run(whole))).norm(),
              2.0 * depth_tolerance_m(place));
}

TEST_P(ReconstructionLaw, DeviceLegsAreTakenOff) {
    core::Capture capture = dark_capture();
    capture.scan.opl_origin = core::OplOrigin::Device;
    capture.scan.laser_position = Vec3(0.2, 0.3, -0.4);
    capture.scan.detector_position = Vec3(-0.3, 0.1, -0.5);
    capture.time_axis.opl_start_m = 0.8;
    const Vec3 place(0.06, -0.1, 0.55);
    nlos_test::add_scatterer(capture, place, 4.0);
    const Vec3 found = brightest_point(run(capture));
    const auto [nearest, farthest] = depths_of_light(capture.scan, place, found);
    EXPECT_LT((found - place).head<2>().norm(), 0.5 * kPitch_m);
    EXPECT_GT(found.z(), nearest - depth_tolerance_m(place));
    EXPECT_LT(found.z(), farthest + depth_tolerance_m(place));
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

TEST_P(ReconstructionLaw, SumsOfScenesAreSumsOfVolumes) {
    if (!GetParam().is_linear) return;
    core::Capture first = dark_capture();
    core::Capture second = dark_capture();
    nlos_test::add_scatterer(first, Vec3(0.06, -0.1, 0.55), 4.0);
    nlos_test::add_scatterer(second, Vec3(-0.1, 0.14, 0.66), 4.0);
    const std::vector<float> a = run(first).volume.values;
    const std::vector<float> b = run(second).volume.values;
    for (std::size_t i = 0; i < first.transient.values().size(); ++i) {
        first.transient.values()[i] += second.transient.values()[i];
    }
    const std::vector<float> both = run(first).volume.values;
    const float tolerance = 1e-5F * *std::ranges::max_element(both);
    for (std::size_t i = 0; i < both.size(); ++i) {
        if (GetParam().is_non_negative && (a[i] == 0.0F || b[i] == 0.0F)) continue;
        ASSERT_NEAR(both[i], a[i] + b[i], tolerance);
    }
}

TEST_P(ReconstructionLaw, ALargerWorldGivesTheSameVolume) {
    const double factor = 2.0;  // a power of two: not even rounding differs
    core::Capture small = dark_capture();
    const Vec3 place(0.06, -0.1, 0.55);
    nlos_test::add_scatterer(small, place, 4.0);
    core::Capture large = small;
    large.time_axis.bin_width_m *= factor;
    for (core::WallPoints* points : {&large.scan.sensing, &large.scan.illumination}) {
        for (Vec3& position : points->positions) position *= factor;
    }
    const Reconstruction here = run(small);
    ReconstructSettings settings = here.settings;
    settings.volume.z_range_m = {factor * 0.3, factor * 0.9};
    settings.phasor.wavelength_m.reset();
    std::vector<float> there = reconstruct(large, settings, {}).volume.values;
    const float ratio =
        *std::ranges::max_element(here.volume.values) / *std::ranges::max_element(there);
    for (float& value : there) value *= ratio;
    EXPECT_LT(test_support::relative_l2(there, here.volume.values), 1e-5);
}

TEST_P(ReconstructionLaw, DarknessIsDark) {
    const Reconstruction result = run(dark_capture());
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
    EXPECT_TRUE(result.points.positions.empty());
}

TEST_P(ReconstructionLaw, LightOfAnyMagnitudeGivesTheSameVolume) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    capture.transient.histogram(7).back() = 1.0F;  // a spike in the last bin
    const core::Transient light = capture.transient;
    std::vector<float> expected = run(capture).volume.values;
    for (const float factor : {0x1p-40F, 0x1p+40F}) {
        for (std::size_t i = 0; i < light.values().size(); ++i) {
            capture.transient.values()[i] = factor * light.values()[i];
        }
        std::vector<float> values = run(capture).volume.values;
        for (float& value : values) value /= factor;
        EXPECT_LT(test_support::relative_l2(values, expected), 1e-5) << factor;
    }
}

TEST_P(ReconstructionLaw, SaturationIsNoMoreThanMuchLight) {
    core::Capture capture = dark_capture();
    std::ranges::fill(capture.transient.values(), 1.0F);
    std::vector<float> expected = run(capture).volume.values;
    for (float& value : expected) value *= 65536.0F;
    std::ranges::fill(capture.transient.values(), 65536.0F);
    const Reconstruction saturated = run(capture);
    expect_finite(saturated, "saturation");
    EXPECT_LT(test_support::relative_l2(saturated.volume.values, expected), 1e-5);
}

// The squares of waves do not tell; other volumes change their sign or, where they are cut off, are
// 0.
TEST_P(ReconstructionLaw, NegativeLightIsNoSurface) {
    core::Capture capture = dark_capture();
    nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
    const std::vector<float> positive = run(capture).volume.values;
    for (float& value : capture.transient.values()) value = -value;
    const std::vector<float> negative = run(capture).volume.values;
    const auto brightest =
        static_cast<std::size_t>(std::ranges::max_element(positive) - positive.begin());
    if (GetParam().is_wave()) {
        EXPECT_LT(test_support::relative_l2(negative, positive), 1e-5);
    } else {
        EXPECT_LE(negative[brightest], 0.0F);
    }
    for (const float value : negative) ASSERT_TRUE(std::isfinite(value));
}

// Transforms, which are periodic, may show some of it; voxels that a method asks for their light
// have none.
TEST_P(ReconstructionLaw, LightFromBehindTheVolumeIsNotInIt) {
    core::Capture capture = dark_capture();
    capture.time_axis.opl_start_m = 5.0;
    std::ranges::fill(capture.transient.values(), 1.0F);
    const Reconstruction result = run(capture);
    expect_finite(result, "an axis behind the volume");
    const std::string& name = GetParam().name;
    if (!name.starts_with("Bp") && !name.starts_with("Lct")) return;
    for (const float value : result.volume.values) ASSERT_EQ(value, 0.0F);
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
    std::vector<LawCase> cases{
        {"LctConfocal", ScanPattern::Confocal, {"method=lct", "snr=10"}, true, true},
        {"SolverConfocal",
         ScanPattern::Confocal,
         {"method=solver", "solver.max_iterations=60"},
         true,
         false,
         3,
         true},
        {"DlctConfocal", ScanPattern::Confocal, {"method=dlct", "snr=10"}, true, false},
        {"FkConfocal", ScanPattern::Confocal, {"method=fk"}, true, false}};
    const std::vector<std::pair<std::string, ScanPattern>> patterns{
        {"Confocal", ScanPattern::Confocal},
        {"Single", ScanPattern::Single},
        {"Exhaustive", ScanPattern::Exhaustive}};
    for (const auto& [name, pattern] : patterns) {
        cases.push_back({"Bp" + name, pattern, {"method=bp"}, true, true});
        if (pattern != ScanPattern::Confocal) {
            cases.push_back({"Solver" + name, pattern, {"method=solver"}, true, false, 3, true});
        }
        cases.push_back({"Fbp" + name, pattern, {"method=fbp"}, false, true});
        cases.push_back(
            {"PhasorFbp" + name, pattern, {"method=fbp", "filter=phasor"}, true, false});
        cases.push_back({"Phasor" + name, pattern, {"method=phasor"}, true, false});
    }
    return cases;
}

INSTANTIATE_TEST_SUITE_P(Methods,
                         ReconstructionLaw,
                         testing::ValuesIn(law_cases()),
                         [](const auto& law) { return law.param.name; });

}  // namespace
}  // namespace nlos
