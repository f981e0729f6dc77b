// SPDX-License-Identifier: MIT
// What wall points see of meshes, in closed form and against rays, and how its corners move.
#include "calib/adjoint/pair_evaluator.h"
#include "tests/support/occluded_meshes.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace {

using calib::CutPlane;
using core::Vec3;
using test_support::OccludedMesh;
using test_support::Parallelogram;
using test_support::random_point;

const core::TimeAxis kAnyLength{0.0, 0.1, 100};

// Areas of facets that both ends of the first pair see.
std::vector<double> visible_areas(const OccludedMesh& shapes, const core::WallScan& scan) {
    const calib::FacetTree tree(shapes.mesh);
    const auto elements = calib::cut_mesh(shapes.mesh, tree, scan, 0.02, 0.05);
    const calib::AdjointScene scene{
        shapes.mesh, shapes.albedo, tree, elements, scan, kAnyLength, 1.0, 0.0};
    return calib::PairEvaluator(scene).visible_areas(0);
}

double visible_area(const OccludedMesh& shapes,
                    const core::WallScan& scan,
                    std::size_t num_facets) {
    const auto areas = visible_areas(shapes, scan);
    return std::accumulate(
        areas.begin(), areas.begin() + static_cast<std::ptrdiff_t>(num_facets), 0.0);
}

OccludedMesh shapes_of(const std::vector<Parallelogram>& shapes) {
    OccludedMesh result;
    for (const Parallelogram& shape : shapes) result.add(shape);
    return result;
}

const Parallelogram kSheet{{-0.5, -0.5, 1.0}, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};

core::WallScan one_point(const Vec3& position) {
    return test_support::confocal_scan({position});
}

TEST(VisibleAreas, AShadowGrowsWithTheDistance) {
    const auto shapes = shapes_of({kSheet, {{-0.05, -0.1, 0.5}, {0.1, 0, 0}, {0, 0.2, 0}}});
    EXPECT_NEAR(visible_area(shapes, one_point(Vec3::Zero()), 2), 1.0 - 0.2 * 0.4, 1e-12);
    // Shifted half beyond the sheet.
    EXPECT_NEAR(visible_area(shapes, one_point(Vec3(0.5, 0.1, 0)), 2), 1.0 - 0.1 * 0.4, 1e-12);
}

TEST(VisibleAreas, BothEndsCastShadows) {
    const auto shapes = shapes_of({kSheet, {{-0.05, -0.1, 0.5}, {0.1, 0, 0}, {0, 0.2, 0}}});
    const core::WallScan apart = test_support::single_scan(Vec3(-0.15, 0, 0), {Vec3(0.15, 0, 0)});
    EXPECT_NEAR(visible_area(shapes, apart, 2), 1.0 - 2.0 * 0.2 * 0.4, 1e-12);
    const core::WallScan close = test_support::single_scan(Vec3(-0.05, 0, 0), {Vec3(0.05, 0, 0)});
    EXPECT_NEAR(visible_area(shapes, close, 2), 1.0 - 0.3 * 0.4, 1e-12);
}

TEST(VisibleAreas, ManySmallShadowsAreAllFound) {
    OccludedMesh shapes = shapes_of({kSheet});
    constexpr int kSide = 20;
    for (int i = 0; i < kSide * kSide; ++i) {
        const Vec3 corner(0.024 * (i / kSide - 10) + 0.001, 0.024 * (i % kSide - 10) + 0.002, 0.5);
        shapes.add({corner, corner + Vec3(0.01, 0.001, 0), corner + Vec3(0.002, 0.02, 0)},
                   {{0, 1, 2}},
                   0.0);
    }
    const double shadow = 4.0 * 0.5 * (0.01 * 0.02 - 0.001 * 0.002);
    EXPECT_NEAR(
        visible_area(shapes, one_point(Vec3::Zero()), 2), 1.0 - kSide * kSide * shadow, 1e-11);
}

