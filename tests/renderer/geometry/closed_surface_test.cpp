// SPDX-License-Identifier: MIT
#include "renderer/geometry/closed_surface.h"

#include "tests/renderer/third_bounce/third_bounce_fixture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;
using renderer::Object;

/// A closed box, its normals pointing outwards or inwards.
Object box_at(const Vec3& low, bool points_outwards) {
    Object box = third_bounce_test::box_object(low, low + Vec3::Constant(0.1));
    if (points_outwards) return box;
    for (auto& triangle : box.mesh.triangles) std::swap(triangle[1], triangle[2]);
    return box;
}

Object joined(const Object& a, const Object& b) {
    Object both = a;
    core::append_mesh(b.mesh, both.mesh);
    return both;
}

int side_of(const Object& object) {
    const std::vector<Vec3> wall{Vec3(0.0, 0.0, 0.0), Vec3(0.5, 0.5, 0.0)};
    return renderer::visible_sides({&object, 1}, wall).front();
}

const Vec3 kHere(-0.2, 0.0, 0.7);
const Vec3 kThere(0.15, 0.05, 0.6);

TEST(ClosedSurface, ShowsTheSideThatItsNormalsPointTo) {
    EXPECT_EQ(side_of(box_at(kHere, true)), 1);
    EXPECT_EQ(side_of(box_at(kHere, false)), -1);
    EXPECT_EQ(side_of(joined(box_at(kHere, true), box_at(kThere, true))), 1);
    EXPECT_EQ(side_of(joined(box_at(kHere, false), box_at(kThere, false))), -1);
}

TEST(ClosedSurface, ShowsBothWhereItsPartsDiffer) {
    EXPECT_EQ(side_of(joined(box_at(kHere, true), box_at(kThere, false))), 0);
    Object open = box_at(kHere, true);
    open.mesh.triangles.pop_back();
    EXPECT_EQ(side_of(open), 0);
    EXPECT_EQ(side_of(box_at(Vec3(-0.05, -0.05, -0.05), true)), 0) << "around a wall point";
}

// Which boxes are one object, and how they are wound, changes no light.
TEST(ClosedSurface, WindingOfAPartChangesNoLight) {
    const core::WallScan scan = test_support::confocal_scan(test_support::kThreeWallPoints);
    const auto rendered = [&](std::vector<Object> objects) {
        const auto result =
            renderer::render(third_bounce_test::scene_of({std::move(objects), {}}, scan),
                             scan,
                             third_bounce_test::kAxis,
                             third_bounce_test::settings_for(1e-4),
                             {});
        const auto values = result.capture.transient.values();
        return std::vector<float>(values.begin(), values.end());
    };
    const std::vector<float> apart = rendered({box_at(kHere, true), box_at(kThere, true)});
    const std::vector<float> mixed = rendered({joined(box_at(kHere, true), box_at(kThere, false))});
    double error = 0.0;
    double norm = 0.0;
    for (std::size_t i = 0; i < apart.size(); ++i) {
        error += std::pow(double{mixed[i]} - double{apart[i]}, 2);
        norm += std::pow(double{apart[i]}, 2);
    }
    EXPECT_LT(std::sqrt(error / norm), 5e-4) << "within the errors asked for";
}

}  // namespace
