// SPDX-License-Identifier: MIT
// Light subpaths of images: their densities by laws, and what pixels make of them against walks
// alone and the ellipsoidal estimator; first vertices of pixels.
#include "renderer/path/light_subpaths.h"

#include "renderer/path/path_tracer.h"
#include "renderer/path/subpath_connections.h"
#include "tests/support/repeated_estimates.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using core::Vec3;
using renderer::LightSubpaths;
using test_support::image_of;
using test_support::parallelogram_object;

constexpr double kRoomAlbedo = 0.6;

// A closed room that is convex, with camera and light inside.
std::vector<renderer::Object> closed_room() {
    const Vec3 x(1.0, 0, 0), y(0, 0.8, 0), z(0, 0, 1.2);
    const Vec3 low(-0.5, -0.4, -0.6);
    std::vector<renderer::Object> objects;
    for (const auto& [u, v, w] : {std::tuple(x, y, z), std::tuple(y, z, x), std::tuple(z, x, y)}) {
        objects.push_back(parallelogram_object({low, u, v, kRoomAlbedo}));
        objects.push_back(parallelogram_object({low + w, u, v, kRoomAlbedo}));
    }
    return objects;
}

double room_area_m2() {
    return 2.0 * (1.0 * 0.8 + 0.8 * 1.2 + 1.2 * 1.0);
}

core::PinholeCamera room_camera() {
    core::PinholeCamera camera;
    camera.position_m = Vec3(0.3, 0.2, 0.5);
    camera.look_at_m = Vec3(-0.1, -0.2, -0.4);
    camera.fov_y_deg = 60.0;
    camera.resolution = {3, 2};
    camera.light_m = Vec3(-0.2, 0.1, 0.25);
    return camera;
}

// By BSDF alone: draws from the area lose those that fall on the wall that they start from.
struct RoomWalks {
    explicit RoomWalks(const core::PinholeCamera& camera)
        : scan(image_of(camera)),
          scene({closed_room(), {}}, scan, {}),
          pairs(scene, scan),
          ends(pairs.ends(0)),
          walk(scene, 1e-4, 0.0) {}

    core::Scan scan;
    renderer::Scene scene;
    renderer::SensorPairs pairs;
    renderer::PathEndpoints ends;
    renderer::RandomWalk walk;
};

// sigma   of what is expected
void expect_mean(std::span<const double> values, double expected, double sigma_expected = 0.0) {
    const double n = static_cast<double>(values.size());
    const double mean = test_support::sum_of(values) / n;
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    const double sigma = std::hypot(std::sqrt(squares / (n * (n - 1.0))), sigma_expected);
    EXPECT_LT(sigma, 0.02 * expected) << "the test is sharp";
    EXPECT_LT(std::abs(mean - expected), 4.5 * sigma) << mean << " for " << expected;
}

std::vector<core::PinholeCamera> cameras_with_both_lights() {
    core::PinholeCamera spot = room_camera();
    spot.light_m.reset();
    spot.light_spot_m = Vec3(-0.5, 0.1, 0.2);
    return {room_camera(), spot};
}

TEST(SensorPairs, ManyFirstVerticesAreThoseOfSinglePositions) {
    const RoomWalks room(room_camera());
    const std::vector<core::Vec2> positions{{0.1, 0.9}, {0.5, 0.5}, {0.7, 0.2}};
    for (std::size_t pixel = 0; pixel < room.pairs.num_pairs(); ++pixel) {
        std::vector<renderer::PathVertex> found;
        room.pairs.find_first_vertices(pixel, positions, found);
        ASSERT_EQ(found.size(), positions.size());
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const auto expected = room.pairs.first_vertex(pixel, positions[i]);
            ASSERT_TRUE(expected);
            EXPECT_EQ(found[i].point.facet, expected->point.facet);
            EXPECT_LT((found[i].point.position - expected->point.position).norm(), 1e-12);
            EXPECT_LT((found[i].to_previous - expected->to_previous).norm(), 1e-15);
            EXPECT_DOUBLE_EQ(found[i].optical_path.opl_m, expected->optical_path.opl_m);
            EXPECT_EQ(found[i].throughput, expected->throughput);
            EXPECT_EQ(found[i].order, expected->order);
        }
    }
}

