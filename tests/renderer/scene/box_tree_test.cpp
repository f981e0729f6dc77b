// SPDX-License-Identifier: MIT
#include "renderer/scene/box_tree.h"

#include "renderer/core/random.h"

#include <gtest/gtest.h>

#include <set>

namespace {

using core::Vec3;
using renderer::BoxTree;

TEST(BoxTree, FindsWhatMeetsABox) {
    for (const std::size_t count : {0U, 1U, 8U, 9U, 700U}) {
        core::Rng rng(count, 0, 0);
        const auto random_box = [&](double size) {
            const auto random = [&] { return Vec3(rng.uniform(), rng.uniform(), rng.uniform()); };
            const Vec3 corner = random();
            return BoxTree::Box(corner, Vec3(corner + size * random()));
        };
        std::vector<BoxTree::Box> boxes;
        for (std::size_t i = 0; i < count; ++i) boxes.push_back(random_box(i % 50 ? 0.05 : 2.0));
        const BoxTree tree(boxes);
        for (int q = 0; q < 50; ++q) {
            const BoxTree::Box query = random_box(q % 2 ? 0.1 : 0.0);
            std::set<std::uint32_t> found;
            tree.find(query, [&](std::uint32_t i) { EXPECT_TRUE(found.insert(i).second); });
            for (std::uint32_t i = 0; i < count; ++i) {
                EXPECT_EQ(found.contains(i), boxes[i].intersects(query));
            }
        }
    }
}

}  // namespace
