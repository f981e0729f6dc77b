// SPDX-License-Identifier: MIT
#include "apps/shapes/shapes.h"

#include <gtest/gtest.h>

#include <map>

namespace {

using apps::BasicShape;
using core::Vec3;

/// How often each directed edge occurs, by the places of its ends: seams count as joined.
std::map<std::pair<std::string, std::string>, int> directed_edges(const core::TriangleMesh& mesh) {
    const auto position = [&](std::uint32_t vertex) {
        std::string text;
        for (const double c : mesh.vertices[vertex]) {
            text += std::to_string(std::lround(1e6 * c)) + " ";
        }
        return text;
    };
    std::map<std::pair<std::string, std::string>, int> edges;
    for (const auto& triangle : mesh.triangles) {
        for (const std::size_t i : {0, 1, 2}) {
            ++edges[{position(triangle[i]), position(triangle[(i + 1) % 3])}];
        }
    }
    return edges;
}

double signed_volume(const core::TriangleMesh& mesh) {
    double volume = 0.0;
    for (const auto& [a, b, c] : mesh.triangles) {
        volume += mesh.vertices[a].dot(mesh.vertices[b].cross(mesh.vertices[c])) / 6.0;
    }
    return volume;
}

TEST(BasicShapes, ClosedOnesHaveEveryEdgeOnceInEachDirection) {
    for (const auto& [shape, name] : core::EnumNames<BasicShape>::value) {
        if (shape == BasicShape::Plate) continue;
        const auto edges = directed_edges(apps::make_shape(shape, 24));
        for (const auto& [edge, count] : edges) {
            ASSERT_EQ(count, 1) << name << ": " << edge.first << "-> " << edge.second;
            ASSERT_TRUE(edges.contains({edge.second, edge.first})) << name;
        }
    }
}

TEST(BasicShapes, VolumesApproachTheirClosedForms) {
    const auto volume = [](BasicShape shape) {
        return std::abs(signed_volume(apps::make_shape(shape, 96)));
    };
    const double pi = core::kPi;
    EXPECT_NEAR(volume(BasicShape::Sphere), 4.0 / 3.0 * pi, 0.02);
    EXPECT_NEAR(volume(BasicShape::Box), 2.0 * 2.0 * 1.2, 1e-9);
    EXPECT_NEAR(volume(BasicShape::Cylinder), 0.36 * pi * 2.0, 0.02);
    EXPECT_NEAR(volume(BasicShape::Cone), 0.64 * pi * 2.0 / 3.0, 0.02);
    EXPECT_NEAR(volume(BasicShape::Torus), 2.0 * pi * 0.7 * pi * 0.09, 0.02);
}

TEST(BasicShapes, HaveNoTriangleWithoutAreaAndAreAboutTwoMetresLong) {
    for (const auto& [shape, name] : core::EnumNames<BasicShape>::value) {
        const core::TriangleMesh mesh = apps::make_shape(shape, 24);
        Eigen::AlignedBox3d box;
        for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
        EXPECT_NEAR(box.sizes().maxCoeff(), 2.0, 0.3) << name;
        EXPECT_LE(mesh.triangles.size(), 2u * 24 * 24) << name;
        for (const auto& [a, b, c] : mesh.triangles) {
            ASSERT_TRUE(core::has_area(mesh.vertices[b] - mesh.vertices[a],
                                       mesh.vertices[c] - mesh.vertices[a]))
                << name;
        }
    }
}

}  // namespace