// In a closed convex room the integral of the density that a path from the camera has over all
// places of the vertices before the last one is 1, so that its ratio to the density of walks has
// the area of the room as its mean, for walks of any number of vertices. A lit spot cannot see the
// wall that it lies on: paths that end there are no walks.
TEST(LightSubpaths, RatiosOfDensitiesIntegrateToTheArea) {
    constexpr int kRepeats = 64;
    constexpr int kWalks = 4096;
    for (const core::PinholeCamera& camera : cameras_with_both_lights()) {
        const RoomWalks room(camera);
        std::vector<std::vector<double>> sums(4, std::vector<double>(kRepeats));
        for (std::size_t i = 0; i < kRepeats; ++i) {
            const LightSubpaths subpaths(room.scene,
                                         room.walk,
                                         room.ends.light,
                                         kWalks,
                                         4,
                                         {test_support::seed_of("LightSubpaths"), 0, i});
            for (std::size_t v = 0; v < subpaths.begin(kWalks); ++v) {
                sums[static_cast<std::size_t>(subpaths.depth(v) - 1)][i] +=
                    subpaths.column(LightSubpaths::kRatio)[v] / kWalks;
            }
        }
        const double dark = camera.light_spot_m ? 0.8 * 1.2 : 0.0;
        for (int depth = 1; depth <= 4; ++depth) {
            SCOPED_TRACE(depth);
            expect_mean(sums[static_cast<std::size_t>(depth - 1)], room_area_m2() - dark);
        }
    }
}

// The other way round: the mean of the ratio is the fraction of walks from the light that come to
// so many vertices, the last of which the first vertex of the pixel sees.
TEST(SubpathDensity, RatiosIntegrateToTheFractionOfSubpaths) {
    constexpr int kWalks = 200'000;
    for (const core::PinholeCamera& camera : cameras_with_both_lights()) {
        const RoomWalks room(camera);
        const auto first = room.pairs.first_vertex(2, {0.4, 0.6});
        ASSERT_TRUE(first);
        std::vector<std::vector<double>> ratios(3, std::vector<double>(kWalks));
        for (std::size_t i = 0; i < kWalks; ++i) {
            core::Rng rng(test_support::seed_of("SubpathDensity"), i, 0);
            renderer::PathVertex vertex = *first;
            renderer::SubpathDensity density(room.scene, room.walk, room.ends.light);
            std::uint64_t num_rays = 0;
            for (auto& of_length : ratios) {
                const renderer::PathVertex from = vertex;
                const auto pdf_area = room.walk.draw_next(vertex, rng, num_rays);
                if (!pdf_area) break;
                density.add_step(from, vertex, *pdf_area);
                of_length[i] = density.ratio();
            }
        }
        const LightSubpaths subpaths(room.scene,
                                     room.walk,
                                     room.ends.light,
                                     kWalks,
                                     3,
                                     {test_support::seed_of("SubpathDensity"), kWalks, 0});
        std::vector<double> fractions(3);
        for (std::size_t v = 0; v < subpaths.begin(kWalks); ++v) {
            const Vec3 offset = subpaths.vertex(v).point.position - first->point.position;
            const bool is_seen = std::abs(first->normal.dot(offset)) > 1e-9;
            fractions[static_cast<std::size_t>(subpaths.depth(v) - 1)] +=
                is_seen ? 1.0 / kWalks : 0.0;
        }
        for (std::size_t i = 0; i < fractions.size(); ++i) {
            SCOPED_TRACE(i);
            expect_mean(
                ratios[i], fractions[i], std::sqrt(fractions[i] * (1.0 - fractions[i]) / kWalks));
        }
    }
}

