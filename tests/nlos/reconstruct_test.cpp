// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"

#include "nlos/detector/count_sampling.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "tests/nlos/every_method.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/statistics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using core::Vec3;
using nlos_test::every_method;
using nlos_test::MethodCase;

core::Capture example() {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({16, 16}, {0.05, 0.05}), {0.0, 0.016, 128});
    nlos_test::add_scatterer(capture, Vec3(0.075, -0.125, 0.5), 4.0);
    return capture;
}

/// A list of wall points that fill no grid.
core::Capture example_list() {
    core::Capture capture = example();
    core::WallScan& scan = capture.scan.wall();
    for (core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
        points->grid.reset();
        points->positions.pop_back();
        points->normals.pop_back();
    }
    core::Transient fewer(scan.num_pairs(), capture.time_axis.num_bins);
    std::copy_n(capture.transient.values().begin(), fewer.values().size(), fewer.values().begin());
    capture.transient = std::move(fewer);
    return capture;
}

ReconstructSettings with(const std::vector<std::string>& overrides) {
    ReconstructSettings settings;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    return settings;
}

TEST(Reconstruct, EveryMethodFindsAPointInWorldCoordinates) {
    core::Transform pose = core::Transform::Identity();
    pose.translate(Vec3(1.0, -2.0, 0.5));
    pose.rotate(Eigen::AngleAxisd(1.1, Vec3(0.3, 1.0, -0.2).normalized()));
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({16, 16}, {0.05, 0.05}, pose), {0.0, 0.016, 128});
    const Vec3 scatterer = pose * Vec3(0.075, -0.125, 0.5);
    nlos_test::add_scatterer(capture, scatterer, 4.0);
    for (const MethodCase& method : every_method()) {
        const Reconstruction result = reconstruct(capture, method.settings(), {});
        const std::vector<float> projection = max_projection(result.volume);
        const auto column = static_cast<std::size_t>(
            std::max_element(projection.begin(), projection.end()) - projection.begin());
        const Vec3 found = result.depth.point_world(column / 16, column % 16);
        EXPECT_LT((found - scatterer).norm(), 0.01) << method.name;
    }
}

TEST(Reconstruct, AutoTakesTheLightConeTransformForConfocalGrids) {
    const Reconstruction result = reconstruct(example(), {}, {});
    EXPECT_EQ(result.method, "lct");
    EXPECT_EQ(result.settings.method, Method::Lct);
    EXPECT_EQ(result.settings.volume.voxels, (std::array{16, 16, 128}));
    EXPECT_EQ(result.settings.merge_bins, 1);
    EXPECT_EQ(result.settings.snr, 1.0);
    EXPECT_EQ(result.observed, std::vector<std::uint8_t>(256, 1));
    EXPECT_GT(result.peak_bytes, 0U);
}

TEST(Reconstruct, AutoTakesThePhasorFieldForOtherScansAndSaysWhy) {
    core::Capture capture = example();
    capture.scan.wall().pattern = core::ScanPattern::Single;
    capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
    const Reconstruction single = reconstruct(capture, {}, {});
    EXPECT_EQ(single.method, "phasor");
    EXPECT_NE(single.reason.find("single-laser scan"), std::string::npos);
    EXPECT_NEAR(*single.settings.phasor.wavelength_m, 0.2, 1e-9);
    const Reconstruction listed = reconstruct(example_list(), with({"volume.voxels=[4,4,8]"}), {});
    EXPECT_EQ(listed.method, "phasor");
    EXPECT_NE(listed.reason.find("list of wall points"), std::string::npos);
}

TEST(Reconstruct, AutoFallsBackToBackprojectionAndSaysWhy) {
    core::Capture gated = example();
    gated.time_axis = {1.0, 0.3, 1};
    gated.transient = core::Transient(gated.scan.num_pairs(), 1);
    const Reconstruction result = reconstruct(gated, {}, {});
    EXPECT_EQ(result.method, "bp");
    EXPECT_NE(result.reason.find("1 bins"), std::string::npos);
}

