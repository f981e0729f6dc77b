// SPDX-License-Identifier: MIT
#include "renderer/scene/coincident_faces.h"

#include "renderer/core/random.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace {

using core::Vec3;
using renderer::CoincidentFaces;
using renderer::Object;
using test_support::parallelogram_object;

Object panel(const char* name, const Vec3& corner, const Vec3& u, const Vec3& v) {
    Object object = parallelogram_object({corner, u, v});
    object.name = name;
    return object;
}

/// A tilted panel of 0.35 m^2 or so.
Object tilted(const char* name) {
    return panel(name, {-0.2, -0.1, 0.6}, {0.5, 0.03, 0.02}, {-0.04, 0.35, 0.1});
}

/// A panel of n x n squares of two triangles each.
Object grid(const char* name, const Vec3& corner, const Vec3& u, const Vec3& v, std::uint32_t n) {
    Object object;
    object.name = name;
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j) {
            object.mesh.vertices.push_back(corner + i / double(n) * u + j / double(n) * v);
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t at = i * (n + 1) + j;
            object.mesh.triangles.push_back({at, at + n + 1, at + n + 2});
            object.mesh.triangles.push_back({at, at + n + 2, at + 1});
        }
    }
    return object;
}

double area_m2(const std::vector<Object>& objects) {
    double area = 0.0;
    for (const Object& object : objects) {
        const auto& vertices = object.mesh.vertices;
        for (const auto& [a, b, c] : object.mesh.triangles) {
            area += core::triangle_area_vector(vertices[a], vertices[b], vertices[c]).norm();
        }
    }
    return area;
}

std::vector<CoincidentFaces> leave_out(std::vector<Object>& objects) {
    return leave_out_covered_faces(
        objects, renderer::FacePrecedence(objects), renderer::coincidence_m(objects, {}));
}

/// What is left of the panel and `other`.
std::vector<Object> left_beside_the_panel(Object other) {
    std::vector<Object> objects{tilted("panel"), std::move(other)};
    leave_out(objects);
    return objects;
}

void expect_only_the_panel(const Object& other) {
    const std::vector<Object> left = left_beside_the_panel(other);
    ASSERT_EQ(left.size(), 1);
    EXPECT_EQ(left[0].name, "panel");
    EXPECT_EQ(left[0].mesh.triangles, tilted("").mesh.triangles);
}

void expect_both(const Object& other) {
    const std::vector<Object> left = left_beside_the_panel(other);
    ASSERT_EQ(left.size(), 2);
    EXPECT_EQ(left[1].mesh.triangles, other.mesh.triangles);
}

TEST(CoincidentFaces, FacesOfOneMeshCountOnceInEitherWinding) {
    for (const bool is_turned : {false, true}) {
        std::vector<Object> objects{tilted("panel")};
        const auto once = objects[0].mesh.triangles;
        for (const auto& [a, b, c] : once) {
            objects[0].mesh.triangles.push_back(is_turned ? std::array{c, b, a}
                                                          : std::array{b, c, a});
        }
        const std::vector<CoincidentFaces> faces = leave_out(objects);
        EXPECT_EQ(objects[0].mesh.triangles, once);
        EXPECT_EQ(renderer::describe(faces),
                  "faces at one place count once: 2 of 4 faces of panel lie on others of it");
    }
}

TEST(CoincidentFaces, TheFirstOfTwoObjectsCounts) {
    expect_only_the_panel(tilted("copy"));
}

TEST(CoincidentFaces, OtherTrianglesOfThePolygonCountOnce) {
    Object other = tilted("other diagonal");
    other.mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
    expect_only_the_panel(other);
    Object fan = tilted("fan");
    fan.mesh.vertices.push_back(0.3 * fan.mesh.vertices[0] + 0.7 * fan.mesh.vertices[2]);
    fan.mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    expect_only_the_panel(fan);
    const auto& corners = fan.mesh.vertices;
    expect_only_the_panel(
        grid("grid", corners[0], corners[1] - corners[0], corners[3] - corners[0], 30));
}