TEST(LightSubpaths, AnyRunOfWalksLeavesTheLightEvenly) {
    const RoomWalks room(room_camera());
    const LightSubpaths subpaths(
        room.scene, room.walk, room.ends.light, 2000, 1, {test_support::seed_of("Runs"), 0, 0});
    ASSERT_EQ(subpaths.begin(2000), 2000U) << "nothing leaves a closed room";
    for (const int begin : {0, 137, 1400}) {
        constexpr int kCount = 512;
        int above = 0;
        for (int i = begin; i < begin + kCount; ++i) {
            const double z = subpaths.column(LightSubpaths::kZ)[subpaths.begin(i)];
            above += z > room.ends.light.position.z() ? 1 : 0;
        }
        // Independent draws would be off by 11.
        EXPECT_NEAR(above, kCount / 2, 4) << begin;
    }
}

// Surfaces of every kind, things in the way, and a camera that sees them.
std::vector<renderer::Object> furnished_room() {
    std::vector<renderer::Object> objects = closed_room();
    objects[1].material.model = renderer::model_of({.specular = true});
    objects[1].material.roughness = 0.5;
    objects.push_back(test_support::sphere_object(Vec3(-0.2, -0.2, -0.2), 0.15, 2, 0.8));
    objects.back().velocity_m_per_s = Vec3(0.5, 0.0, 0.3);
    const std::optional<double> wide = 0.8, narrow = 0.45;
    objects.push_back(parallelogram_object(
        {Vec3(0.0, -0.4, -0.3), Vec3(0.3, 0, 0.1), Vec3(0, 0.3, 0), 0.9, wide}));
    objects.push_back(parallelogram_object(
        {Vec3(-0.45, -0.3, -0.5), Vec3(0.3, 0, -0.05), Vec3(0, 0.3, 0), 0.9, narrow}));
    return objects;
}

struct Furnished {
    explicit Furnished(const core::PinholeCamera& camera)
        : scan(image_of(camera)), scene({furnished_room(), {}}, scan, {}) {}

    renderer::RenderSettings settings(renderer::Estimator method, int samples) const {
        renderer::RenderSettings settings;
        settings.method = method;
        settings.max_bounces = 5;
        settings.samples = samples;
        settings.by_order = true;
        return settings;
    }

    core::Scan scan;
    renderer::Scene scene;
    core::TimeAxis axis{0.6, 0.25, 16};
};

// All orders from the second on; the first is not sampled by connections.
test_support::Numbers numbers_of(const core::Capture& capture) {
    test_support::Numbers numbers;
    for (std::size_t order = 1; order < capture.by_order.size(); ++order) {
        const auto of_order = test_support::sums_of(capture.by_order[order]);
        numbers.insert(numbers.end(), of_order.begin(), of_order.end());
    }
    return numbers;
}

test_support::Numbers rendered(const Furnished& room,
                               renderer::RenderSettings settings,
                               std::uint64_t seed) {
    settings.seed = seed;
    return numbers_of(renderer::render(room.scene, room.scan, room.axis, settings, {}).capture);
}

// Walks alone: what pixels do where nothing is shared.
test_support::Numbers walked(const Furnished& room,
                             const renderer::RenderSettings& settings,
                             std::uint64_t seed) {
    const renderer::PathTracer tracer(room.scene, settings);
    const renderer::SensorPairs pairs(room.scene, room.scan);
    core::Capture capture;
    for (int order = 1; order <= settings.max_bounces; ++order) {
        capture.by_order.emplace_back(pairs.num_pairs(), room.axis.num_bins);
    }
    renderer::PassHistogram histogram(
        {room.axis, {}}, renderer::GateShape::Box, settings.max_bounces);
    const auto bins = static_cast<std::size_t>(room.axis.num_bins);
    for (std::size_t pair = 0; pair < pairs.num_pairs(); ++pair) {
        core::Rng rng(seed, pair, 0);
        tracer.trace(pairs, pair, settings.samples, rng, histogram);
        histogram.drain(
            [&](std::size_t begin, std::span<const double> values) {
                for (std::size_t i = 0; i < values.size(); ++i) {
                    const std::size_t index = begin + i;
                    capture.by_order[index / bins].histogram(pair)[index % bins] +=
                        static_cast<float>(values[i]);
                }
            },
            [](std::size_t, std::span<const double>) {});
    }
    return numbers_of(capture);
}