TEST(Reconstruct, RefusalsNameTheMethodThatWorks) {
    const core::Capture list = example_list();
    core::Capture gated = example();
    gated.time_axis = {1.0, 0.3, 1};
    gated.transient = core::Transient(gated.scan.num_pairs(), 1);
    for (const MethodCase& method : every_method()) {
        if (!method.traits->needs) continue;
        EXPECT_ERROR_WITH(reconstruct(gated, method.settings(), {}), "method=bp works");
        if (method.traits->needs != &kConfocalGrid) continue;
        EXPECT_ERROR_WITH(reconstruct(list, method.settings(), {}), "method=phasor works");
        EXPECT_ERROR_WITH(reconstruct(example(), method.settings({"volume.voxels=[8,8,8]"}), {}),
                          "method=phasor works");
    }
}

TEST(Reconstruct, ConfocalMethodsTakeASingleLaserScanByItsMidpoints) {
    core::Capture capture = example();
    capture.scan.wall().pattern = core::ScanPattern::Single;
    capture.scan.wall().illumination = nlos_test::wall_grid({1, 1}, {1.0, 1.0});
    std::fill(capture.transient.values().begin(), capture.transient.values().end(), 0.0F);
    const Vec3 scatterer(0.0125, -0.0125, 0.5);
    nlos_test::add_scatterer(capture, scatterer, 4.0);
    for (const MethodCase& method : every_method()) {
        if (!method.traits->needs || !method.traits->needs->takes_other_patterns) continue;
        const Reconstruction result = reconstruct(capture, method.settings(), {});
        EXPECT_NE(result.reason.find("converted"), std::string::npos);
        EXPECT_NEAR(result.volume.axes.x_m[1] - result.volume.axes.x_m[0], 0.025, 1e-9);
        const std::vector<float> projection = max_projection(result.volume);
        const auto column = static_cast<std::size_t>(
            std::max_element(projection.begin(), projection.end()) - projection.begin());
        const Vec3 found = result.depth.point_world(column / 16, column % 16);
        EXPECT_LT((found - scatterer).norm(), 0.01) << method.name;
    }
}

TEST(Reconstruct, TakesAmbientLightOffCountsAndStopsWhereTheSignalEnds) {
    core::Capture capture = example();
    capture.unit = core::TransientUnit::Counts;
    for (float& value : capture.transient.values()) value = std::round(50.0F * value) + 2.0F;
    const Reconstruction result = reconstruct(capture, {}, {});
    EXPECT_EQ(result.settings.ambient, Ambient::Subtract);
    EXPECT_LT((*result.settings.volume.z_range_m)[1], 1.0);
    EXPECT_LT((nlos_test::brightest_point(result) - Vec3(0.075, -0.125, 0.5)).norm(), 0.01);
}

TEST(Reconstruct, ReportsDeviationsOfDepthWhereTheNoiseIsKnown) {
    const auto num_reported = [](const core::Capture& capture) {
        const Reconstruction result = reconstruct(capture, {}, {});
        EXPECT_EQ(result.surface_probability.size(), result.depth.depth_m.size());
        return std::ranges::count_if(result.depth_sigma_m,
                                     [](double sigma) { return sigma > 0.0; });
    };
    core::Capture capture = example();
    EXPECT_EQ(num_reported(capture), 0);
    capture.variance = core::Transient(capture.transient.num_pairs(), capture.time_axis.num_bins);
    EXPECT_EQ(num_reported(capture), 0);
    std::ranges::fill(capture.variance->values(), 1e-4F);
    EXPECT_GT(num_reported(capture), 0);
    capture.variance.reset();
    capture.unit = core::TransientUnit::Counts;
    for (float& value : capture.transient.values()) value = std::round(50.0F * value);
    EXPECT_GT(num_reported(capture), 0);
}

