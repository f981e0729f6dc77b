// SPDX-License-Identifier: MIT
// Light inside a diffuse sphere has closed forms for every bounce (derived in REFERENCES.md,
// "transient furnace"). They test the path tracer from end to end: geometry, densities, units.
#include "renderer/core/sampling.h"
#include "renderer/path/path_tracer.h"
#include "renderer/render.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

namespace {

using core::kPi;
using core::Vec3;

constexpr double kRadius = 0.8;
constexpr double kAlbedo = 0.7;
constexpr int kSubdivisions = 6;

// The facets lie inside the sphere: their mean radius is below R by about R h^2/12 for facets of
// angular size h = (pi/2)/2^6, which shortens paths and moves energy by a few such steps.
constexpr double kFacetBias = 1e-3;

struct Moments {
    double total = 0.0;
    double sigma = 0.0;  ///< of the total
    double mean_opl_m = 0.0;
};

// Totals over independent passes give mean and standard error without trusting any bin's variance.
class Furnace {
 public:
    Furnace(const renderer::Scene& scene, const renderer::PathEndpoints& ends, int max_bounces)
        : ends_(ends), axis_{0.0, 0.02, 600}, max_bounces_(max_bounces) {
        renderer::RenderSettings settings;
        settings.max_bounces = max_bounces;
        settings.by_order = true;
        const renderer::PathTracer tracer(scene, settings);
        renderer::PassHistogram histogram(axis_, renderer::GateShape::Box, max_bounces);
        const auto bins = static_cast<std::size_t>(axis_.num_bins);
        sums_.assign(bins * static_cast<std::size_t>(max_bounces), 0.0);
        pass_totals_.assign(static_cast<std::size_t>(max_bounces), {});
        for (std::uint64_t pass = 0; pass < kPasses; ++pass) {
            core::Rng rng(test_support::seed_of("TransientFurnace"), 0, pass);
            tracer.trace(ends, 1000, rng, histogram);
            std::vector<double> totals(static_cast<std::size_t>(max_bounces), 0.0);
            histogram.drain(
                [&](std::size_t begin, std::span<const double> values) {
                    for (std::size_t i = 0; i < values.size(); ++i) {
                        sums_[begin + i] += values[i] / kPasses;
                        totals[begin / bins] += values[i];
                    }
                },
                [](std::size_t, std::span<const double>) {});
            for (std::size_t i = 0; i < totals.size(); ++i) pass_totals_[i].push_back(totals[i]);
        }
    }

    Moments moments(int order) const {
        Moments result;
        const auto& totals = pass_totals_[static_cast<std::size_t>(order - 1)];
        for (const double total : totals) result.total += total / kPasses;
        for (const double total : totals) result.sigma += std::pow(total - result.total, 2);
        result.sigma = std::sqrt(result.sigma / (kPasses * (kPasses - 1.0)));
        const auto values = histogram(order);
        double weighted = 0.0;
        for (std::size_t i = 0; i < values.size(); ++i) {
            weighted += values[i] * axis_.bin_center_m(static_cast<double>(i));
        }
        result.mean_opl_m = weighted / result.total;
        return result;
    }

    std::vector<double> histogram(int order) const {
        const auto bins = static_cast<std::ptrdiff_t>(axis_.num_bins);
        return {sums_.begin() + bins * (order - 1), sums_.begin() + bins * order};
    }
    const core::TimeAxis& axis() const { return axis_; }

