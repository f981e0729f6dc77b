// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/adjoint_scene.h"
#include "calib/adjoint/facet_tree.h"
#include "calib/adjoint/polygon_clipper.h"
#include "renderer/core/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace calib {

/// A triangle on a facet that light reaches, and how it lies before a wall point.
struct ElementView {
    std::array<core::Vec3, 3> corners;  ///< relative to the wall point
    core::Vec3 normal;                  ///< unit
    double facing_m = 0.0;  ///< of the wall point above the element's plane, along the normal
    double margin_m = 0.0;  ///< lengths below are rounding
};

/// The facets of a mesh as occluders before one wall point w.
///
/// A facet g hides a point x where x lies in the cone from w through g and behind g: above four
/// planes, three through w and an edge of g, one through g. Facets seen edge-on hide nothing.
class OccluderViews {
 public:
    /// mesh, tree   must outlive this; the tree is the mesh's
    OccluderViews(const core::TriangleMesh& mesh, const FacetTree& tree);

    /// end   index in its pair, noted in the lines
    void look_from(const MovedWallPoint& wall, std::uint8_t end);

    /// Looks at several neighbouring elements, about which the calls below may then ask.
    void look_at(std::span<const MeshElement> elements);

    ElementView view(const ElementShape& shape) const;
    /// Takes away what the mesh hides of element `index` of those looked at.
    ///
    /// view    of this element
    void remove_shadows(std::size_t index, const ElementView& view, PolygonClipper& clipper) const;

 private:
    struct Occluder {
        std::array<std::uint32_t, 3> vertices{};  ///< counterclockwise about the cone's axis
        std::array<core::Vec3, 3> edge_normals;  ///< unit, into the cone; from vertex k to the next
        core::Vec3 normal;                       ///< unit, away from the wall point
        bool hides = false;
    };

    Occluder make_occluder(std::size_t facet) const;
    bool is_beside(const Occluder& occluder,
                   const ElementView& element,
                   const std::array<core::Vec3, 3>& inwards) const;
    bool shadow_lines(const Occluder& occluder,
                      const ElementView& element,
                      std::array<CutLine, 4>& lines) const;

    const core::TriangleMesh& mesh_;
    std::vector<core::Vec3> normals_;  ///< of facets; 0 without area
    MovedWallPoint wall_;
    std::uint8_t end_ = 0;
    std::vector<core::Vec3> vertices_;  ///< relative to the wall point
    std::vector<Occluder> occluders_;
    ViewBoxes boxes_;
    std::span<const MeshElement> elements_;  ///< looked at
    std::vector<ViewBox> element_boxes_;
    std::vector<std::uint32_t> candidates_;  ///< that may hide some of them
};

}  // namespace calib