// Means of 20 frames: values are no whole numbers, and the background tells what a photon adds.
TEST(Reconstruct, FindsInMeansOfCountsWhatItFindsInCounts) {
    core::Capture counts = example();
    counts.unit = core::TransientUnit::Counts;
    core::Rng rng(3, 0, 0);
    for (float& value : counts.transient.values()) {
        value = static_cast<float>(sample_poisson(rng, 200.0 * double{value} + 4.0));
    }
    core::Capture means = counts;
    means.unit = core::TransientUnit::Radiance;
    for (float& value : means.transient.values()) value /= 20.0F;
    const auto of = [](const core::Capture& capture) {
        return reconstruct(capture, with({"method=lct", "snr=1"}), {});
    };
    const Reconstruction by_counts = of(counts);
    const Reconstruction by_means = of(means);
    ASSERT_EQ(by_means.depth_sigma_m.size(), by_counts.depth_sigma_m.size());
    EXPECT_GT(by_counts.points.positions.size(), 0U);
    for (std::size_t i = 0; i < by_counts.depth.depth_m.size(); ++i) {
        // Halves of photons and normal deviates are two ways to draw the same noise.
        EXPECT_NEAR(by_means.surface_probability[i], by_counts.surface_probability[i], 0.25) << i;
    }
}

TEST(Reconstruct, AutoLooksAtTheCaptureAndSaysWhatItFound) {
    core::Capture capture = example();
    EXPECT_EQ(reconstruct(capture, {}, {}).method, "lct");
    for (float& value : capture.transient.values()) value = std::round(500.0F * value);
    capture.unit = core::TransientUnit::Counts;
    const Reconstruction counts = reconstruct(capture, {}, {});
    EXPECT_EQ(counts.method, "solver");
    ASSERT_GE(counts.findings.size(), 4U);
    EXPECT_NE(counts.findings[0].find("counts"), std::string::npos);
    EXPECT_LT((nlos_test::brightest_point(counts) - Vec3(0.075, -0.125, 0.5)).norm(), 0.01);
    EXPECT_TRUE(reconstruct(capture, with({"method=lct"}), {}).findings.empty());
    capture.unit = core::TransientUnit::Radiance;
    std::vector<core::BinRange> ranges(capture.scan.num_pairs(), {0, capture.time_axis.num_bins});
    ranges[7] = {};
    core::restrict_observed(capture, ranges);
    EXPECT_EQ(reconstruct(capture, {}, {}).method, "solver");
}

TEST(Reconstruct, TakesANoiseFloorOffWhateverTheUnit) {
    core::Capture clean = example();
    core::Capture noisy = example();
    for (float& value : clean.transient.values()) value = std::round(50.0F * value);
    for (float& value : noisy.transient.values()) value = std::round(50.0F * value) + 2.0F;
    const std::string all = "volume.z_range_m=[0,1.024]";  // else the volume ends with the signal
    const std::vector<float> expected = reconstruct(clean, with({all}), {}).volume.values;
    EXPECT_EQ(reconstruct(noisy, with({"noise_floor=2", all}), {}).volume.values, expected);
    EXPECT_NE(reconstruct(noisy, with({"noise_floor=1", all}), {}).volume.values, expected);
    noisy.unit = core::TransientUnit::Counts;
    const Reconstruction estimated = reconstruct(noisy, with({"method=lct", "snr=1", all}), {});
    EXPECT_EQ(estimated.volume.values, expected);
    EXPECT_FALSE(estimated.settings.noise_floor);
}