 private:
    static constexpr std::uint64_t kPasses = 400;
    renderer::PathEndpoints ends_;
    core::TimeAxis axis_;
    int max_bounces_;
    std::vector<double> sums_;
    std::vector<std::vector<double>> pass_totals_;
};

renderer::Scene sphere_scene(const core::WallScan& scan) {
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(
        test_support::sphere_object(Vec3::Zero(), kRadius, kSubdivisions, kAlbedo));
    return {std::move(geometry), scan, renderer::RelayWall{}};
}

// A scan that has nothing to do with the sphere, for scenes that are traced from other ends.
core::WallScan far_scan() {
    return test_support::confocal_scan({Vec3(10, 0, 0)});
}

// A source of 1 W and a detector of fluence, both at the centre.
renderer::PathEndpoints isotropic_ends() {
    renderer::PathEndpoints ends;
    ends.sensor.isotropic = ends.light.isotropic = true;
    ends.sensor.strength = 1.0;
    ends.light.strength = 1.0 / (4.0 * kPi);
    ends.coincide = true;
    return ends;
}

// The centroid of the facet that a ray from the centre meets: close to an edge, the wedge with the
// next facet would be seen as a strong reflection that a sphere does not have.
core::WallPoints point_on_sphere(const Vec3& direction) {
    const renderer::Scene scene = sphere_scene(far_scan());
    const renderer::Facet& facet =
        scene.facet(scene.first_hit(Vec3::Zero(), direction, direction)->facet);
    core::WallPoints points;
    points.positions = {facet.point(1.0 / 3, 1.0 / 3)};
    points.normals = {facet.normal.dot(direction) > 0.0 ? Vec3(-facet.normal) : facet.normal};
    return points;
}

renderer::PathEndpoint wall_end(const core::WallPoints& points) {
    return {points.positions[0], points.normals[0], kAlbedo / kPi, /*isotropic=*/false};
}

void expect_close(double measured, double expected, double sigma, const std::string& what) {
    EXPECT_NEAR(measured, expected, 4.5 * sigma + kFacetBias * expected) << what;
}

// Source and detector of fluence at the centre: bounce k carries rho^k Phi/(pi R^2) with mean
// length 2R + (k-1) 4R/3; bounce 1 has length 2R, bounce 2 the density rho^2 Phi (tau-2R)/(2 pi
// R^4).
TEST(TransientFurnace, IsotropicEndsAtTheCentre) {
    const renderer::PathEndpoints ends = isotropic_ends();
    const renderer::Scene scene = sphere_scene(far_scan());
    const Furnace furnace(scene, ends, 6);

    for (int bounce = 1; bounce <= 4; ++bounce) {
        const Moments m = furnace.moments(bounce + 2);  // orders count two wall points
        const double expected = std::pow(kAlbedo, bounce) / (kPi * kRadius * kRadius);
        expect_close(m.total, expected, m.sigma, "total of bounce " + std::to_string(bounce));
        const double mean = 2.0 * kRadius + (bounce - 1) * 4.0 * kRadius / 3.0;
        EXPECT_NEAR(m.mean_opl_m, mean, 4e-3 * mean + 0.5 * furnace.axis().bin_width_m)
            << "mean of bounce " << bounce;
    }
    const auto first = furnace.histogram(3);
    const int bin = *furnace.axis().bin_of(2.0 * kRadius - 1e-3);
    EXPECT_NEAR(first[static_cast<std::size_t>(bin)], furnace.moments(3).total, 1e-9);
}

TEST(TransientFurnace, SecondBounceIsALinearRamp) {
    const renderer::PathEndpoints ends = isotropic_ends();
    const renderer::Scene scene = sphere_scene(far_scan());
    const Furnace furnace(scene, ends, 4);
    const auto values = furnace.histogram(4);
    const core::TimeAxis& axis = furnace.axis();
    for (std::size_t first = 80; first < 160; first += 10) {  // eighths of the ramp
        double measured = 0.0;
        for (std::size_t i = first; i < first + 10; ++i) measured += values[i];
        const double t0 = axis.bin_begin_m(double(first)) - 2.0 * kRadius;
        const double t1 = axis.bin_begin_m(double(first) + 10) - 2.0 * kRadius;
        const double expected =
            kAlbedo * kAlbedo * (t1 * t1 - t0 * t0) / (4.0 * kPi * std::pow(kRadius, 4));
        EXPECT_NEAR(measured / expected, 1.0, first == 80 ? 0.06 : 0.025) << "from " << t0;
    }
}

// Laser and detector on the sphere itself: bounce k carries Phi rho^k/(4 pi^2 R^2). Confocal,
// bounce 3 has density Phi rho^3 tau/(32 pi^2 R^4) on [0, 4R], and bounce k the mean length (k-1)
// 4R/3.
TEST(TransientFurnace, PointsOnTheSphere) {
    const core::WallPoints a = point_on_sphere(Vec3(0.3, 0.5, 0.8).normalized());
    const core::WallPoints b = point_on_sphere(Vec3(-0.6, 0.4, 0.1).normalized());
    for (const bool confocal : {true, false}) {
        core::WallScan scan;
        scan.sensing = a;
        scan.illumination = confocal ? a : b;
        const renderer::Scene scene = sphere_scene(scan);
        ASSERT_FALSE(scene.has_relay_wall());
        renderer::PathEndpoints ends{
            wall_end(scan.sensing), wall_end(scan.illumination), 0.0, confocal};
        const Furnace furnace(scene, ends, 5);
        for (int order = 3; order <= 5; ++order) {
            const Moments m = furnace.moments(order);
            const double expected =
                std::pow(kAlbedo, order) / (4.0 * kPi * kPi * kRadius * kRadius);
            expect_close(m.total, expected, m.sigma, "total of order " + std::to_string(order));
            if (!confocal) continue;
            const double mean = (order - 1) * 4.0 * kRadius / 3.0;
            EXPECT_NEAR(m.mean_opl_m, mean, 0.01 * mean) << "mean of order " << order;
        }
    }
}

TEST(TransientFurnace, ThirdBounceOfAConfocalPointIsALinearRamp) {
    const core::WallPoints point = point_on_sphere(Vec3(0.3, 0.5, 0.8).normalized());
    core::WallScan scan;
    scan.sensing = scan.illumination = point;
    const renderer::Scene scene = sphere_scene(scan);
    const renderer::PathEndpoints ends{wall_end(point), wall_end(point), 0.0, /*coincide=*/true};
    const Furnace furnace(scene, ends, 3);
    const auto values = furnace.histogram(3);
    const core::TimeAxis& axis = furnace.axis();
    for (std::size_t first = 20; first + 20 < 160; first += 20) {  // tenths of the ramp
        double measured = 0.0;
        for (std::size_t i = first; i < first + 20; ++i) measured += values[i];
        const double t0 = axis.bin_begin_m(double(first));
        const double t1 = axis.bin_begin_m(double(first) + 20);
        const double expected =
            std::pow(kAlbedo, 3) * (t1 * t1 - t0 * t0) / (64.0 * kPi * kPi * std::pow(kRadius, 4));
        EXPECT_NEAR(measured / expected, 1.0, 0.02) << "from " << t0;
    }
}

// Through the entry point, independent seeds: totals and mean lengths of orders 3 to 5 by t-test.
TEST(TransientFurnace, FrontDoorGivesTotalsAndMeansOfEveryOrder) {
    constexpr int kSeeds = 20;
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Single;
    scan.sensing = point_on_sphere(Vec3(0.3, 0.5, 0.8).normalized());
    scan.illumination = point_on_sphere(Vec3(-0.6, 0.4, 0.1).normalized());
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(
        test_support::sphere_object(Vec3::Zero(), kRadius, kSubdivisions, kAlbedo));
    renderer::RelayWall wall;
    wall.albedo = kAlbedo;
    const renderer::Scene scene(std::move(geometry), scan, wall);
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::Path;
    settings.by_order = true;
    settings.max_bounces = 5;
    settings.samples = 20'000;
    const core::TimeAxis axis{0.0, 0.02, 600};
    for (std::size_t order = 3; order <= 5; ++order) {
        std::vector<double> totals;
        std::vector<double> means;
        for (int seed = 0; seed < kSeeds; ++seed) {
            settings.seed = test_support::seed_of("FrontDoor") + static_cast<std::uint64_t>(seed);
            const auto result = renderer::render(scene, scan, axis, settings, {});
            const auto values = result.capture.by_order[order - 1].histogram(0);
            double total = 0.0;
            double weighted = 0.0;
            for (std::size_t i = 0; i < values.size(); ++i) {
                total += double{values[i]};
                weighted += double{values[i]} * axis.bin_center_m(double(i));
            }
            totals.push_back(total);
            means.push_back(weighted / total);
        }
        const auto expect_mean =
            [&](const std::vector<double>& x, double expected, const char* of) {
                double mean = 0.0;
                double spread = 0.0;
                for (const double value : x) mean += value / kSeeds;
                for (const double value : x) spread += std::pow(value - mean, 2);
                expect_close(mean, expected, std::sqrt(spread / (kSeeds * (kSeeds - 1.0))), of);
            };
        expect_mean(
            totals, std::pow(kAlbedo, order) / (4.0 * kPi * kPi * kRadius * kRadius), "total");
        expect_mean(means, (double(order) - 1.0) * 4.0 * kRadius / 3.0, "mean length");
    }
}

// Through the entry point: order 2 is the straight way from point to point.
TEST(TransientFurnace, FrontDoorAddsTheStraightWay) {
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Single;
    scan.sensing = point_on_sphere(Vec3(0.3, 0.5, 0.8).normalized());
    scan.illumination = point_on_sphere(Vec3(-0.6, 0.4, 0.1).normalized());
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(
        test_support::sphere_object(Vec3::Zero(), kRadius, kSubdivisions, kAlbedo));
    renderer::RelayWall wall;
    wall.albedo = kAlbedo;
    const renderer::Scene scene(std::move(geometry), scan, wall);
    renderer::RenderSettings settings;
    settings.by_order = true;
    settings.samples = 8;
    const auto result = renderer::render(scene, scan, core::TimeAxis{0.0, 0.02, 600}, settings, {});
    double total = 0.0;
    for (const float value : result.capture.by_order[1].values()) total += double{value};
    // The facet normals at both ends are off the radius by up to half a facet.
    EXPECT_NEAR(total / (kAlbedo * kAlbedo / (4.0 * kPi * kPi * kRadius * kRadius)), 1.0, 0.03);
}

}  // namespace