TEST(VisibleAreas, AnOccluderHidesOnlyBehindWhereItPierces) {
    const Parallelogram piercing{{0.0, -2.0, 0.8}, {0.0, 4.0, 0.0}, {0.0, 0.0, 0.4}};
    const auto shapes = shapes_of({kSheet, piercing});
    // A ray to (x, y, 1) meets the plane x = 0 at 0.3 / (0.3 + x), hidden from 0.8 on.
    EXPECT_NEAR(visible_area(shapes, one_point(Vec3(-0.3, 0, 0)), 2), 1.0 - 0.075, 1e-12);
}

TEST(VisibleAreas, AnOccluderMayTouchTheWall) {
    const Parallelogram standing{{0.0, -2.0, 0.0}, {0.0, 4.0, 0.0}, {0.0, 0.0, 0.5}};
    const auto shapes = shapes_of({kSheet, standing});
    EXPECT_NEAR(visible_area(shapes, one_point(Vec3(-0.3, 0, 0)), 2), 0.8, 1e-12);
    // The same one below the wall, too.
    const Parallelogram through{{0.0, -2.0, -1.0}, {0.0, 4.0, 0.0}, {0.0, 0.0, 1.5}};
    EXPECT_NEAR(
        visible_area(shapes_of({kSheet, through}), one_point(Vec3(-0.3, 0, 0)), 2), 0.8, 1e-12);
}

TEST(VisibleAreas, WhatLiesBehindTheWallIsNotSeen) {
    const auto shapes = shapes_of({{{0.3, -0.5, -0.4}, {0.0, 1.0, 0.0}, {0.1, 0.0, 1.0}}});
    const double length = std::hypot(0.1, 1.0);
    EXPECT_NEAR(visible_area(shapes, one_point(Vec3::Zero()), 2), 0.6 * length, 1e-12);
}

TEST(VisibleAreas, AFacetSeenEdgeOnNeitherShowsNorHides) {
    const auto shapes = shapes_of({kSheet, {{0.0, -0.1, 0.5}, {0.0, 0.2, 0.0}, {0.0, 0.0, 0.2}}});
    const auto areas = visible_areas(shapes, one_point(Vec3::Zero()));
    EXPECT_NEAR(areas[0] + areas[1], 1.0, 1e-12);
    EXPECT_EQ(areas[2] + areas[3], 0.0);
}

// Neighbours share edges and vertices, and do not hide one another.
TEST(VisibleAreas, AConvexBodyHidesExactlyItsBack) {
    core::Rng rng(test_support::seed_of("convex"), 0, 0);
    const auto sphere = test_support::sphere_object(Vec3(0.1, -0.05, 0.6), 0.25, 3, 1.0);
    OccludedMesh shapes;
    shapes.add(sphere.mesh.vertices, sphere.mesh.triangles, 1.0);
    for (int i = 0; i < 5; ++i) {
        const Vec3 wall(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.0);
        const auto areas = visible_areas(shapes, one_point(wall));
        for (std::size_t f = 0; f < areas.size(); ++f) {
            const auto& [a, b, c] = shapes.mesh.triangles[f];
            const auto& v = shapes.mesh.vertices;
            Vec3 area = core::triangle_area_vector(v[a], v[b], v[c]);
            if (area.dot(v[a] - Vec3(0.1, -0.05, 0.6)) < 0.0) area = -area;
            const bool is_front = area.dot(wall - v[a]) > 0.0;
            EXPECT_NEAR(areas[f], is_front ? area.norm() : 0.0, 1e-12) << f;
        }
    }
}

// Whether a facet lies between two points, one of them on facet `own`.
bool is_hidden(const core::TriangleMesh& mesh, std::size_t own, const Vec3& from, const Vec3& to) {
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        if (f == own) continue;
        const auto& [a, b, c] = mesh.triangles[f];
        core::Mat3 basis;
        basis << mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a],
            from - to;
        const Vec3 x = basis.inverse() * (from - mesh.vertices[a]);
        const bool hits = x[0] > 0.0 && x[1] > 0.0 && x[0] + x[1] < 1.0;
        if (hits && x[2] > 1e-9 && x[2] < 1.0 - 1e-9) return true;
    }
    return false;
}