TEST(CoincidentFaces, AFineGridCountsForThePanelBehindIt) {
    const auto& corners = tilted("").mesh.vertices;
    std::vector<Object> objects{
        grid("grid", corners[0], corners[1] - corners[0], corners[3] - corners[0], 30),
        tilted("panel")};
    leave_out(objects);
    ASSERT_EQ(objects.size(), 1);
    EXPECT_EQ(objects[0].name, "grid");
}

TEST(CoincidentFaces, SheetsATenthOfAMicrometreApartAreOne) {
    for (const Vec3& way : {Vec3(0, 0, 1e-7), Vec3(0, 0, -1e-7), Vec3(1e-7, -5e-8, 0)}) {
        Object other = tilted("other");
        for (Vec3& vertex : other.mesh.vertices) vertex += way;
        expect_only_the_panel(other);
    }
}

TEST(CoincidentFaces, SheetsADistanceApartStay) {
    for (const double way_m : {2e-5, -2e-5, 1e-3}) {
        Object other = tilted("other");
        for (Vec3& vertex : other.mesh.vertices) vertex.z() += way_m;
        expect_both(other);
    }
}

TEST(CoincidentFaces, ABladeStays) {
    Object other = tilted("other");  // fractions an edge, and opens by a milliradian
    other.mesh.vertices[2].z() += 3.5e-4;
    other.mesh.vertices[3].z() += 3.5e-4;
    expect_both(other);
}

TEST(CoincidentFaces, NeighboursThatTouchStay) {
    std::vector<Object> objects{
        grid("flat", {-0.3, -0.2, 0.7}, {0.61, 0.04, 0.0}, {0.02, 0.43, 0.07}, 40),
        test_support::sphere_object({0.1, 0.2, 1.5}, 0.3, 4, 1.0)};
    const std::size_t faces = objects[1].mesh.triangles.size();
    EXPECT_TRUE(leave_out(objects).empty());
    EXPECT_EQ(objects[0].mesh.triangles.size(), 3200);
    EXPECT_EQ(objects[1].mesh.triangles.size(), faces);
}

TEST(CoincidentFaces, NeedlesNarrowerThanTheToleranceStay) {
    Object fan;  // of a disc of 1 mm in a scene of 100 m
    fan.name = "fan";
    fan.mesh.vertices.push_back({0, 0, 1});
    constexpr std::uint32_t kNeedles = 2000;
    for (std::uint32_t i = 0; i < kNeedles; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kNeedles;
        fan.mesh.vertices.push_back({1e-3 * std::cos(angle), 1e-3 * std::sin(angle), 1});
        fan.mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % kNeedles});
    }
    std::vector<Object> objects{fan, panel("floor", {-50, -3, -50}, {100, 0, 0}, {0, 0, 100})};
    EXPECT_TRUE(leave_out(objects).empty());
    EXPECT_EQ(objects[0].mesh.triangles.size(), kNeedles);
}

TEST(CoincidentFaces, OverlappingPanelsHaveTheAreaOfTheirUnion) {
    // Rectangles of whole tenths in a tilted plane: squares count what they cover.
    const Vec3 corner(-0.4, -0.3, 0.8);
    const Vec3 u = Vec3(0.8, 0.1, 0.2).normalized();
    const Vec3 v = Vec3(0.1, -0.9, 0.1).cross(u).normalized();
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        core::Rng rng(seed, 0, 0);
        std::vector<Object> objects;
        std::vector<bool> is_covered(100);
        for (int i = 0; i < 6; ++i) {
            const auto number = [&](int most) { return int(rng.uniform() * most); };
            const int x = number(8), y = number(8);
            const int w = 1 + number(9 - x), h = 1 + number(9 - y);
            objects.push_back(
                panel("panel", corner + 0.1 * x * u + 0.1 * y * v, 0.1 * w * u, 0.1 * h * v));
            for (int p = x; p < x + w; ++p) {
                for (int q = y; q < y + h; ++q) is_covered[std::size_t(10 * p + q)] = true;
            }
        }
        const auto squares = double(std::count(is_covered.begin(), is_covered.end(), true));
        leave_out(objects);
        EXPECT_NEAR(area_m2(objects), 0.01 * squares, 1e-6) << "seed " << seed;
    }
}

