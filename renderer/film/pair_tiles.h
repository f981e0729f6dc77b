// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace renderer {

/// Wall points [begin, end) of one side of a scan.
struct PointRange {
    std::size_t begin = 0;
    std::size_t end = 0;

    std::size_t size() const { return end - begin; }
    bool operator==(const PointRange&) const = default;
};

/// The order in which pairs of illumination and sensing points are processed: in tiles whose
/// histograms and tables fit the L2 cache, and in batches of tiles whose points' visibility fits
/// the memory.
class PairTiles {
 public:
    /// Visibility is traced for groups of this many points of one side that start at multiples of
    /// it, so that the groups are always the same.
    static constexpr std::size_t kPointsTogether = 16;
    /// Fewest points that must fit at once.
    static constexpr std::size_t kMinPoints = 2 * kPointsTogether;

    struct Tile {
        PointRange lights;
        PointRange sensors;
    };
    struct Batch {
        PointRange lights;  ///< of all its tiles
        PointRange sensors;
        std::vector<Tile> tiles;
    };

    /// points_at_once   lights and sensors together that a batch may have, at least kMinPoints
    PairTiles(std::size_t num_lights, std::size_t num_sensors, std::size_t points_at_once);

    /// The tiles of a part, which do not depend on points_at_once; consecutive parts cover all
    /// tiles. Over all parts each range of lights occurs once, and so does a range of all sensors;
    /// smaller ranges of sensors occur once per part and range of lights.
    std::vector<Batch> batches(std::size_t part, std::size_t num_parts) const;

 private:
    std::size_t num_lights_;
    std::size_t num_sensors_;
    std::size_t lights_at_once_;
    std::size_t sensors_at_once_;
};

}  // namespace renderer