TEST(VisibleAreas, AgreeWithRays) {
    constexpr int kRays = 4000;
    constexpr double kLargestError = 5.0 * 0.5;  // 5 standard deviations of a fraction of 1/2
    double sum = 0.0;
    double expected_sum = 0.0;
    for (std::uint64_t number = 0; number < 12; ++number) {
        core::Rng rng(test_support::seed_of("rays"), number, 0);
        const OccludedMesh shapes = test_support::random_occluded_mesh(rng);
        const auto point = [&] { return Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.0); };
        const core::WallScan scan = test_support::single_scan(point(), {point()});
        const auto areas = visible_areas(shapes, scan);
        for (std::size_t f = 0; f < areas.size(); ++f) {
            const auto& [a, b, c] = shapes.mesh.triangles[f];
            const auto& v = shapes.mesh.vertices;
            const Vec3 area = core::triangle_area_vector(v[a], v[b], v[c]);
            const auto side = [&](const Vec3& wall) { return area.dot(wall - v[a]) > 0.0; };
            const Vec3& light = scan.illumination.positions[0];
            const Vec3& sensor = scan.sensing.positions[0];
            int seen = 0;
            for (int i = 0; i < kRays && side(light) == side(sensor); ++i) {
                const double root = std::sqrt(rng.uniform());
                const double fraction = rng.uniform();
                const Vec3 x =
                    (1.0 - root) * v[a] + root * ((1.0 - fraction) * v[b] + fraction * v[c]);
                seen +=
                    !is_hidden(shapes.mesh, f, light, x) && !is_hidden(shapes.mesh, f, sensor, x);
            }
            const double expected = area.norm() * seen / kRays;
            EXPECT_NEAR(areas[f], expected, kLargestError * area.norm() / std::sqrt(double{kRays}))
                << "case " << number << ", facet " << f;
            sum += areas[f];
            expected_sum += expected;
        }
    }
    EXPECT_NEAR(sum / expected_sum, 1.0, 0.005);
}

TEST(PairEvaluator, PullsTheSameWithAndWithoutWhatItSaw) {
    core::Rng rng(test_support::seed_of("seen"), 0, 0);
    const OccludedMesh shapes = test_support::random_occluded_mesh(rng);
    const core::WallScan scan = test_support::single_scan(Vec3(-0.2, 0, 0), {Vec3(0.15, 0, 0)});
    const calib::FacetTree tree(shapes.mesh);
    const auto elements = calib::cut_mesh(shapes.mesh, tree, scan, 0.02, 0.01);
    const calib::AdjointScene scene{
        shapes.mesh, shapes.albedo, tree, elements, scan, kAnyLength, 1.0, 0.0};
    calib::PairEvaluator evaluator(scene);
    std::vector<double> histogram(100, 0.0);
    std::vector<calib::ElementVisibility> seen(elements.size());
    evaluator.add(0, histogram, seen);
    for (const auto kind : {calib::ElementVisibility::Hidden,
                            calib::ElementVisibility::Whole,
                            calib::ElementVisibility::Part}) {
        EXPECT_GT(std::count(seen.begin(), seen.end(), kind), 0);
    }
    calib::MeshGradients with(shapes.mesh);
    calib::MeshGradients without(shapes.mesh);
    evaluator.pull(0, histogram, seen, with);
    evaluator.pull(0, histogram, {}, without);
    EXPECT_EQ(with.vertices, without.vertices);
    EXPECT_EQ(with.albedo, without.albedo);
}

/// The visible polygons of a facet from one wall point, and a random linear function of their
/// corners.
struct PolygonCase {
    core::TriangleMesh mesh;
    std::uint32_t facet;
    calib::MovedWallPoint wall;
    calib::PolygonClipper polygons;

