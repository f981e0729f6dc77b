// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"
#include "renderer/path/sensor_pairs.h"

#include <array>
#include <vector>

namespace renderer {

/// Draws positions within a pixel, half of them where the path from the camera by way of the
/// surface seen there to the light is likely to have a wanted length.
///
/// Surfaces are approximated by the planes seen at the centres of the pixel and of its eight
/// neighbours, so that edges and corners are covered too. On each plane the wanted positions lie
/// between two nearly straight, parallel lines. Half of the density is uniform over the pixel, so
/// that errors of the approximation cost noise and add no bias.
class PixelPositionSampler {
 public:
    /// Traces one ray per pixel.
    PixelPositionSampler(const SensorPairs& sensor_pairs, const core::PinholeCamera& camera);

    /// The density of positions within one pixel.
    class Band {
     public:
        /// Adds the positions (u, v) where the length start + slope.x u + slope.y v lies within
        /// `lengths`, unless that is nowhere or everywhere, nearly the same strip was added before,
        /// or there are enough. Without strips the density is uniform.
        void add_strip(double start_m, const core::Vec2& slope_m, const OplBand& lengths);

        /// A position, from u uniform in [0, 1)^2; the first number may be stratified.
        core::Vec2 sample(const core::Vec2& u) const;
        /// Density over the pixel, 1 on average.
        double pdf(const core::Vec2& position) const;

     private:
        struct Strip {
            double start_m = 0.0;
            core::Vec2 slope_m = core::Vec2::Zero();
            OplBand lengths;
            double below = 0.0;     ///< fraction of the pixel with shorter lengths
            double fraction = 0.0;  ///< fraction with these lengths

            core::Vec2 sample(const core::Vec2& u) const;
        };
        static constexpr std::size_t kMaxStrips = 4;

        std::array<Strip, kMaxStrips> strips_;
        std::size_t num_strips_ = 0;
    };

    Band band(std::size_t pixel, const OplBand& wanted) const;

    /// Shortest and longest of the lengths at the centres of a pixel and of its four neighbours.
    OplBand around(std::size_t pixel) const;

    /// Normals of the surfaces seen at the pixels' centres, 0 where there is none.
    const std::vector<core::Vec3>& normals() const { return normals_; }

 private:
    class PlaneLengths;

    bool see_the_same_plane(std::size_t a, std::size_t b) const;

    std::vector<double> opl_m_;  ///< at the pixels' centres; infinite where nothing is seen
    std::vector<core::Vec3> positions_, normals_;  ///< of what is seen there
    std::size_t height_;
    core::Vec3 pinhole_, light_;
    core::Mat3 world_from_image_;
};

}  // namespace renderer