// A tail of 400 ps moves the light 6 cm down in depth and smears it over as much; methods that go
// by the light's phase notice little of it.
TEST(Reconstruct, TakesTheResponseOff) {
    core::Capture capture = example();
    const core::ResponseFilter filter = core::sample_response(
        core::make_response({100.0, 400.0, {}}, "test"), capture.time_axis.bin_width_m);
    capture.transient = core::apply_filter(filter, capture.transient);
    for (const MethodCase& method : every_method()) {
        if (method.traits->explains_response) continue;
        const auto depth_error = [&](const std::vector<std::string>& settings) {
            const Reconstruction result = reconstruct(capture, method.settings(settings), {});
            const std::vector<float> projection = max_projection(result.volume);
            const auto column = static_cast<std::size_t>(
                std::max_element(projection.begin(), projection.end()) - projection.begin());
            return std::abs(result.depth.point_world(column / 16, column % 16).z() - 0.5);
        };
        const bool by_phase = method.traits == &kFk || method.traits->propagates_wave;
        EXPECT_GT(depth_error({}), by_phase ? 0.0 : 0.012) << method.name;
        EXPECT_LT(
            depth_error(
                {"response.jitter_fwhm_ps=100", "response.tail_ps=400", "response_floor=0.02"}),
            0.006)
            << method.name;
    }
}

TEST(Reconstruct, NamesSettingsOutOfRange) {
    EXPECT_ERROR_WITH(reconstruct(example(), with({"response_floor=0"}), {}),
                      "response_floor: found 0");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"response.tail_ps=-1"}), {}), "response");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"noise_floor=-1"}), {}),
                      "noise_floor: found -1");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"noise_floor=1", "ambient=keep"}), {}),
                      "ambient=auto or subtract");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"snr=0"}), {}), "snr: found 0");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"method=lct", "falloff=facing"}), {}),
                      "method=solver knows facing");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"mask_threshold=1.5"}), {}), "mask_threshold");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"merge_bins=500"}), {}), "128 bins");
    EXPECT_ERROR_WITH(
        reconstruct(example(), with({"method=phasor", "phasor.wavelength_m=5e-324"}), {}),
        "must be at least a bin");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"volume.voxels=[0,4,4]"}), {}), "volume.voxels");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"volume.z_range_m=[0.5,0.4]"}), {}),
                      "volume.z_range_m");
    EXPECT_ERROR_WITH(reconstruct(example(), with({"memory_gb=0"}), {}), "memory_gb: found 0");
    EXPECT_ERROR_WITH(with({"prior=tw"}), "none");
    EXPECT_ERROR_WITH(with({"metod=bp"}), "method");
}

TEST(Reconstruct, RefusesMoreMemoryThanThereIs) {
    try {
        reconstruct(example(), with({"method=bp", "volume.voxels=[60000,60000,60000]"}), {});
        FAIL() << "864 TB were found";
    } catch (const core::Failure& failure) {
        EXPECT_NE(std::string(failure.what()).find("GB"), std::string::npos);
    }
}

TEST(Reconstruct, WorksInSlabsWhenMemoryIsShort) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({16, 16}, {0.06, 0.06}), {0.0, 0.016, 256});
    nlos_test::add_scatterer(capture, Vec3(0.07, -0.13, 0.5), 4.0);
    for (const MethodCase& method : every_method()) {
        if (method.iterates()) continue;
        const Reconstruction whole = reconstruct(capture, method.settings(), {});
        std::string announced;
        core::Progress progress;
        progress.announce = [&](const std::string& text) { announced = text; };
        const std::string limit = fmt::format("memory_gb={}", 0.7e-9 * whole.estimated_bytes);
        const Reconstruction slabs = reconstruct(capture, method.settings({limit}), progress);
        EXPECT_NE(announced.find(" slabs"), std::string::npos) << announced;
        EXPECT_LT(slabs.estimated_bytes, 0.7 * whole.estimated_bytes) << method.name;
        // Single precision, whose rounding dlct raises next to the wall (7e-5 at most seen).
        EXPECT_LT(test_support::relative_l2(slabs.volume.values, whole.volume.values), 1e-3)
            << method.name;
        EXPECT_THROW(reconstruct(capture, method.settings({"memory_gb=0.0001"}), {}), core::Failure)
            << method.name;
    }
    EXPECT_THROW(reconstruct(capture, with({"prior=tv", "memory_gb=0.001"}), {}), core::Failure);
}

