// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"

#include <functional>
#include <string>

namespace scenes {

/// Closed box of the given size, centred at the origin.
core::TriangleMesh make_box(const core::Vec3& size_m);

/// Flat four-sided patch; the front is the side from which the corners run anticlockwise.
core::TriangleMesh make_quad(const core::Vec3& a,
                             const core::Vec3& b,
                             const core::Vec3& c,
                             const core::Vec3& d);

/// Closed surface around the origin, an icosahedron subdivided and pushed out.
///
/// subdivisions   20 * 4^subdivisions triangles
/// radius_m       distance from the origin along a unit direction [m]
core::TriangleMesh make_radial_surface(int subdivisions,
                                       const std::function<double(const core::Vec3&)>& radius_m);

/// The same with one radius.
core::TriangleMesh make_ball(int subdivisions, double radius_m);

/// Torus around the z axis.
core::TriangleMesh make_torus(double ring_radius_m, double tube_radius_m, int around, int across);

/// The mesh turned by `angle_deg` about `axis` (unit).
core::TriangleMesh rotated(core::TriangleMesh mesh, const core::Vec3& axis, double angle_deg);

/// The mesh as an object whose node stands at `origin`.
///
/// Vertices are rounded to what a file holds (floats relative to the node, on a grid of 0.1 um), so
/// that the object equals its copy in the file and does not depend on the machine's sine.
renderer::Object place(const std::string& name,
                       core::TriangleMesh mesh,
                       const core::Vec3& origin,
                       const renderer::Material& material);

/// A diffuse material.
renderer::Material diffuse(double albedo);

/// A rough conductor (GGX).
renderer::Material conductor(const std::string& name, double albedo, double roughness);

}  // namespace scenes
