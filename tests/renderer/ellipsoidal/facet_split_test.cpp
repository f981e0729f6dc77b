// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/facet_split.h"

#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace {

using core::Vec3;
using Sets = std::vector<std::span<std::uint32_t>>;

renderer::Facet facet_at(const Vec3& corner, double size) {
    renderer::Facet facet;
    facet.corner = corner;
    facet.edge1 = Vec3(size, 0, 0);
    facet.edge2 = Vec3(0, size, 0);
    facet.normal = Vec3::UnitZ();
    facet.area_m2 = 0.5 * size * size;
    return facet;
}

// A grid of small facets in a corner of two large ones.
std::vector<renderer::Facet> grid_and_walls() {
    std::vector<renderer::Facet> facets{facet_at(Vec3(-1, -1, 0), 2.0),
                                        facet_at(Vec3::Zero(), 2.0)};
    for (int i = 0; i < 100; ++i) {
        facets.push_back(facet_at(Vec3(0.01 * (i % 10), 0.01 * (i / 10), 0.1), 0.01));
    }
    return facets;
}

std::vector<std::uint32_t> all_of(std::span<const renderer::Facet> facets) {
    std::vector<std::uint32_t> set(facets.size());
    std::iota(set.begin(), set.end(), 0U);
    return set;
}

std::vector<std::uint32_t> joined(const Sets& sets) {
    std::vector<std::uint32_t> all;
    for (const auto& set : sets) all.insert(all.end(), set.begin(), set.end());
    return all;
}

TEST(FacetSplit, PartsFollowEachOtherAndHoldEveryFacetOnce) {
    const auto facets = grid_and_walls();
    for (const std::size_t most : {2, 3, 8, 200}) {
        for (const bool halve : {false, true}) {
            auto set = all_of(facets);
            const Sets parts = renderer::split_facets(set, facets, most, halve);
            EXPECT_EQ(parts.size(), std::min(most, facets.size()));
            EXPECT_EQ(joined(parts), set);
            for (const auto& part : parts) EXPECT_FALSE(part.empty());
            std::sort(set.begin(), set.end());
            EXPECT_EQ(set, all_of(facets));
        }
    }
}

TEST(FacetSplit, LargeFacetsDoNotShareAPartWithSmallOnes) {
    const auto facets = grid_and_walls();
    auto set = all_of(facets);
    for (const auto& part : renderer::split_facets(set, facets, 8, false)) {
        const auto num_large =
            std::count_if(part.begin(), part.end(), [](std::uint32_t f) { return f < 2; });
        EXPECT_TRUE(num_large == 0 || part.size() == 1) << part.size();
    }
}

TEST(FacetSplit, FacetsThatCannotBeToldApartAreHalved) {
    const std::vector<renderer::Facet> facets(9, facet_at(Vec3::Zero(), 1.0));
    auto set = all_of(facets);
    const Sets parts = renderer::split_facets(set, facets, 2, false);
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_EQ(parts[0].size(), 4U);
    EXPECT_EQ(parts[1].size(), 5U);
    auto one = std::vector<std::uint32_t>{7};
    EXPECT_EQ(renderer::split_facets(one, facets, 8, false).size(), 1U);
}

}  // namespace
