// SPDX-License-Identifier: MIT
#include "renderer/film/pair_tiles.h"

#include <algorithm>

namespace renderer {
namespace {

constexpr std::size_t kLightsPerTile = 8;
constexpr std::size_t kSensorsPerTile = 16;
static_assert(kSensorsPerTile % PairTiles::kPointsTogether == 0);

std::size_t parts_of(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
}

std::size_t whole_tiles(std::size_t count, std::size_t per_tile) {
    return std::max<std::size_t>(1, count / per_tile) * per_tile;
}

// The range of `size` items that holds item `index`, of `count`.
PointRange range_around(std::size_t index, std::size_t size, std::size_t count) {
    const std::size_t begin = index / size * size;
    return {begin, std::min(begin + size, count)};
}

}  // namespace

// Tiles are ordered in rows of the same lights. Where all sensors fit into memory beside one group
// of lights, each is traced only once. Else the sensors get half of the memory, or what all lights
// leave.
PairTiles::PairTiles(std::size_t num_lights, std::size_t num_sensors, std::size_t points_at_once)
    : num_lights_(num_lights), num_sensors_(num_sensors) {
    const std::size_t all_lights = parts_of(num_lights, kPointsTogether) * kPointsTogether;
    const std::size_t all_sensors = parts_of(num_sensors, kSensorsPerTile) * kSensorsPerTile;
    const std::size_t left = points_at_once - std::min(points_at_once, all_lights);
    sensors_at_once_ = all_sensors + kPointsTogether <= points_at_once
                           ? all_sensors
                           : whole_tiles(std::max(points_at_once / 2, left), kSensorsPerTile);
    lights_at_once_ =
        whole_tiles(std::min(all_lights, points_at_once - sensors_at_once_), kPointsTogether);
}

std::vector<PairTiles::Batch> PairTiles::batches(std::size_t part, std::size_t num_parts) const {
    const std::size_t tiles_in_row = parts_of(num_sensors_, kSensorsPerTile);
    const std::size_t num_tiles = parts_of(num_lights_, kLightsPerTile) * tiles_in_row;
    std::vector<Batch> batches;
    for (std::size_t i = part * num_tiles / num_parts; i < (part + 1) * num_tiles / num_parts;
         ++i) {
        const std::size_t light = i / tiles_in_row * kLightsPerTile;
        const std::size_t sensor = i % tiles_in_row * kSensorsPerTile;
        const PointRange lights = range_around(light, lights_at_once_, num_lights_);
        const PointRange sensors = range_around(sensor, sensors_at_once_, num_sensors_);
        auto batch = std::find_if(batches.begin(), batches.end(), [&](const Batch& other) {
            return other.lights == lights && other.sensors == sensors;
        });
        if (batch == batches.end()) batch = batches.insert(batch, {lights, sensors, {}});
        batch->tiles.push_back({range_around(light, kLightsPerTile, num_lights_),
                                range_around(sensor, kSensorsPerTile, num_sensors_)});
    }
    return batches;
}

}  // namespace renderer
