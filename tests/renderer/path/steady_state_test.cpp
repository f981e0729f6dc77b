// SPDX-License-Identifier: MIT
// Energy per bounce order against a radiosity solution: another method, no path sampling at all.
#include "renderer/render.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

namespace {

using core::kPi;
using core::Vec3;
using test_support::Parallelogram;

struct Patch {
    Vec3 center;
    Vec3 normal;
    double area_m2;
    double albedo;
};

// A back wall and a floor before a relay wall of 0.6 m; none hides another from the third.
const Parallelogram kBack{Vec3(-0.3, -0.3, 0.8), Vec3(0, 0.6, 0), Vec3(0.6, 0, 0), 0.9};
const Parallelogram kUpright{Vec3(-0.3, -0.4, 0.2), Vec3(0, 0, 0.4), Vec3(0.6, 0, 0), 0.8};
const Parallelogram kWall{Vec3(-0.3, -0.3, 0.0), Vec3(0.6, 0, 0), Vec3(0, 0.6, 0), 0.7};
const Vec3 kLight(0.1, 0.05, 0.0);
const Vec3 kSensor(-0.15, -0.2, 0.0);

void add_patches(const Parallelogram& shape, int steps, std::vector<Patch>& patches) {
    const Vec3 area_vector = shape.u.cross(shape.v);
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            patches.push_back(
                {shape.corner + (i + 0.5) / steps * shape.u + (j + 0.5) / steps * shape.v,
                 area_vector.normalized(),
                 area_vector.norm() / (steps * steps),
                 shape.albedo});
        }
    }
}

// cos cos / d^2 between two oriented points; both fronts must face each other.
double exchange(const Vec3& a, const Vec3& normal_a, const Vec3& b, const Vec3& normal_b) {
    const Vec3 offset = b - a;
    const double distance2 = offset.squaredNorm();
    const double cosines = normal_a.dot(offset) * -normal_b.dot(offset);
    if (normal_a.dot(offset) <= 0.0 || cosines <= 0.0) return 0.0;
    return cosines / (distance2 * distance2);
}

// What leaves the sensing point after 3, 4, ... bounces, all path lengths together.
std::vector<double> radiosity_by_order(int max_order, int steps) {
    std::vector<Patch> patches;
    for (const Parallelogram& shape : {kBack, kUpright, kWall}) add_patches(shape, steps, patches);
    std::vector<double> irradiance;
    for (const Patch& p : patches) {
        irradiance.push_back(kWall.albedo / kPi *
                             exchange(kLight, Vec3::UnitZ(), p.center, p.normal));
    }
    std::vector<double> result;
    for (int order = 3; order <= max_order; ++order) {
        double leaving = 0.0;
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const Patch& p = patches[i];
            leaving += kWall.albedo / kPi * p.albedo / kPi * irradiance[i] * p.area_m2 *
                       exchange(kSensor, Vec3::UnitZ(), p.center, p.normal);
        }
        result.push_back(leaving);
        std::vector<double> next(patches.size(), 0.0);
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const Patch& from = patches[i];
            const double radiance = from.albedo / kPi * irradiance[i] * from.area_m2;
            if (radiance == 0.0) continue;
            for (std::size_t j = 0; j < patches.size(); ++j) {
                next[j] += radiance *
                           exchange(from.center, from.normal, patches[j].center, patches[j].normal);
            }
        }
        irradiance = next;
    }
    return result;
}

TEST(PathTracer, EnergyOfEveryOrderMatchesARadiositySolution) {
    constexpr int kMaxOrder = 6;
    const std::vector<double> coarse = radiosity_by_order(kMaxOrder, 12);
    const std::vector<double> fine = radiosity_by_order(kMaxOrder, 24);

    renderer::SceneGeometry geometry;
    for (const Parallelogram& shape : {kBack, kUpright}) {
        geometry.objects.push_back(test_support::parallelogram_object(shape));
    }
    renderer::RelayWall wall;
    wall.size_m = {0.6, 0.6};
    wall.albedo = kWall.albedo;
    const core::WallScan scan = test_support::single_scan(kLight, {kSensor});
    const renderer::Scene scene(std::move(geometry), scan, wall);
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::Path;
    settings.max_bounces = kMaxOrder;
    settings.by_order = true;
    settings.samples = 1 << 20;
    settings.seed = test_support::seed_of("Radiosity");
    const auto result =
        renderer::render(scene, scan, core::TimeAxis{0.0, 0.01, 2000}, settings, {});
    for (int order = 3; order <= kMaxOrder; ++order) {
        const auto i = static_cast<std::size_t>(order - 3);
        // The midpoint rule converges with the square of the patch size.
        const double expected = fine[i] + (fine[i] - coarse[i]) / 3.0;
        double total = 0.0;
        for (const float value : result.capture.by_order[i + 2].values()) total += double{value};
        EXPECT_NEAR(total / expected, 1.0, 0.01) << "order " << order;
    }
}

}  // namespace
