// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"
#include "renderer/path/sensor_pairs.h"

#include <array>
#include <vector>

namespace renderer {

/// Draws places within a pixel, half of them where the way from the camera by the surface seen
/// there straight to the light is likely to have a wanted length.
///
/// Surfaces are taken to be the planes seen in the middle of the pixel and of the eight around it,
/// so that edges and corners are met too. On each the wanted places lie between two lines, straight
/// and parallel but for what widens the band. Places elsewhere keep half of the density: what these
/// guesses get wrong costs noise, no bias.
class PixelPositionSampler {
 public:
    /// Traces one ray per pixel.
    PixelPositionSampler(const SensorPairs& sensor_pairs, const core::PinholeCamera& camera);

    /// The places of one pixel.
    class Band {
     public:
        /// Adds the places where a length of start + slope.x u + slope.y v at (u, v) lies within
        /// `lengths`, unless these are none or all, much the same were added before, or enough
        /// were. Until some are, all places are alike.
        void add_strip(double start_m, const core::Vec2& slope_m, const OplBand& lengths);

        /// A place, from u uniform in [0, 1)^2; the first number may be stratified.
        core::Vec2 sample(const core::Vec2& u) const;
        /// Density over the pixel, 1 on average.
        double pdf(const core::Vec2& place) const;

     private:
        struct Strip {
            double start_m = 0.0;
            core::Vec2 slope_m = core::Vec2::Zero();
            OplBand lengths;
            double below = 0.0;  ///< share of the pixel with shorter lengths
            double share = 0.0;  ///< share with these lengths

            core::Vec2 sample(const core::Vec2& u) const;
        };
        static constexpr std::size_t kMaxStrips = 4;

        std::array<Strip, kMaxStrips> strips_;
        std::size_t num_strips_ = 0;
    };

    Band band(std::size_t pixel, const OplBand& wanted) const;

    /// Shortest and longest of the lengths at the middles of a pixel and of the four around it.
    OplBand around(std::size_t pixel) const;

    /// Normals of what is seen through the pixels' middles, 0 where that is nothing.
    const std::vector<core::Vec3>& normals() const { return normals_; }

 private:
    class PlaneLengths;

    bool see_the_same_plane(std::size_t a, std::size_t b) const;

    std::vector<double> opl_m_;  ///< at the pixels' middles; infinite where nothing is seen
    std::vector<core::Vec3> positions_, normals_;  ///< of what is seen there
    std::size_t height_;
    core::Vec3 pinhole_, light_;
    core::Mat3 world_from_image_;
};

}  // namespace renderer
