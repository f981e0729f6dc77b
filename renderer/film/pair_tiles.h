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

/// The order in which all pairs of illumination and sensing points are worked on: in tiles whose
/// histograms and tables fit the second-level cache, and in batches of tiles that need what is
/// known of no more points than memory holds.
class PairTiles {
 public:
    /// Points of one side that are looked from together, from multiples of this on: so that the
    /// same ones always are.
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

    /// The tiles of a part, which do not depend on points_at_once; parts follow one another through
    /// all tiles. Over all parts each range of lights comes up once, and so does each range of
    /// sensors where it holds all; others come up once for every part and range of lights.
    std::vector<Batch> batches(std::size_t part, std::size_t num_parts) const;

 private:
    std::size_t num_lights_;
    std::size_t num_sensors_;
    std::size_t lights_at_once_;
    std::size_t sensors_at_once_;
};

}  // namespace renderer
