// SPDX-License-Identifier: MIT
#include "apps/bench/field/losses.h"

#include <gtest/gtest.h>

namespace apps {
namespace {

ReconstructionSummary summary(const std::string& program,
                              const std::string& method,
                              double mae_mm,
                              double iou,
                              const std::string& pattern = "confocal") {
    ReconstructionSummary s{pattern, 32, program, method};
    s.clean_mae_mm = mae_mm;
    s.clean_iou_best = iou;
    return s;
}

TEST(Losses, AreThoseToOurMethodOfTheSameNameOrToTheBest) {
    const std::vector<Loss> losses = find_losses(std::vector{
        summary("nlos", "fk", 2.0, 0.9),
        summary("nlos", "solver", 1.0, 0.8),
        summary("nlos", "fk", 0.1, 1.0, "single"),  // another task
        summary("peer", "fk", 1.5, 0.9),            // beats fk alone
        summary("peer", "new", 0.5, 0.95),          // beats all, and has no counterpart
        summary("peer", "fk", 1.0, 0.5, "single"),
    });
    ASSERT_EQ(losses.size(), 3U);
    EXPECT_EQ(losses[0].figure, "clean_mae_mm");
    EXPECT_EQ(losses[0].theirs, 1.5);
    EXPECT_EQ(losses[0].ours_alike, 2.0);
    EXPECT_EQ(losses[0].our_best, "solver");
    EXPECT_EQ(losses[0].ours_best, 1.0);
    EXPECT_EQ(losses[1].figure, "clean_mae_mm");
    EXPECT_FALSE(losses[1].ours_alike);
    EXPECT_EQ(losses[2].figure, "clean_iou_best");
    EXPECT_EQ(losses[2].our_best, "fk");
}

TEST(Losses, WithinTwoPercentMethodsAreLevel) {
    EXPECT_TRUE(find_losses(std::vector{summary("nlos", "bp", 1.00, 0.900),
                                        summary("nlos", "fk", 0.50, 0.950),
                                        summary("peer", "bp", 0.99, 0.917)})
                    .empty());
}

TEST(Losses, OfRenderersAreTimesBelowOurs) {
    const std::vector<Loss> losses =
        find_losses(std::vector<RenderingSummary>{{"bars", 5, "nlos", "auto", 10.0, 1.0},
                                                  {"bars", 5, "nlos", "path", 20.0, 2.0},
                                                  {"bars", 5, "peer", "fast", 5.0, 0.5},
                                                  {"bars", 5, "peer", "slow", 50.0, 5.0},
                                                  {"bars", 5, "peer", "biased", {}, {}, "biased"}});
    ASSERT_EQ(losses.size(), 1U);
    EXPECT_EQ(losses[0].task, "bars, order 5");
    EXPECT_EQ(losses[0].method, "fast");
    EXPECT_EQ(losses[0].our_best, "auto");
    EXPECT_EQ(losses[0].ours_best, 10.0);
}

}  // namespace
}  // namespace apps