TEST(CoincidentFaces, AFloorIsCutWhereManyFacesStandOnIt) {
    std::vector<Object> objects{grid("foot", {-0.31, -0.5, 0.7}, {0.3, 0, 0.1}, {-0.1, 0, 0.3}, 60),
                                panel("floor", {-1, -0.5, 0.2}, {2, 0, 0}, {0, 0, 1.5})};
    const std::vector<CoincidentFaces> faces = leave_out(objects);
    EXPECT_NEAR(area_m2(objects), 3.0, 1e-6);
    EXPECT_LT(objects[1].mesh.triangles.size(), 2000);
    EXPECT_EQ(renderer::describe(faces),
              "faces at one place count once: a part of 2 of 2 faces of floor lie on foot");
}

TEST(CoincidentFaces, ManyFacesOnAFloorAreLeftOut) {
    std::vector<Object> objects{
        panel("floor", {-1, -0.5, 0.2}, {2, 0, 0}, {0, 0, 1.5}),
        grid("foot", {-0.31, -0.5, 0.7}, {0.3, 0, 0.1}, {-0.1, 0, 0.3}, 60)};
    leave_out(objects);
    ASSERT_EQ(objects.size(), 1);
    EXPECT_EQ(objects[0].mesh.triangles.size(), 2);
}

TEST(CoincidentFaces, TextureCoordinatesAreCutToo) {
    Object floor = panel("floor", {0, 0, 1}, {2, 0, 0}, {0, 2, 0});
    floor.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    std::vector<Object> objects{panel("box", {0.5, 0.25, 1}, {1, 0, 0}, {0, 1, 0}), floor};
    leave_out(objects);
    const Object& cut = objects[1];
    ASSERT_EQ(cut.uv.size(), cut.mesh.vertices.size());
    ASSERT_GT(cut.uv.size(), 4);
    for (std::size_t i = 0; i < cut.uv.size(); ++i) {
        EXPECT_NEAR(cut.uv[i].x(), 0.5 * cut.mesh.vertices[i].x(), 1e-12);
        EXPECT_NEAR(cut.uv[i].y(), 0.5 * cut.mesh.vertices[i].y(), 1e-12);
    }
}

TEST(CoincidentFaces, ObjectsThatMoveApartBothCount) {
    Object other = tilted("other");
    other.velocity_m_per_s = {0, 0, 0.1};
    expect_both(other);
}

TEST(CoincidentFaces, TheRelayWallCountsBeforeAllOthers) {
    Object wall = tilted("wall");
    wall.role = renderer::Role::RelayWall;
    std::vector<Object> objects{tilted("hidden"), wall};
    leave_out(objects);
    ASSERT_EQ(objects.size(), 1);
    EXPECT_EQ(objects[0].name, "wall");
}

TEST(CoincidentFaces, AThousandKilometresAwayNothingChanges) {
    const Vec3 far(8e5, -6e5, 1e4);
    std::vector<Object> objects{tilted("panel"), tilted("copy"), tilted("sheet")};
    objects[1].mesh.triangles = {{0, 1, 3}, {1, 2, 3}};
    for (Object& object : objects) {
        for (Vec3& vertex : object.mesh.vertices) vertex += far;
    }
    for (Vec3& vertex : objects[2].mesh.vertices) vertex.z() += 2e-5;
    leave_out(objects);
    ASSERT_EQ(objects.size(), 2);
    EXPECT_EQ(objects[0].name, "panel");
    EXPECT_EQ(objects[1].name, "sheet");
}

TEST(CoincidentFaces, ManyObjectsAreSummedUp) {
    std::vector<Object> objects{tilted("panel")};
    for (const char* name : {"a", "b", "b", "c", "d", "e"}) objects.push_back(tilted(name));
    EXPECT_EQ(renderer::describe(leave_out(objects)),
              "faces at one place count once: 2 of 2 faces of a lie on panel, 4 of 4 faces of b "
              "lie on panel, 2 of 2 faces of c lie on panel, 2 of 2 faces of d lie on panel, and "
              "so on for 1 objects more");
}

}  // namespace
