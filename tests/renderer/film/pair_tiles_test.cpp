// SPDX-License-Identifier: MIT
// Every pair in one tile, in an order that memory does not change, within what memory holds; and
// what a scan sees does not depend on it either.
#include "renderer/film/pair_tiles.h"

#include "renderer/core/error.h"
#include "renderer/third_bounce/surface_subdivider.h"
#include "renderer/third_bounce/third_bounce_scan.h"
#include "tests/support/single_cut.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace {

using core::Vec3;
using renderer::PairTiles;

constexpr std::size_t kParts = 16;

struct Sizes {
    std::size_t lights;
    std::size_t sensors;
    std::size_t at_once;
};

class PairTilesOf : public testing::TestWithParam<Sizes> {};

TEST_P(PairTilesOf, HoldEveryPairOnceWithinMemory) {
    const auto [lights, sensors, at_once] = GetParam();
    const PairTiles tiles(lights, sensors, at_once);
    std::vector<int> visits(lights * sensors);
    for (std::size_t part = 0; part < kParts; ++part) {
        for (const PairTiles::Batch& batch : tiles.batches(part, kParts)) {
            EXPECT_LE(batch.lights.size() + batch.sensors.size(), at_once);
            for (const PairTiles::Tile& tile : batch.tiles) {
                EXPECT_EQ(batch.lights.begin % PairTiles::kPointsTogether, 0U);
                EXPECT_EQ(batch.sensors.begin % PairTiles::kPointsTogether, 0U);
                EXPECT_GE(tile.lights.begin, batch.lights.begin);
                EXPECT_LE(tile.lights.end, batch.lights.end);
                EXPECT_GE(tile.sensors.begin, batch.sensors.begin);
                EXPECT_LE(tile.sensors.end, batch.sensors.end);
                for (std::size_t l = tile.lights.begin; l < tile.lights.end; ++l) {
                    for (std::size_t s = tile.sensors.begin; s < tile.sensors.end; ++s) {
                        ++visits[l * sensors + s];
                    }
                }
            }
        }
    }
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), std::ssize(visits));
}

TEST_P(PairTilesOf, KeepTheTilesOfPartsWhateverMemoryHolds) {
    const auto [lights, sensors, at_once] = GetParam();
    const auto first_pairs = [&](const PairTiles& tiles, std::size_t part) {
        std::vector<std::size_t> first;
        for (const PairTiles::Batch& batch : tiles.batches(part, kParts)) {
            for (const PairTiles::Tile& tile : batch.tiles) {
                first.push_back(tile.lights.begin * sensors + tile.sensors.begin);
            }
        }
        std::sort(first.begin(), first.end());
        return first;
    };
    const PairTiles bounded(lights, sensors, at_once);
    const PairTiles unbounded(lights, sensors, lights + sensors + PairTiles::kMinPoints);
    for (std::size_t part = 0; part < kParts; ++part) {
        EXPECT_EQ(first_pairs(bounded, part), first_pairs(unbounded, part));
        EXPECT_LE(unbounded.batches(part, kParts).size(), 1U);
    }
}

// Where all sensors fit beside the lights looked from together, nothing is looked at twice.
TEST(PairTiles, LookOnceAtEveryPointWhereAllSensorsFit) {
    const PairTiles tiles(100, 64, 64 + PairTiles::kPointsTogether);
    std::size_t looked_at = 0;
    renderer::PointRange lights;
    renderer::PointRange sensors;
    for (std::size_t part = 0; part < kParts; ++part) {
        for (const PairTiles::Batch& batch : tiles.batches(part, kParts)) {
            looked_at += batch.lights == lights ? 0 : batch.lights.size();
            looked_at += batch.sensors == sensors ? 0 : batch.sensors.size();
            lights = batch.lights;
            sensors = batch.sensors;
        }
    }
    EXPECT_EQ(looked_at, 164U);
}

INSTANTIATE_TEST_SUITE_P(ScansAndMemory,
                         PairTilesOf,
                         testing::Values(Sizes{1, 1, 32},
                                         Sizes{1, 500, 40},
                                         Sizes{500, 1, 40},
                                         Sizes{64, 64, 32},
                                         Sizes{64, 64, 96},
                                         Sizes{130, 70, 100},
                                         Sizes{70, 130, 150}));

// Elements, lights and sensors of a scan larger than a few tiles.
struct TwoSheets {
    core::WallScan scan = [] {
        std::vector<Vec3> points;
        for (int i = 0; i < 40; ++i) {
            points.emplace_back(-0.4 + 0.1 * (i % 8), -0.4 + 0.1 * (i / 8), 0.0);
        }
        return test_support::exhaustive_scan({points.begin(), points.begin() + 20}, points);
    }();
    renderer::Scene scene = [this] {
        renderer::SceneGeometry geometry;
        for (const auto& shape :
             {test_support::kTiltedPanel,
              test_support::Parallelogram{
                  Vec3(-0.05, -0.1, 0.4), Vec3(0.15, 0, 0.02), Vec3(0.02, 0.2, 0), 0.3}}) {
            geometry.objects.push_back(test_support::parallelogram_object(shape));
        }
        return renderer::Scene(std::move(geometry), scan, {});
    }();
    core::TimeAxis axis{1.2, 0.02, 40};
    renderer::ElementSet elements = test_support::single_cut({scene, scan, axis, 0.0}, 0.02);

    double bytes_per_point() const {
        return static_cast<double>(elements.blocks.size() * renderer::ElementBlock::kSize *
                                   sizeof(renderer::VisibilityMask));
    }
};

TEST(ThirdBounceMemory, ChangesNothingButTheNumberOfRays) {
    const TwoSheets setup;
    std::map<std::size_t, std::vector<float>> values;
    std::map<std::size_t, std::uint64_t> rays;
    std::map<std::size_t, double> errors;
    for (const std::size_t points : {std::size_t{1000}, std::size_t{48}, std::size_t{32}}) {
        renderer::ThirdBounceScan integrator(
            setup.scene,
            setup.scan,
            setup.axis,
            {.memory_bytes = static_cast<double>(points) * setup.bytes_per_point()});
        core::Transient result(setup.scan.num_pairs(), setup.axis.num_bins);
        EXPECT_EQ(integrator.integrate(setup.elements, result), renderer::ThirdBounceScan::kParts);
        values[points].assign(result.values().begin(), result.values().end());
        rays[points] = integrator.cost().num_rays;
        errors[points] = integrator.squared_shadow_error();
    }
    EXPECT_GT(*std::max_element(values[1000].begin(), values[1000].end()), 0.0F);
    for (const std::size_t points : {48, 32}) {
        EXPECT_EQ(values[points], values[1000]);
        EXPECT_EQ(errors[points], errors[1000]);
        EXPECT_GT(rays[points], rays[1000]);
        EXPECT_LT(rays[points], 4 * rays[1000]);
    }
}

TEST(ThirdBounceMemory, IsRefusedBelowTheFewestPoints) {
    const TwoSheets setup;
    renderer::ThirdBounceScan integrator(
        setup.scene, setup.scan, setup.axis, {.memory_bytes = 31 * setup.bytes_per_point()});
    core::Transient result(setup.scan.num_pairs(), setup.axis.num_bins);
    EXPECT_THROW(integrator.integrate(setup.elements, result), core::Failure);
}

}  // namespace
