// SPDX-License-Identifier: MIT
// Facets that are integrated together: what their merged triangle keeps, and what stays apart.
#include "renderer/third_bounce/element_clusters.h"

#include "renderer/third_bounce/third_bounce.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace {

using core::Vec3;
using renderer::SurfaceElement;
using test_support::Parallelogram;

const Parallelogram kSheet{Vec3(-0.2, -0.15, 0.7), Vec3(0.4, 0.05, 0.1), Vec3(-0.05, 0.3, 0), 0.7};

// A parallelogram of cells x cells x 2 facets.
renderer::Object fine_sheet(const Parallelogram& shape, std::uint32_t cells) {
    renderer::Object object;
    object.material.albedo = shape.albedo;
    const auto at = [&](std::uint32_t i, std::uint32_t j) { return j * (cells + 1) + i; };
    for (std::uint32_t j = 0; j <= cells; ++j) {
        for (std::uint32_t i = 0; i <= cells; ++i) {
            object.mesh.vertices.push_back(shape.corner + shape.u * i / cells +
                                           shape.v * j / cells);
            if (i == cells || j == cells) continue;
            object.mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            object.mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return object;
}

core::WallScan grid_scan() {
    std::vector<Vec3> points;
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j < 6; ++j) points.emplace_back(0.15 * i - 0.375, 0.15 * j - 0.375, 0.0);
    }
    return test_support::confocal_scan(points);
}

renderer::Scene scene_of(std::vector<renderer::Object> objects, const core::WallScan& scan) {
    return {{std::move(objects), {}}, scan, renderer::RelayWall{}};
}

std::vector<SurfaceElement> elements_of(const renderer::Scene& scene) {
    std::vector<SurfaceElement> elements;
    for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
        if (!scene.is_hidden(i)) continue;
        const auto& mesh = scene.object_of(i).mesh;
        const auto& triangle = mesh.triangles[scene.facet(i).triangle];
        elements.push_back(
            {{mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]},
             i});
    }
    return elements;
}

renderer::ElementClusters merge(const renderer::Scene& scene,
                                const std::vector<SurfaceElement>& elements,
                                const std::vector<std::uint32_t>& clusters) {
    return renderer::merge_elements(
        scene, elements, clusters, renderer::adjacent_elements(elements));
}

double area_of(const SurfaceElement& element) {
    return core::triangle_area_vector(element.corners[0], element.corners[1], element.corners[2])
        .norm();
}

// The integral of (a + b.x)^2 over a triangle of the given area: midpoints are exact.
double integral_over(const SurfaceElement& element, double area) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        sum += std::pow(0.3 + Vec3(0.7, -1.1, 0.4).dot(element.midpoint(i)), 2);
    }
    return area * sum / 3.0;
}

TEST(ElementClusters, KeepIntegralsOfQuadraticFunctionsOnAPlane) {
    const auto scan = grid_scan();
    const auto scene = scene_of({fine_sheet(kSheet, 5)}, scan);
    const std::vector<SurfaceElement> elements = elements_of(scene);
    std::vector<std::uint32_t> clusters(elements.size());
    // Lopsided ones: 3, 9 and 38 of the 50 facets.
    for (std::size_t i = 0; i < clusters.size(); ++i) clusters[i] = i < 3 ? 0 : i < 12 ? 1 : 2;
    const auto merged = merge(scene, elements, clusters);
    std::vector<double> expected(merged.elements.size(), 0.0);
    std::vector<double> area(merged.elements.size(), 0.0);
    for (std::size_t i = 0; i < elements.size(); ++i) {
        expected[merged.merged_of[i]] += integral_over(elements[i], area_of(elements[i]));
        area[merged.merged_of[i]] += area_of(elements[i]);
    }
    EXPECT_LE(merged.elements.size(), 6U);  // some facets touch theirs by a corner only
    for (std::size_t m = 0; m < merged.elements.size(); ++m) {
        const auto& element = merged.elements[m];
        EXPECT_NEAR(element.area_m2, area[m], 1e-14);
        EXPECT_NEAR(
            integral_over(element.triangle, element.area_m2), expected[m], 1e-12 * expected[m]);
        EXPECT_LT(element.rise_m, 1e-12);
    }
}

TEST(ElementClusters, OnlyNeighboursAreMerged) {
    const auto scan = grid_scan();
    Parallelogram behind = kSheet;
    behind.corner.z() += 1e-3;
    // One object of two sheets, a millimetre apart.
    renderer::Object object = fine_sheet(kSheet, 4);
    const renderer::Object second = fine_sheet(behind, 4);
    const auto offset = static_cast<std::uint32_t>(object.mesh.vertices.size());
    for (const Vec3& vertex : second.mesh.vertices) object.mesh.vertices.push_back(vertex);
    for (const auto& t : second.mesh.triangles) {
        object.mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    }
    const auto scene = scene_of({object}, scan);
    const std::vector<SurfaceElement> elements = elements_of(scene);
    const auto merged = merge(scene, elements, std::vector<std::uint32_t>(elements.size(), 0));
    ASSERT_EQ(merged.elements.size(), 2U);
    EXPECT_NEAR(
        (merged.elements[0].triangle.center() - merged.elements[1].triangle.center()).norm(),
        1e-3,
        1e-9);
}

