// SPDX-License-Identifier: MIT
#include "nlos/preparation/place_resolution.h"

#include "nlos/reconstruct.h"
#include "tests/nlos/every_method.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace nlos {
namespace {

using core::Vec3;

constexpr double kBinWidth_m = 0.008;

core::Capture point_capture(std::array<std::size_t, 2> size, double pitch_m) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid(size, {pitch_m, pitch_m}), {0.8, kBinWidth_m, 128});
    nlos_test::add_scatterer(capture, Vec3(0.001, 0.002, 0.6), 4.0);
    return capture;
}

double resolution_at(const core::Capture& capture, const Vec3& place) {
    return PlaceResolution(capture.scan.wall(), kBinWidth_m).at(place);
}

// Far before a confocal square of side d a step to the side changes lengths by 2 x / z of it, of
// root mean square d / (sqrt(3) z).
TEST(PlaceResolution, FallsWithTheApertureAndRisesWithTheRange) {
    for (const double pitch_m : {0.002, 0.01}) {
        const core::Capture capture = point_capture({14, 14}, pitch_m);
        const double mean_square = (14.0 * 14.0 - 1.0) / 12.0 * pitch_m * pitch_m;
        for (const double z : {1.0, 3.0}) {
            const double expected = kBinWidth_m * z / (2.0 * std::sqrt(mean_square));
            EXPECT_NEAR(resolution_at(capture, Vec3(0.0, 0.0, z)) / expected, 1.0, 0.01);
        }
    }
}

TEST(PlaceResolution, IsInfiniteOfOnePointAndOfRows) {
    for (const auto& size : {std::array<std::size_t, 2>{1, 1}, {30, 1}, {1, 30}}) {
        const core::Capture capture = point_capture(size, 0.03);
        for (const Vec3& place : {Vec3(0.0, 0.0, 0.6), Vec3(0.1, 0.3, 0.5)}) {
            EXPECT_TRUE(std::isinf(resolution_at(capture, place)));
        }
    }
}

TEST(PlaceResolution, NoMethodStatesSurfacesWhereTheScanTellsNone) {
    for (const nlos_test::MethodCase& method : nlos_test::every_method()) {
        for (const auto& [size, pitch_m] : {std::pair{std::array<std::size_t, 2>{1, 1}, 0.03},
                                            {std::array<std::size_t, 2>{40, 1}, 0.02},
                                            {std::array<std::size_t, 2>{8, 8}, 0.0025}}) {
            const bool is_grid = size[1] > 1;
            if (method.traits->needs == &kConfocalGrid && !is_grid) continue;
            if (method.traits == &kPhasor && size[0] == 1) continue;
            ReconstructSettings settings = method.settings();
            if (!is_grid) settings.volume.voxels = std::array{16, 16, 64};
            const Reconstruction result = reconstruct(point_capture(size, pitch_m), settings, {});
            EXPECT_TRUE(result.points.positions.empty()) << method.name << size[0];
            EXPECT_TRUE(std::ranges::any_of(
                result.warnings,
                [](const std::string& text) {
                    return text.find("distances rather than directions") != std::string::npos;
                }))
                << method.name << size[0];
        }
    }
}

// A scatterer 0.6 m before the middle of points over 0.8 m; see above for the expected value.
TEST(PlaceResolution, IsReportedAlikeByEveryMethod) {
    const core::Capture capture = point_capture({16, 16}, 0.05);
    const double root_mean_square = 0.05 * std::sqrt((16.0 * 16.0 - 1.0) / 12.0);
    const double expected = kBinWidth_m * 0.6 / (2.0 * root_mean_square);
    std::optional<double> first;
    for (const nlos_test::MethodCase& method : nlos_test::every_method()) {
        const Reconstruction result = reconstruct(capture, method.settings(), {});
        ASSERT_TRUE(result.resolution_m) << method.name;
        if (!first) first = result.resolution_m;
        EXPECT_EQ(*result.resolution_m, *first) << method.name;
    }
    EXPECT_NEAR(*first / expected, 1.0, 0.3) << "to first order in the aperture over the range";
    EXPECT_FALSE(reconstruct(point_capture({40, 1}, 0.02), {}, {}).resolution_m);
}

TEST(PlaceResolution, AutoTakesBackprojectionThere) {
    EXPECT_EQ(reconstruct(point_capture({40, 1}, 0.02), {}, {}).method, "bp");
    EXPECT_EQ(reconstruct(point_capture({8, 8}, 0.0025), {}, {}).method, "bp");
    EXPECT_EQ(reconstruct(point_capture({16, 16}, 0.05), {}, {}).method, "lct");
}

}  // namespace
}  // namespace nlos
