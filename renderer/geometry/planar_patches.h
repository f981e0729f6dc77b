// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace renderer {

/// Facets of one object that lie in one plane and touch along edges, as one flat piece.
///
/// Coplanar means that corners lie within 1e-10 of the object's size, and of a metre, of the plane
/// of the patch's largest facet, or as near as the coordinates' rounding allows; with less care
/// path lengths on the patch would not be exact.
class PlanarPatches {
 public:
    /// scene   must outlive the patches
    explicit PlanarPatches(const Scene& scene);

    std::uint32_t patch_of(std::uint32_t facet) const { return patch_of_facet_[facet]; }
    /// The patch's plane as a facet with orthonormal edges; the same from all its facets.
    const Facet& plane(std::uint32_t patch) const { return patches_[patch].plane; }
    double area_m2(std::uint32_t patch) const { return patches_[patch].area_m2; }

    /// The facet of a patch that holds a point of its plane; `likely` is tried first.
    std::optional<std::uint32_t> locate(std::uint32_t patch,
                                        const core::Vec3& position,
                                        std::uint32_t likely) const;

 private:
    // A grid over the patch; cell (i, j) lists the facets whose boxes touch it.
    struct Patch {
        Facet plane;
        double area_m2 = 0.0;
        core::Vec2 low = core::Vec2::Zero();
        core::Vec2 cells_per_m = core::Vec2::Zero();
        std::uint32_t columns = 0;
        std::uint32_t rows = 0;
        std::uint32_t first_cell = 0;
        std::uint32_t num_facets = 0;
    };

    void add_patch(const std::vector<std::uint32_t>& members);
    void add_grid(Patch& patch, const std::vector<std::uint32_t>& members);

    std::span<const Facet> facets_;
    std::vector<std::uint32_t> patch_of_facet_;
    std::vector<Patch> patches_;
    std::vector<std::uint32_t> cell_begin_;  ///< into cell_facets_; one more than cells
    std::vector<std::uint32_t> cell_facets_;
};

/// Weights of the second and the third corner at a point of the facet's plane.
core::Vec2 barycentric_of(const Facet& facet, const core::Vec3& position);

inline bool is_in_triangle(const core::Vec2& barycentric) {
    return barycentric.x() >= 0.0 && barycentric.y() >= 0.0 &&
           barycentric.x() + barycentric.y() <= 1.0;
}

}  // namespace renderer
