// SPDX-License-Identifier: MIT
#include "renderer/geometry/planar_patches.h"

#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "tests/support/shift_cases.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <set>

namespace {

using core::Vec2;
using core::Vec3;

// A flat sheet of n x n cells with a square hole, and a folded-up strip along one edge.
renderer::Object sheet_with_hole(int n, const Vec3& origin) {
    renderer::Object object;
    const core::Mat3 turn = Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    const auto vertex = [&](double x, double y, double z) {
        object.mesh.vertices.push_back(origin + turn * Vec3(x, y, z));
    };
    for (int j = 0; j <= n + 1; ++j) {
        for (int i = 0; i <= n; ++i) {
            vertex(double(i) / n, double(std::min(j, n)) / n, j > n ? 0.3 : 0.0);
        }
    }
    const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i < n; ++i) {
            if (i == n / 2 && j == n / 2) continue;
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    }
    return object;
}

class PlanarPatches : public testing::TestWithParam<Vec3> {
 protected:
    renderer::Scene scene_ = test_support::scene_of({sheet_with_hole(8, GetParam())});
    renderer::PlanarPatches patches_{scene_};
    std::uint32_t sheet_ = patches_.patch_of(0);
};

TEST_P(PlanarPatches, JoinWhatLiesInOnePlane) {
    std::set<std::uint32_t> patches;
    for (std::uint32_t f = 0; f < scene_.facets().size(); ++f) patches.insert(patches_.patch_of(f));
    ASSERT_EQ(patches, (std::set<std::uint32_t>{0, 1}));  // the sheet and the strip
    EXPECT_NEAR(patches_.area_m2(sheet_), 1.0 - 1.0 / 64.0, 1e-9);
    EXPECT_NEAR(patches_.area_m2(1 - sheet_), 0.3, 1e-9);
}

TEST_P(PlanarPatches, LocateFindsTheFacetOfAPoint) {
    core::Rng rng(test_support::seed_of("PlanarPatches"), 0, 0);
    for (int i = 0; i < 500; ++i) {
        const auto facet =
            static_cast<std::uint32_t>(rng.uniform() * double(scene_.facets().size()));
        const std::uint32_t patch = patches_.patch_of(facet);
        std::vector<std::uint32_t> of_patch;
        for (std::uint32_t f = 0; f < scene_.facets().size(); ++f) {
            if (patches_.patch_of(f) == patch) of_patch.push_back(f);
        }
        const std::uint32_t elsewhere =
            of_patch[static_cast<std::size_t>(rng.uniform() * double(of_patch.size()))];
        const Vec2 b = core::sample_triangle({rng.uniform(), rng.uniform()});
        const auto found =
            patches_.locate(patch, scene_.facet(facet).point(b.x(), b.y()), elsewhere);
        ASSERT_TRUE(found);
        EXPECT_EQ(*found, facet);
    }
}

TEST_P(PlanarPatches, LocateFindsNothingInTheHoleAndOutside) {
    const renderer::Facet& first =
        scene_.facet(0);  // corner cell, right angle at its second corner
    const Vec3 cell_x = first.edge1;
    const Vec3 cell_y = first.edge2 - first.edge1;
    EXPECT_FALSE(patches_.locate(sheet_, first.corner + 4.5 * cell_x + 4.5 * cell_y, 0));
    EXPECT_FALSE(patches_.locate(sheet_, first.corner - 0.5 * cell_x + 4.5 * cell_y, 0));
    EXPECT_FALSE(patches_.locate(sheet_, first.corner + 4.5 * cell_x + 8.5 * cell_y, 0));
    EXPECT_TRUE(patches_.locate(sheet_, first.corner + 4.5 * cell_x + 5.5 * cell_y, 0));
}

INSTANTIATE_TEST_SUITE_P(NearAndFar,
                         PlanarPatches,
                         testing::Values(Vec3(0, 0, 0), Vec3(1000, -1000, 500)));

}  // namespace
