// SPDX-License-Identifier: MIT
#include "renderer/core/nearest_name.h"

#include <gtest/gtest.h>

namespace core {
namespace {

const std::vector<std::string> kKnown{"render", "reconstruct", "report", "compare", "bp", "fbp"};

TEST(NearestName, IsFoundThroughTypingErrors) {
    EXPECT_EQ(nearest_name("recontsruct", kKnown), "reconstruct");
    EXPECT_EQ(nearest_name("Render", kKnown), "render");
    EXPECT_EQ(nearest_name("rendr", kKnown), "render");
    EXPECT_EQ(nearest_name("comparee", kKnown), "compare");
    EXPECT_EQ(nearest_name("bin-width_m", {"bin_width_m", "num_bins"}), "bin_width_m");
}

TEST(NearestName, IsTheOnlyOneThatBeginsSo) {
    EXPECT_EQ(nearest_name("recon", kKnown), "reconstruct");
    EXPECT_EQ(nearest_name("re", kKnown), "");
    EXPECT_EQ(nearest_name("comp", kKnown), "compare");
}

TEST(NearestName, IsNoneWhereNoneIsNear) {
    EXPECT_EQ(nearest_name("simulate", kKnown), "");
    EXPECT_EQ(nearest_name("", kKnown), "");
    EXPECT_EQ(nearest_name("xy", kKnown), "");
    EXPECT_EQ(nearest_name(std::string(100'000, 'r'), kKnown), "");
    EXPECT_EQ(did_you_mean("simulate", kKnown), "");
    EXPECT_EQ(did_you_mean("rendr", kKnown), "did you mean 'render'? ");
}

}  // namespace
}  // namespace core
