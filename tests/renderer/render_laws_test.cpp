// SPDX-License-Identifier: MIT
// Laws that no estimator knows of and all must obey, whatever the scan: light does not change when
// everything is moved, turned or mirrored, when surfaces are cut or points are listed otherwise; it
// is the same both ways, adds up, and falls with the square of the world's size.
#include "renderer/core/statistics.h"
#include "renderer/render.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>

namespace render_laws {
namespace {

using core::ScanPattern;
using core::Vec3;
using renderer::Estimator;
using renderer::Object;

const core::TimeAxis kAxis{0.5, 0.1, 40};

/// A scene, what scans it, and the wall that both belong to.
struct World {
    std::vector<Object> objects;
    core::WallScan scan;
    renderer::RelayWall wall;
    core::TimeAxis axis = kAxis;
};

/// Light of bins or pairs, and the deviation that its estimate reports.
struct Light {
    std::vector<double> values;
    std::vector<double> variances;
};

struct LawCase {
    Estimator estimator;
    ScanPattern pattern;
};

std::string name_of(const testing::TestParamInfo<LawCase>& info) {
    return std::string(renderer::traits_of(info.param.estimator).name) + "_" +
           std::string(core::enum_name(info.param.pattern));
}

class RenderLaw : public testing::TestWithParam<LawCase> {
 protected:
    static const renderer::EstimatorTraits& traits() {
        return renderer::traits_of(GetParam().estimator);
    }

    /// A tilted panel, what hides a part of it, and a floor that lights both.
    static World world() {
        World world;
        world.objects = {test_support::parallelogram_object(test_support::kTiltedPanel),
                         test_support::parallelogram_object(test_support::kBlackScreen),
                         test_support::parallelogram_object(
                             {{-0.4, -0.4, 0.3}, {0.8, 0, 0.1}, {0, 0.05, 0.5}, 0.8})};
        const std::vector<Vec3>& points = test_support::kThreeWallPoints;
        const std::vector<Vec3> lit{{-0.3, 0.1, 0}, {0.25, -0.2, 0}};
        switch (GetParam().pattern) {
            case ScanPattern::Confocal:
                world.scan = test_support::confocal_scan(points);
                break;
            case ScanPattern::Single:
                world.scan = test_support::single_scan(lit[0], points);
                break;
            case ScanPattern::Exhaustive:
                world.scan = test_support::exhaustive_scan(lit, points);
                break;
        }
        return world;
    }

    static renderer::RenderResult render(const World& world) {
        renderer::RenderSettings settings;
        settings.method = GetParam().estimator;
        settings.max_bounces = std::min(4, traits().max_bounces);
        if (traits().integrates) settings.max_bounces = 3;
        settings.samples = 2048;
        settings.variance = !traits().is_deterministic;
        const core::Scan scan = world.scan;
        const renderer::Scene scene({world.objects, {}}, scan, world.wall);
        return renderer::render(scene, scan, {world.axis, {}}, settings, {});
    }

    /// All light of every pair.
    static Light light_of(const World& world) {
        const renderer::RenderResult result = render(world);
        const auto sums = [&](const core::Transient& transient) {
            std::vector<double> values;
            for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
                const auto bins = transient.histogram(pair);
                values.push_back(std::accumulate(bins.begin(), bins.end(), 0.0));
            }
            return values;
        };
        Light light{sums(result.capture.transient), {}};
        light.variances.assign(light.values.size(), 0.0);
        if (result.capture.variance) light.variances = sums(*result.capture.variance);
        return light;
    }