// Every one has neighbours to compare with, and all hang together.
TEST(ElementAdjacency, CoincidingTrianglesHaveFewNeighboursEach) {
    constexpr std::uint32_t kCount = 20'000;
    SurfaceElement triangle;
    triangle.corners = {Vec3(-0.2, -0.2, 0.8), Vec3(0.2, -0.2, 0.8), Vec3(0.0, 0.2, 0.8)};
    const auto pairs = renderer::adjacent_elements(std::vector<SurfaceElement>(kCount, triangle));
    EXPECT_LE(pairs.size(), 3U * kCount);
    const auto lists = renderer::adjacency_lists(kCount, pairs);
    std::vector<bool> reached(kCount);
    std::vector<std::uint32_t> open{0};
    reached[0] = true;
    for (std::size_t next = 0; next < open.size(); ++next) {
        for (const std::uint32_t neighbour : lists.of(open[next])) {
            if (reached[neighbour]) continue;
            reached[neighbour] = true;
            open.push_back(neighbour);
        }
    }
    EXPECT_EQ(open.size(), kCount);
}

TEST(ElementClusters, ClustersKeepToTheirSizeTiltAndObject) {
    const auto scan = grid_scan();
    const auto scene = scene_of({test_support::sphere_object(Vec3(0, 0, 0.7), 0.2, 4, 0.5),
                                 test_support::sphere_object(Vec3(0.1, 0, 0.7), 0.2, 4, 0.5)},
                                scan);
    const std::vector<SurfaceElement> elements = elements_of(scene);
    constexpr double kSize = 0.07;
    constexpr double kSquaredTilt = 0.01;
    const auto is_wanted = [](const Vec3& center) { return center.y() < 0.1; };
    const auto clusters = renderer::cluster_elements(
        scene, elements, {kSize, kSquaredTilt}, [&](const Vec3& center, double diameter) {
            EXPECT_LE(diameter, kSize);
            return is_wanted(center);
        });
    const std::size_t num_clusters = 1 + *std::max_element(clusters.begin(), clusters.end());
    EXPECT_LT(num_clusters, elements.size() / 2);
    for (std::uint32_t c = 0; c < num_clusters; ++c) {
        Eigen::AlignedBox3d box;
        std::set<std::uint32_t> objects;
        Vec3 normals = Vec3::Zero();
        double area = 0.0;
        const bool is_single = std::count(clusters.begin(), clusters.end(), c) == 1;
        for (std::size_t i = 0; i < elements.size(); ++i) {
            if (clusters[i] != c) continue;
            for (const Vec3& corner : elements[i].corners) box.extend(corner);
            objects.insert(scene.facet(elements[i].facet).object);
            normals += area_of(elements[i]) * scene.facet(elements[i].facet).normal;
            area += area_of(elements[i]);
        }
        EXPECT_TRUE(is_single || is_wanted(box.center()));
        EXPECT_LE(box.diagonal().norm(), kSize);
        EXPECT_EQ(objects.size(), 1U);
        EXPECT_GE(normals.squaredNorm() / (area * area), 1.0 - kSquaredTilt - 1e-12);
    }
}

renderer::ThirdBounce integrate(const renderer::Scene& scene,
                                const core::WallScan& scan,
                                const core::TimeAxis& axis,
                                double target) {
    renderer::RenderSettings settings;
    settings.target_error = target;
    return integrate_third_bounce(scene, scan, axis, settings, {});
}

void expect_targets_met(const renderer::Scene& scene,
                        const core::WallScan& scan,
                        const core::TimeAxis& axis,
                        const renderer::ThirdBounce& reference,
                        std::size_t most_elements) {
    for (const double target : {0.05, 0.02, 0.01}) {
        const auto result = integrate(scene, scan, axis, target);
        EXPECT_LT(result.num_elements, most_elements);
        EXPECT_LT(
            test_support::relative_l2(result.transient.values(), reference.transient.values()),
            target);
    }
}

// Against the same sheet of two facets, which are bisected, behind an occluder.
TEST(ElementClusters, FineMeshMeetsTheTargetWithAFractionOfItsFacets) {
    constexpr std::uint32_t kCells = 150;
    const auto scan = grid_scan();
    const core::TimeAxis axis{1.0, 0.02, 80};
    const Parallelogram occluder{
        Vec3(-0.05, -0.1, 0.4), Vec3(0.15, 0, 0.02), Vec3(0.02, 0.2, 0), 0.0};
    const auto hiding = test_support::parallelogram_object(occluder);
    const auto coarse = scene_of({test_support::parallelogram_object(kSheet), hiding}, scan);
    const auto fine = scene_of({fine_sheet(kSheet, kCells), hiding}, scan);
    expect_targets_met(fine, scan, axis, integrate(coarse, scan, axis, 1e-3), kCells * kCells / 4);
}

// Curved: against the same facets, so little merged that they hardly differ.
TEST(ElementClusters, FineBallMeetsTheTarget) {
    const auto scan = grid_scan();
    const core::TimeAxis axis{0.6, 0.02, 80};
    const auto scene = scene_of({test_support::sphere_object(Vec3(0.05, 0, 0.6), 0.15, 6, 0.5),
                                 test_support::sphere_object(Vec3(-0.1, 0, 0.35), 0.05, 5, 0.5)},
                                scan);
    const auto reference = integrate(scene, scan, axis, 1e-3);
    expect_targets_met(scene, scan, axis, reference, reference.num_elements / 2);
}

}  // namespace
