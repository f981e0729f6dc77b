// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/random.h"
#include "renderer/ellipsoidal/excluded_facets.h"
#include "renderer/ellipsoidal/hierarchy_cut.h"
#include "renderer/path/path_vertex.h"

#include <vector>

namespace renderer {

/// A surface point drawn as the vertex between two fixed ones, and its density.
struct ConnectionDraw {
    SurfacePoint point;
    double pdf_area = 0.0;  ///< [1/m^2]
};

/// The narrow lobe of a vertex and the facet that its axis hits.
struct LobeOnFacet {
    std::uint32_t facet = 0;
    ConnectionLobe lobe;
    double probability = 0.0;  ///< that a draw follows it
};

/// The ends of the connections from a path's vertex to its light.
ConnectionEnds connection_ends(const PathVertex& vertex, const PathEndpoint& light);
/// The ends of the third bounces of a measurement.
ConnectionEnds connection_ends(const PathEndpoints& ends);

/// Draws the vertex between two others so that the path has a wanted length (source
/// [Pediredla2019]): a facet from the hierarchy, a length within what the interval and the facet
/// allow, a point where the ellipsoid of that length intersects the facet. Where the first vertex
/// has a narrow lobe, draws that follow it take the facet that its axis hits and stay near the
/// axis.
class ConnectionTechnique {
 public:
    /// scene      must outlive the technique
    /// excluded   facets that are never drawn
    /// scan       where sensors and lights may be, see visible_sides()
    ConnectionTechnique(const Scene& scene, const ExcludedFacets& excluded, const core::Scan& scan);

    const TriangleHierarchy& hierarchy() const { return hierarchy_; }

    /// ends      neighbours of the vertex
    /// lengths   interval of the length of its two segments [m]
    /// lobe      of focus a, see lobe_of()
    /// returns   nothing where the draw finds no point; pdf_area() integrates to the probability
    ///           that it does
    std::optional<ConnectionDraw> sample(const ConnectionEnds& ends,
                                         const OplBand& lengths,
                                         core::Rng& rng,
                                         const std::optional<LobeOnFacet>& lobe = {}) const;
    /// Density of sample() at a point [1/m^2].
    double pdf_area(const ConnectionEnds& ends,
                    const OplBand& lengths,
                    const SurfacePoint& point,
                    const std::optional<LobeOnFacet>& lobe = {}) const;

    /// The lobe of a glossy vertex about the mirror direction of the previous segment.
    ///
    /// num_rays  raised by the rays traced
    /// returns   nothing for wide lobes, and where the facet hit is excluded or does not reflect
    ///           towards `light`
    std::optional<LobeOnFacet> lobe_of(const PathVertex& vertex,
                                       const core::Vec3& light,
                                       std::uint64_t& num_rays) const;

    /// The same for ends whose cut is known; `u` and `hint` as in HierarchyCut::sample().
    std::optional<ConnectionDraw> sample(const HierarchyCut& cut,
                                         double u,
                                         std::size_t& hint,
                                         core::Rng& rng) const;
    double pdf_area(const HierarchyCut& cut, const SurfacePoint& point) const;

 private:
    FacetChoice choice_by_lobe(const ConnectionEnds& ends,
                               const OplBand& lengths,
                               const std::optional<LobeOnFacet>& lobe) const;

    const Scene* scene_;
    std::vector<bool> is_excluded_;
    TriangleHierarchy hierarchy_;
};

}  // namespace renderer
