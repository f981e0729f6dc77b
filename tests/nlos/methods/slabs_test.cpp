// SPDX-License-Identifier: MIT
#include "nlos/methods/slabs.h"

#include "nlos/methods/methods.h"
#include "renderer/core/system/process.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::Vec3;

constexpr std::array<double, 2> kDepths_m{0.3, 0.9};

/// Two points before a wall of so many points a side, and what a method gets of them.
struct Example {
    core::Capture capture;
    WallFrame wall;
    VolumeAxes axes;
    core::Progress progress;

    Example(std::size_t size, int num_bins) {
        const double pitch_m = 0.96 / static_cast<double>(size);
        capture =
            nlos_test::confocal_capture(nlos_test::wall_grid({size, size}, {pitch_m, pitch_m}),
                                        {0.2, 2.2 / num_bins, num_bins});
        nlos_test::add_scatterer(capture, Vec3(0.06, -0.1, 0.55), 4.0);
        nlos_test::add_scatterer(capture, Vec3(-0.1, 0.14, 0.66), 4.0);
        wall = derive_wall_frame(capture.scan.wall());
        axes.x_m = cell_centers(wall.min_m[0], wall.max_m[0], size);
        axes.y_m = cell_centers(wall.min_m[1], wall.max_m[1], size);
        axes.z_m = cell_centers(kDepths_m[0], kDepths_m[1], 60);
    }

    MethodInput input() const {
        return {capture.scan.wall(),
                capture.time_axis,
                capture.transient,
                wall,
                axes,
                kDepths_m,
                progress};
    }
};

ReconstructSettings with_snr() {
    ReconstructSettings settings;
    settings.snr = 10.0;
    return settings;
}

TEST(Slabs, CoverEverythingOnceInRunsOfNearlyEqualSize) {
    for (const std::size_t count : {1, 2, 7, 64, 129}) {
        for (const std::size_t num_slabs : {1, 2, 3, 8, 200}) {
            const std::vector<Slab> slabs = split_into_slabs(count, num_slabs);
            EXPECT_EQ(slabs.size(), std::min(count, num_slabs));
            std::size_t end = 0;
            for (const Slab& slab : slabs) {
                EXPECT_EQ(slab.begin, end);
                EXPECT_LE(slab.size(), largest_slab(count, num_slabs));
                EXPECT_GE(slab.size() + 1, largest_slab(count, num_slabs));
                end = slab.end;
            }
            EXPECT_EQ(end, count);
        }
    }
    EXPECT_TRUE(split_into_slabs(0, 4).empty());
}

TEST(FrequencySlabs, GiveTheSameVolumeInAnyNumber) {
    const Example example(24, 140);
    const MethodInput input = example.input();
    const Volume lct = kLct.run(input, with_snr(), 1);
    const Volume dlct = kDlct.run(input, with_snr(), 1);
    for (const std::size_t num_slabs : {2, 3, 64}) {
        EXPECT_LT(
            test_support::relative_l2(kLct.run(input, with_snr(), num_slabs).values, lct.values),
            1e-5);
        const Volume parts = kDlct.run(input, with_snr(), num_slabs);
        EXPECT_LT(test_support::relative_l2(parts.values, dlct.values), 1e-5);
        const auto brightest = std::max_element(dlct.values.begin(), dlct.values.end());
        const auto column = static_cast<std::size_t>(brightest - dlct.values.begin()) / 60;
        EXPECT_LT((parts.normals[column] - dlct.normals[column]).norm(), 1e-4F);
    }
}

TEST(FrequencySlabs, TakeTheMemoryThatIsReportedAndLessInMore) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the address sanitizer keeps memory that was given back";
#endif
    const Example example(64, 400);
    const MethodInput input = example.input();
    const core::ThreadLimit limit(1);
    constexpr double kSlack_bytes = 16e6;  // of code, plans and the allocator
    const auto growth = [](auto&& run) {
        core::reset_peak_rss();
        const auto before = static_cast<double>(core::peak_rss_bytes());
        run();
        return static_cast<double>(core::peak_rss_bytes()) - before;
    };
    // Most slabs first: memory that a run gives back may stay with the process.
    double last = 0.0;
    for (const std::size_t num_slabs : {8, 2, 1}) {
        const double lct_bytes = kLct.bytes(input, with_snr(), num_slabs);
        EXPECT_LT(growth([&] { kLct.run(input, with_snr(), num_slabs); }),
                  lct_bytes + kSlack_bytes);
        const double dlct_bytes = kDlct.bytes(input, with_snr(), num_slabs);
        EXPECT_LT(growth([&] { kDlct.run(input, with_snr(), num_slabs); }),
                  dlct_bytes + kSlack_bytes);
        EXPECT_GT(lct_bytes, last);
        last = lct_bytes;
    }
}

}  // namespace
}  // namespace nlos
