// SPDX-License-Identifier: MIT
#include "nlos/preparation/direct_response.h"

#include "nlos/reconstruct.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nlos {
namespace {

/// Jitter of 250 ps and a tail of 120 ps, as delays in metres of path length.
const core::ExponentialGaussianResponse kResponse{core::sigma_m_from_fwhm_ps(250.0),
                                                  120e-12 * core::kSpeedOfLight};

/// Counts of a plate 0.55 m before a confocal grid, with the wall's direct return of 3,000 photons
/// at a path length of `direct_m`, on an axis that begins 0.3 m before that of 0.
core::Capture plate_with_direct_return(double direct_m, bool has_device_segments) {
    core::Capture capture = nlos_test::confocal_capture(
        nlos_test::wall_grid({16, 16}, {0.05, 0.05}), {-0.3, 0.01, 240});
    if (has_device_segments) {
        capture.scan.wall().opl_origin = core::OplOrigin::Device;
        capture.scan.wall().laser_position = core::Vec3(0.1, -0.1, 0.8);
        capture.scan.wall().detector_position = core::Vec3(0.0, 0.1, 0.8);
        capture.time_axis.opl_start_m += 1.6;
    }
    for (int ix = -8; ix <= 8; ++ix) {
        for (int iy = -8; iy <= 8; ++iy) {
            nlos_test::add_scatterer(capture, core::Vec3(0.02 * ix, 0.02 * iy, 0.55), 4.0);
        }
    }
    const auto values = capture.transient.values();
    const float largest = *std::ranges::max_element(values);
    std::mt19937 generator(8);
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        auto histogram = capture.transient.histogram(pair);
        for (float& value : histogram) value *= 100.0F / largest;
        const double bin = (direct_m + capture.scan.wall().device_segments_m(pair) -
                            capture.time_axis.opl_start_m) /
                               0.01 -
                           0.5;
        const auto before = static_cast<std::size_t>(bin);
        const auto late = static_cast<float>(bin - std::floor(bin));
        histogram[before] += 3e3F * (1.0F - late);
        histogram[before + 1] += 3e3F * late;
    }
    capture.transient =
        core::apply_filter(core::sample_response(kResponse, 0.01), capture.transient);
    for (float& value : capture.transient.values()) {
        std::poisson_distribution<int> counts(static_cast<double>(value) + 0.2);
        value = static_cast<float>(counts(generator));
    }
    capture.unit = core::TransientUnit::Counts;
    return capture;
}

TEST(DirectResponse, ShowsTheResponse) {
    for (const bool has_device_segments : {false, true}) {
        const core::Capture capture = plate_with_direct_return(0.0, has_device_segments);
        const auto direct = measure_direct_return(capture);
        ASSERT_TRUE(direct.has_value());
        EXPECT_NEAR(direct->response.jitter_fwhm_ps, 250.0, 12.0);
        EXPECT_NEAR(direct->response.tail_ps, 120.0, 12.0);
        const double longest_segments = core::device_segment_range_m(capture.scan.wall())[1];
        EXPECT_GT(direct->end_opl_m, longest_segments + 4.0 * kResponse.tail_m);
        EXPECT_LT(direct->end_opl_m, longest_segments + 0.5);
    }
}

TEST(DirectResponse, IsNoneOutOfPlaceOrCutOff) {
    EXPECT_FALSE(measure_direct_return(plate_with_direct_return(0.2, false)).has_value());
    EXPECT_FALSE(measure_direct_return(plate_with_direct_return(0.2, true)).has_value());
    core::Capture capture = plate_with_direct_return(0.0, false);
    constexpr int kFirst = 27;  // on the rising edge
    core::Transient late(capture.transient.num_pairs(), 240 - kFirst);
    for (std::size_t pair = 0; pair < late.num_pairs(); ++pair) {
        const auto histogram = capture.transient.histogram(pair).subspan(kFirst);
        std::ranges::copy(histogram, late.histogram(pair).begin());
    }
    capture.transient = late;
    capture.time_axis.opl_start_m += 0.01 * kFirst;
    capture.time_axis.num_bins -= kFirst;
    EXPECT_FALSE(measure_direct_return(capture).has_value());
}

TEST(DirectResponse, IsNoneWithoutOne) {
    core::Capture capture = plate_with_direct_return(0.0, false);
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        std::ranges::fill(capture.transient.histogram(pair).first(110), 0.0F);
    }
    EXPECT_FALSE(measure_direct_return(capture).has_value());
    capture.time_axis.opl_start_m -= 1.1;  // the plate where the direct return should be
    EXPECT_FALSE(measure_direct_return(capture).has_value());
}

TEST(DirectResponse, IsLeftOutByAutoWhichExplainsItsShape) {
    const Reconstruction result = reconstruct(plate_with_direct_return(0.0, true), {}, {});
    EXPECT_EQ(result.settings.method, Method::Solver);
    EXPECT_NEAR(result.settings.response.jitter_fwhm_ps, 250.0, 10.0);
    ASSERT_TRUE(result.settings.crop.opl_range_m.has_value());
    for (std::size_t ix = 5; ix < 11; ++ix) {
        for (std::size_t iy = 5; iy < 11; ++iy) {
            EXPECT_NEAR(result.depth.depth_m[result.depth.index(ix, iy)], 0.55, 0.004);
        }
    }
}

}  // namespace
}  // namespace nlos