class SubpathConnections : public testing::TestWithParam<bool> {};

TEST_P(SubpathConnections, AgreeWithWalksAloneInEveryOrderPixelAndBin) {
    const Furnished room(cameras_with_both_lights()[GetParam() ? 1 : 0]);
    const auto settings = room.settings(renderer::Estimator::Path, 1024);
    const auto connected = test_support::repeat(
        [&](std::uint64_t seed) { return rendered(room, settings, seed); }, "Connected");
    const auto alone = test_support::repeat(
        [&](std::uint64_t seed) {
            return walked(room, room.settings(renderer::Estimator::Path, 10'000), seed);
        },
        "Walked");
    test_support::expect_same_means(connected, alone, 0.05);
}

TEST_P(SubpathConnections, AgreeWithTheEllipsoidalEstimator) {
    const Furnished room(cameras_with_both_lights()[GetParam() ? 1 : 0]);
    const auto estimate = [&](renderer::Estimator method, int samples, const char* name) {
        return test_support::repeat(
            [&](std::uint64_t seed) {
                return rendered(room, room.settings(method, samples), seed);
            },
            name);
    };
    test_support::expect_same_means(
        estimate(renderer::Estimator::Path, 1024, "Connected again"),
        estimate(renderer::Estimator::Ellipsoidal, 2048, "Ellipsoidal image"),
        0.05);
}

INSTANTIATE_TEST_SUITE_P(Lights, SubpathConnections, testing::Values(false, true));

// Velocities of connections are those of the same paths drawn by walks.
TEST(SubpathConnectionsInMotion, AgreeWithTheEllipsoidalEstimatorByVelocity) {
    const Furnished room(room_camera());
    const core::HistogramAxes axes{room.axis, core::VelocityAxis{-1.0, 0.125, 16, false}};
    const auto estimate = [&](renderer::Estimator method, int samples, const char* name) {
        return test_support::repeat(
            [&](std::uint64_t seed) {
                auto settings = room.settings(method, samples);
                settings.seed = seed;
                settings.by_order = false;
                const auto capture =
                    renderer::render(room.scene, room.scan, axes, settings, {}).capture;
                return test_support::sums_of(capture.velocity->values);
            },
            name);
    };
    test_support::expect_same_means(estimate(renderer::Estimator::Path, 1024, "Moved"),
                                    estimate(renderer::Estimator::Ellipsoidal, 2048, "Moved too"),
                                    0.05);
}

// What lies outside the axis is left out before shadow rays, and changes nothing inside.
TEST(SubpathConnectionsInAGate, AreThoseOfTheWholeAxis) {
    const Furnished room(room_camera());
    const core::TimeAxis gate{room.axis.bin_begin_m(4), room.axis.bin_width_m, 2};
    const auto settings = room.settings(renderer::Estimator::Path, 1024);
    const auto sums = [&](const core::TimeAxis& axis, std::size_t first) {
        return [&, axis, first](std::uint64_t seed) {
            auto seeded = settings;
            seeded.seed = seed;
            const auto capture = renderer::render(room.scene, room.scan, axis, seeded, {}).capture;
            test_support::Numbers numbers(3);
            for (std::size_t pair = 0; pair < room.scan.num_pairs(); ++pair) {
                for (std::size_t bin = 0; bin < 2; ++bin) {
                    const double value = double{capture.transient.histogram(pair)[first + bin]};
                    numbers[bin] += value;
                    numbers[2] += value;
                }
            }
            return numbers;
        };
    };
    test_support::expect_same_means(test_support::repeat(sums(gate, 0), "Gate"),
                                    test_support::repeat(sums(room.axis, 4), "Whole axis"),
                                    0.05);
}

}  // namespace