    /// Expects `factor` times the light of `before`, within five reported deviations, and within
    /// the error that integrators are asked for by default.
    static void expect_same(const Light& after, const Light& before, double factor = 1.0) {
        ASSERT_EQ(after.values.size(), before.values.size());
        double noise = 0.0;
        double all = 0.0;
        for (std::size_t i = 0; i < after.values.size(); ++i) {
            const double sigma =
                std::sqrt(after.variances[i] + factor * factor * before.variances[i]);
            const double expected = factor * before.values[i];
            EXPECT_GT(expected, 0.0);
            EXPECT_NEAR(after.values[i], expected, 5.0 * sigma + 0.01 * expected) << i;
            noise += sigma;
            all += expected;
        }
        EXPECT_LT(noise, 0.1 * all) << "or the law says nothing";
    }
};

/// Everything turned by `turn`, which may mirror, then made `size` times as large, then moved.
World transformed(World world, const core::Mat3& turn, double size, const Vec3& way) {
    const auto placed = [&](const Vec3& point) { return Vec3(size * (turn * point) + way); };
    for (Object& object : world.objects) {
        for (Vec3& vertex : object.mesh.vertices) vertex = placed(vertex);
    }
    for (core::WallPoints* points : {&world.scan.illumination, &world.scan.sensing}) {
        for (Vec3& position : points->positions) position = placed(position);
        for (Vec3& normal : points->normals) normal = turn * normal;
    }
    world.wall.center_m = placed(world.wall.center_m);
    world.wall.normal = turn * world.wall.normal;
    world.wall.up = turn * world.wall.up;
    for (double& side : world.wall.size_m) side *= size;
    world.axis.opl_start_m *= size;
    world.axis.bin_width_m *= size;
    return world;
}

TEST_P(RenderLaw, AMovedTurnedOrMirroredWorldIsLitAlike) {
    const Light before = light_of(world());
    const core::Mat3 turn =
        Eigen::AngleAxisd(0.8, Vec3(0.3, -0.5, 0.9).normalized()).toRotationMatrix();
    const core::Mat3 mirror = Vec3(-1.0, 1.0, 1.0).asDiagonal();
    const core::Mat3 as_it_is = core::Mat3::Identity();
    expect_same(light_of(transformed(world(), as_it_is, 1.0, Vec3(3.0, -2.0, 0.7))), before);
    expect_same(light_of(transformed(world(), turn, 1.0, Vec3::Zero())), before);
    expect_same(light_of(transformed(world(), mirror, 1.0, Vec3::Zero())), before);
}

// Areas grow by its square, and every segment's light falls by it: a segment more than areas.
TEST_P(RenderLaw, LightFallsWithTheSquareOfTheSizeOfTheWorld) {
    const Light before = light_of(world());
    for (const double size : {0.01, 7.0}) {
        expect_same(light_of(transformed(world(), core::Mat3::Identity(), size, Vec3::Zero())),
                    before,
                    1.0 / (size * size));
    }
}

TEST_P(RenderLaw, SurfacesMayBeCut) {
    World cut = world();
    for (Object& object : cut.objects) {
        core::TriangleMesh& mesh = object.mesh;
        std::vector<std::array<std::uint32_t, 3>> parts;
        for (const auto& [a, b, c] : mesh.triangles) {
            const auto inside = static_cast<std::uint32_t>(mesh.vertices.size());
            mesh.vertices.push_back(0.5 * mesh.vertices[a] + 0.3 * mesh.vertices[b] +
                                    0.2 * mesh.vertices[c]);
            parts.push_back({a, b, inside});
            parts.push_back({b, c, inside});
            parts.push_back({c, a, inside});
        }
        mesh.triangles.assign(parts.begin(), parts.end());
    }
    expect_same(light_of(cut), light_of(world()));
}

TEST_P(RenderLaw, LightTravelsBothWaysAlike) {
    World back = world();
    if (back.scan.pattern == ScanPattern::Single) {
        back.scan.pattern = ScanPattern::Exhaustive;  // many lit points, one that is looked at
    }
    std::swap(back.scan.illumination, back.scan.sensing);
    const Light there = light_of(world());
    Light here = light_of(back);
    if (GetParam().pattern == ScanPattern::Exhaustive) {
        const Light as_lit = here;
        const std::size_t num_lit = world().scan.illumination.size();
        const std::size_t num_seen = world().scan.sensing.size();
        for (std::size_t lit = 0; lit < num_lit; ++lit) {
            for (std::size_t seen = 0; seen < num_seen; ++seen) {
                here.values[lit * num_seen + seen] = as_lit.values[seen * num_lit + lit];
                here.variances[lit * num_seen + seen] = as_lit.variances[seen * num_lit + lit];
            }
        }
    }
    expect_same(here, there);
}

// Of third bounces, and of objects that do not hide each other.
TEST_P(RenderLaw, ThirdBouncesAddUpAndFollowTheAlbedo) {
    World both = world();
    both.objects.erase(both.objects.begin() + 1);
    if (!traits().integrates) {
        for (Object& object : both.objects) object.material.albedo *= 1e-3;  // of later bounces
    }
    Light sum = light_of(both);
    for (const std::size_t other : {0U, 1U}) {
        World one = both;
        one.objects.erase(one.objects.begin() + other);
        const Light light = light_of(one);
        for (std::size_t i = 0; i < sum.values.size(); ++i) {
            sum.values[i] -= light.values[i];
            sum.variances[i] += light.variances[i];
        }
    }
    const Light whole = light_of(both);
    for (std::size_t i = 0; i < sum.values.size(); ++i) {
        EXPECT_NEAR(sum.values[i], 0.0, 5.0 * std::sqrt(sum.variances[i]) + 0.01 * whole.values[i]);
    }
    World darker = both;
    for (Object& object : darker.objects) object.material.albedo *= 0.5;
    expect_same(light_of(darker), whole, 0.5);
}

TEST_P(RenderLaw, BinsMayBeHalvedAndEmptyOnesAdded) {
    const Light before = light_of(world());
    World fine = world();
    fine.axis = {kAxis.opl_start_m, 0.5 * kAxis.bin_width_m, 2 * kAxis.num_bins};
    expect_same(light_of(fine), before);
    World longer = world();
    longer.axis = {
        kAxis.opl_start_m - 4.0 * kAxis.bin_width_m, kAxis.bin_width_m, kAxis.num_bins + 14};
    expect_same(light_of(longer), before);
}

TEST_P(RenderLaw, PointsMayBeListedOrFillAGrid) {
    World grid = world();
    std::vector<Vec3> points;
    for (const double x : {-0.2, 0.2}) {
        for (const double y : {-0.15, 0.15}) points.emplace_back(x, y, 0.0);
    }
    const bool is_confocal = grid.scan.is_confocal();
    grid.scan.sensing = test_support::wall_points(points);
    grid.scan.sensing.grid = {2, 2};
    if (is_confocal) grid.scan.illumination = grid.scan.sensing;
    World list = grid;
    list.scan.sensing.grid.reset();
    if (is_confocal) list.scan.illumination.grid.reset();
    expect_same(light_of(list), light_of(grid));
}

std::vector<LawCase> every_estimator_and_scan() {
    std::vector<LawCase> cases;
    for (std::size_t i = 0; i < renderer::kEstimators.size(); ++i) {
        for (const auto& [pattern, name] : core::EnumNames<ScanPattern>::value) {
            cases.push_back({static_cast<Estimator>(i), pattern});
        }
    }
    return cases;
}

INSTANTIATE_TEST_SUITE_P(EstimatorsAndScans,
                         RenderLaw,
                         testing::ValuesIn(every_estimator_and_scan()),
                         name_of);

}  // namespace
}  // namespace render_laws
