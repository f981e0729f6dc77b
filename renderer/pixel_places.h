// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoid.h"
#include "renderer/measurement.h"

#include <vector>

namespace renderer {

/// Draws places within a pixel, half of them where the way from the camera by the surface seen
/// there straight to the light is likely to have a wanted length.
///
/// Between the middles of neighbouring pixels that length is taken to be linear, so the wanted
/// places lie between two parallel lines. Places elsewhere keep half of the density: what the
/// linear length gets wrong costs noise, no bias.
class PixelPlaces {
 public:
    /// Traces one ray per pixel. height: pixels per column
    PixelPlaces(const Measurement& measurement, std::size_t height);

    /// The places of one pixel.
    class Band {
     public:
        /// Nothing: all places are alike.
        Band() = default;
        /// Length at (u, v): start + slope.x u + slope.y v; wanted are those within `wanted`.
        Band(double start_m, const core::Vec2& slope_m, const OplBand& wanted);

        /// A place, from u uniform in [0, 1)^2; the first number may be stratified.
        core::Vec2 sample(const core::Vec2& u) const;
        /// Density over the pixel, 1 on average.
        double pdf(const core::Vec2& place) const;

     private:
        double start_m_ = 0.0;
        core::Vec2 slope_m_ = core::Vec2::Zero();
        OplBand wanted_;
        double below_ = 0.0;  ///< share of the pixel with shorter lengths than wanted
        double share_ = 0.0;  ///< share with wanted lengths; 0: all places are alike
    };

    Band band(std::size_t pixel, const OplBand& wanted) const;

    /// Shortest and longest of the lengths at the middles of a pixel and of the four around it.
    OplBand around(std::size_t pixel) const;

    /// Normals of what is seen through the pixels' middles, 0 where that is nothing.
    const std::vector<core::Vec3>& normals() const { return normals_; }

 private:
    std::vector<double> opl_m_;  ///< at the pixels' middles; infinite where nothing is seen
    std::vector<core::Vec3> normals_;
    std::size_t height_;
};

}  // namespace renderer
