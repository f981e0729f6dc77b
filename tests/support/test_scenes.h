// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render.h"

#include <optional>
#include <vector>

namespace test_support {

/// A parallelogram of two triangles: corner, corner + u, corner + u + v, corner + v.
struct Parallelogram {
    core::Vec3 corner;
    core::Vec3 u;
    core::Vec3 v;
    double albedo = 1.0;
    std::optional<double> roughness = std::nullopt;  ///< of a GGX surface; none: Lambertian
};

renderer::Object parallelogram_object(const Parallelogram& shape);

/// A tilted panel that no symmetry simplifies, a black screen that hides part of it, and points of
/// the wall z = 0 that see both.
inline const Parallelogram kTiltedPanel{
    {-0.25, -0.2, 0.75}, {0.45, 0.05, 0.15}, {-0.05, 0.4, -0.1}, 0.6};
inline const Parallelogram kBlackScreen{{-0.05, -0.1, 0.4}, {0.15, 0, 0.02}, {0.02, 0.2, 0}, 0.0};
inline const std::vector<core::Vec3> kThreeWallPoints{
    {-0.3, 0.1, 0.0}, {0.0, 0.0, 0.0}, {0.35, -0.25, 0.0}};

/// A sphere of `2 * 4^subdivisions * 4` facets with vertices on the sphere, inside-out or not: the
/// facets' orientation does not matter to the renderer.
renderer::Object sphere_object(const core::Vec3& center,
                               double radius,
                               int subdivisions,
                               double albedo);

/// A sphere of circles of longitude, which meet in a seam of vertices that are there twice, apart
/// by the sine of a full turn: `2 cells (cells - 1) + 2` positions.
core::TriangleMesh seamed_sphere(const core::Vec3& center, double radius, int cells);

/// Points on the wall z = 0 with normal +z.
core::WallPoints wall_points(const std::vector<core::Vec3>& positions);

core::WallScan confocal_scan(const std::vector<core::Vec3>& positions);
core::WallScan single_scan(const core::Vec3& illumination, const std::vector<core::Vec3>& sensing);
core::WallScan exhaustive_scan(const std::vector<core::Vec3>& illumination,
                               const std::vector<core::Vec3>& sensing);

/// What a camera records, one image.
core::Scan image_of(const core::PinholeCamera& camera);

/// Two surfaces that light each other, and an occluder before them.
std::vector<renderer::Object> facing_surfaces();

/// Third bounce of a parallelogram behind an opaque one, by brute force: `steps` x `steps`
/// midpoints with exact visibility. Written apart from the renderer, in plain double precision.
///
/// occluder      may be degenerate (zero edges): then nothing is hidden
/// wall_albedo   of both wall points
std::vector<float> third_bounce_by_quadrature(const Parallelogram& hidden,
                                              const Parallelogram& occluder,
                                              const core::WallScan& scan,
                                              const core::TimeAxis& axis,
                                              double wall_albedo,
                                              int steps);

}  // namespace test_support