TEST(Reconstruct, TakesNoMoreMemoryThanItReports) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the address sanitizer keeps memory that was given back";
#endif
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({96, 96}, {0.02, 0.02}), {0.0, 0.008, 320});
    nlos_test::add_scatterer(capture, Vec3(0.075, -0.125, 0.5), 4.0);
    const core::ThreadLimit limit(1);
    constexpr double kSlack_bytes = 16e6;  // of code, plans, depth map and the allocator
    const auto estimated_bytes = [&](const MethodCase& method, const std::string& setting) {
        const ReconstructSettings settings =
            method.settings({"merge_bins=1", "volume.z_range_m=[0.4,0.6]", setting});
        core::reset_peak_rss();
        const auto before = static_cast<double>(core::peak_rss_bytes());
        const Reconstruction result = reconstruct(capture, settings, {});
        const double taken = static_cast<double>(core::peak_rss_bytes()) - before;
        EXPECT_LT(taken, result.estimated_bytes + kSlack_bytes) << method.name << " " << setting;
        EXPECT_GT(result.estimated_bytes, 4.0 * static_cast<double>(result.volume.values.size()));
        return result.estimated_bytes;
    };
    for (const MethodCase& method : every_method()) {
        const double bytes = estimated_bytes(method, "solver.max_iterations=2");
        if (method.iterates()) continue;
        estimated_bytes(method, fmt::format("memory_gb={}", 0.8e-9 * bytes));
    }
}

TEST(Reconstruct, EndsWhenAskedToStop) {
    for (const MethodCase& method : every_method()) {
        int asked = 0;
        core::Progress progress;
        progress.stop_requested = [&] { return ++asked > 3; };
        EXPECT_THROW(reconstruct(example(), method.settings(), progress), core::Failure)
            << method.name;
    }
}

TEST(Reconstruct, ReportsProgressUpToTheEnd) {
    for (const MethodCase& method : every_method()) {
        double last = 0.0;
        core::Progress progress;
        progress.report = [&](double fraction, const std::string&) {
            EXPECT_GE(fraction, last);
            last = fraction;
        };
        reconstruct(example(), method.settings(), progress);
        EXPECT_NEAR(last, 1.0, 1e-9) << method.name;
    }
}

TEST(Reconstruct, ServesASingleWallPoint) {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({1, 1}, {1.0, 1.0}), {0.0, 0.02, 40});
    nlos_test::add_scatterer(capture, Vec3(0.0, 0.0, 0.2), 4.0);
    const Reconstruction result = reconstruct(capture, with({"volume.voxels=[8,8,8]"}), {});
    EXPECT_EQ(result.method, "bp");
    for (const float value : result.volume.values) EXPECT_TRUE(std::isfinite(value));
    EXPECT_EQ(result.observed, std::vector<std::uint8_t>(64, 0));
}

TEST(Reconstruct, SaysThatFewPairsTellDistancesOnly) {
    for (const auto& [side, starts] : {std::pair{std::size_t{1}, "one pair of wall points tells"},
                                       std::pair{std::size_t{4}, "16 pairs of wall points tell "},
                                       std::pair{std::size_t{5}, ""}}) {
        core::Capture capture = nlos_test::confocal_capture(
            nlos_test::wall_grid({side, side}, {0.2, 0.2}), {0.0, 0.02, 40});
        nlos_test::add_scatterer(capture, Vec3(0.0, 0.0, 0.2), 4.0);
        const auto warnings =
            reconstruct(capture, with({"volume.voxels=[8,8,8]", "method=bp"}), {}).warnings;
        if (starts[0] == '\0') {
            EXPECT_TRUE(warnings.empty());
        } else {
            ASSERT_EQ(warnings.size(), 1U);
            EXPECT_TRUE(warnings[0].starts_with(starts)) << warnings[0];
        }
    }
}

TEST(Reconstruct, ImagesOfACameraAreRefused) {
    EXPECT_ERROR_WITH(reconstruct(test_support::example_image(), {}, {}), "image of a camera");
}

}  // namespace
}  // namespace nlos
