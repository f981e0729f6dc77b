// SPDX-License-Identifier: MIT
#pragma once

#include "calib/forward/path_segments.h"
#include "renderer/core/capture/time_axis.h"
#include "renderer/triangle/triangle_histogram.h"

#include <array>
#include <span>

namespace calib {

/// A triangle in space as the kernel needs it.
struct ElementShape {
    std::array<core::Vec3, 3> corners;
    core::Vec3 normal;  ///< unit
    double area_m2 = 0.0;
};
ElementShape element_shape(const std::array<core::Vec3, 3>& corners);

/// Gradients by them, each with the others held.
struct ShapeGradients {
    std::array<core::Vec3, 3> corners{core::Vec3::Zero(), core::Vec3::Zero(), core::Vec3::Zero()};
    core::Vec3 normal = core::Vec3::Zero();
    double area_m2 = 0.0;

    /// Gradients by the corners alone, on which normal and area depend.
    std::array<core::Vec3, 3> by_corners(const ElementShape& shape) const;
};

/// What the light of a pair means to all elements alike.
struct PairLight {
    std::array<MovedWallPoint, 2> ends;  ///< light, sensor
    bool is_confocal = true;             ///< both ends are the same
    double device_segments_m = 0.0;
    double radiance_factor = 1.0;  ///< of an albedo of 1
    double sigma_m = 0.0;          ///< of a Gaussian response, in path length
    core::TimeAxis axis;
};

/// Barycentric coordinates of a part's corners in its element.
using PartBarycentrics = std::array<core::Vec3, 3>;

/// Third bounces by way of triangular parts of elements, and their gradients in reverse.
class PartKernel {
 public:
    /// light   must outlive this
    explicit PartKernel(const PairLight& light) : light_(light) {}

    /// Adds the histogram of a part.
    void add(const ElementShape& element,
             const PartBarycentrics& barycentrics,
             double albedo,
             std::span<double> histogram);

    /// Adds the gradients of the inner product of a part's histogram with `by_value`.
    ///
    /// by_barycentrics   gradients by `barycentrics`
    /// returns           the gradient by the albedo
    double pull(const ElementShape& element,
                const PartBarycentrics& barycentrics,
                double albedo,
                std::span<const double> by_value,
                ShapeGradients& by_shape,
                PartBarycentrics& by_barycentrics);

 private:
    using Paths = std::array<Path, 6>;

    Path path_to(const core::Vec3& x,
                 const core::Vec3& normal,
                 renderer::Gradients gradients) const;
    Paths find_paths(const ElementShape& element,
                     const PartBarycentrics& barycentrics,
                     renderer::Gradients gradients) const;

    const PairLight& light_;
    renderer::TriangleBins bins_;
};

}  // namespace calib
