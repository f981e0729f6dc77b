// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/volume.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

TEST(Volume, DividesByAPowerOfDepth) {
    Volume volume{{{0.0}, {0.0, 0.1}, {0.0, 0.5, 2.0}}, {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}, {}};
    divide_by_depth(0.0, volume);
    EXPECT_EQ(volume.values, (std::vector{1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F}));
    divide_by_depth(2.0, volume);
    EXPECT_EQ(volume.values, (std::vector{0.0F, 8.0F, 0.75F, 0.0F, 20.0F, 1.5F}));
}

}  // namespace
}  // namespace nlos