    void cut() {
        const calib::FacetTree tree(mesh);
        calib::OccluderViews views(mesh, tree);
        views.look_from(wall, 0);
        const auto& [a, b, c] = mesh.triangles[facet];
        const calib::MeshElement element{
            facet,
            {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
            calib::element_shape({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]}),
            0.0};
        views.look_at({&element, 1});
        const auto view = views.view(element.shape);
        polygons.start(view.margin_m);
        views.remove_shadows(0, view, polygons);
    }

    std::vector<std::vector<Vec3>> weights() const {
        core::Rng rng(test_support::seed_of("weights"), facet, 0);
        std::vector<std::vector<Vec3>> result(polygons.num_polygons());
        for (std::size_t i = 0; i < result.size(); ++i) {
            for (std::size_t k = 0; k < polygons.polygon(i).size(); ++k) {
                result[i].push_back(random_point(rng));
            }
        }
        return result;
    }
    double value() {
        cut();
        const auto factors = weights();
        double sum = 0.0;
        for (std::size_t i = 0; i < factors.size(); ++i) {
            for (std::size_t k = 0; k < factors[i].size(); ++k) {
                sum += factors[i][k].dot(polygons.polygon(i)[k].barycentric);
            }
        }
        return sum;
    }
    std::vector<Vec3> gradients() {
        cut();
        calib::CutPullback cuts;
        cuts.start(polygons.lines());
        const auto factors = weights();
        for (std::size_t i = 0; i < factors.size(); ++i) {
            cuts.add_polygon(polygons.polygon(i), factors[i]);
        }
        std::vector<Vec3> by_vertices(mesh.vertices.size(), Vec3::Zero());
        std::array<Vec3, 3> by_corners{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
        const auto& triangle = mesh.triangles[facet];
        cuts.finish(
            {&wall, 1},
            {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]},
            mesh.vertices,
            by_corners,
            by_vertices);
        for (std::size_t j = 0; j < 3; ++j) by_vertices[triangle[j]] += by_corners[j];
        return by_vertices;
    }
};

TEST(VisiblePolygons, CornersMoveAsDifferencesSay) {
    constexpr double kStep_m = 1e-6;
    int num_shadows = 0;
    int num_pierced = 0;
    for (std::uint64_t number = 0; number < 6; ++number) {
        core::Rng rng(test_support::seed_of("pieces"), number, 0);
        PolygonCase example;
        example.mesh = test_support::random_occluded_mesh(rng).mesh;
        example.wall.position = Vec3(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.0);
        example.wall.normal = Vec3::UnitZ();
        for (example.facet = 0; example.facet < 8; ++example.facet) {
            const auto gradients = example.gradients();
            for (std::size_t i = 0; i < example.polygons.num_polygons(); ++i) {
                for (const auto& vertex : example.polygons.polygon(i)) {
                    const CutPlane plane = example.polygons.lines()[vertex.line].plane;
                    num_shadows += plane == CutPlane::ShadowEdge;
                    num_pierced += plane == CutPlane::Occluder;
                }
            }
            double size = 0.0;
            for (const Vec3& gradient : gradients) size = std::max(size, gradient.norm());
            for (std::size_t v = 0; v < gradients.size(); ++v) {
                for (Eigen::Index a = 0; a < 3; ++a) {
                    const auto moved = [&](double step) {
                        PolygonCase other = example;
                        other.mesh.vertices[v][a] += step;
                        return other.value();
                    };
                    EXPECT_NEAR((moved(kStep_m) - moved(-kStep_m)) / (2.0 * kStep_m),
                                gradients[v][a],
                                1e-6 * (1.0 + size))
                        << "case " << number << ", facet " << example.facet << ", vertex " << v;
                }
            }
        }
    }
    EXPECT_GT(num_shadows, 50);
    EXPECT_GT(num_pierced, 5);
}

}  // namespace
