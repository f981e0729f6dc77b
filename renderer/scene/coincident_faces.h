// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace renderer {

/// A face of which other faces before it cover a part or all.
struct CoveredFace {
    std::size_t object = 0;
    std::size_t face = 0;  ///< among the triangles of the object
    std::size_t by = 0;    ///< an object whose faces cover it, which may be its own
    /// What they leave, as weights of the face's second and third corner; empty: nothing.
    std::vector<std::array<core::Vec2, 3>> rest;
};

/// Which faces count where several lie at one place.
struct FacePrecedence {
    std::vector<std::size_t> order;  ///< of the objects: the first one's faces count
    std::vector<std::size_t> group;  ///< per object: it moves apart from those of other groups

    /// Relay walls first, then the objects as they stand; those of one velocity move together.
    explicit FacePrecedence(std::span<const Object> objects);
};

/// Surfaces closer than this are at one place: rays, which are in single precision, do not tell
/// them apart. At least 2e-7 m.
///
/// ray_ends   points that rays start from beside those of the objects
double coincidence_m(std::span<const Object> objects, std::span<const core::Vec3> ray_ends);

/// Faces that lie at the place of others that count before them: the same face again, either way
/// round, other triangles of the same polygon, two objects at one place, overlapping panels.
///
/// tolerance_m   how far apart surfaces at one place may be
/// returns       those faces in the order of objects and faces; neighbours that touch are none
std::vector<CoveredFace> find_covered_faces(std::span<const Object> objects,
                                            const FacePrecedence& precedence,
                                            double tolerance_m);

/// Faces of the objects of one name that have been left out.
struct CoincidentFaces {
    std::string object;
    std::string by;             ///< the object whose faces count there
    std::size_t num_faces = 0;  ///< before
    std::size_t num_left_out = 0;
    std::size_t num_cut = 0;  ///< of which a part is left
};

/// Takes covered faces out of the objects, and objects of which nothing is left, so that what lies
/// at one place counts once. Surfaces are two-sided: the face that counts has its own object's
/// material on both sides.
///
/// tolerance_m   see coincidence_m()
std::vector<CoincidentFaces> leave_out_covered_faces(std::vector<Object>& objects,
                                                     const FacePrecedence& precedence,
                                                     double tolerance_m);

/// Says so in one line; empty when there are none.
std::string describe(std::span<const CoincidentFaces> faces);

}  // namespace renderer
