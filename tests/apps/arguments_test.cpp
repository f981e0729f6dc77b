// SPDX-License-Identifier: MIT
#include "apps/arguments.h"

#include <gtest/gtest.h>

namespace {

using Arguments = std::vector<std::string>;

TEST(Arguments, SetTakesSeveralItemsAndStopsAtOthers) {
    EXPECT_EQ(apps::expand_set_arguments({"--set", "a=1", "b.c=[1,2]", "scene.json", "-o", "x.h5"}),
              (Arguments{"--set=a=1", "--set=b.c=[1,2]", "scene.json", "-o", "x.h5"}));
    EXPECT_EQ(apps::expand_set_arguments({"scene.json", "--set", "a=1", "--set", "b=2"}),
              (Arguments{"scene.json", "--set=a=1", "--set=b=2"}));
}

TEST(Arguments, SetWithoutAnItemStaysVisible) {
    EXPECT_EQ(apps::expand_set_arguments({"--set"}), (Arguments{"--set="}));
    EXPECT_EQ(apps::expand_set_arguments({"--set", "key"}), (Arguments{"--set=key"}));
    EXPECT_EQ(apps::expand_set_arguments({"--set", "a=1", "--set"}),
              (Arguments{"--set=a=1", "--set="}));
}

TEST(Arguments, OtherArgumentsPassThrough) {
    const Arguments arguments{"render", "a=b.json", "-o", "x.h5", "--seed", "3"};
    EXPECT_EQ(apps::expand_set_arguments(arguments), arguments);
}

TEST(Arguments, SuffixIsReplacedOrAppended) {
    EXPECT_EQ(apps::with_suffix("out/volume.h5", ".png"), "out/volume.png");
    EXPECT_EQ(apps::with_suffix("out.d/volume", ".png"), "out.d/volume.png");
}

}  // namespace
