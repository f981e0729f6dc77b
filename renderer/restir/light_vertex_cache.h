// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"
#include "renderer/path/sensor_pairs.h"
#include "renderer/restir/reusable_path.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace renderer {

/// Vertices of walks from the light, traced once and shared by all pairs of a measurement.
///
/// A walk's first vertex is drawn so that it serves every pair: on scans uniformly from the hidden
/// area, since the laser spot differs from pair to pair; on cameras along directions from the
/// light. Every vertex of a walk, connected to the start of a pair's paths, completes a path.
class LightVertexCache {
 public:
    /// All must outlive this.
    LightVertexCache(const Scene& scene, const SurfaceWalk& walk, const SensorPairs& sensor_pairs);

    /// Replaces all vertices by those of new walks; the same for any number of threads.
    ///
    /// num_walks      walks in all; their first vertices are stratified, any stretch of them too
    /// max_vertices   per walk
    /// returns        the number of rays traced
    std::uint64_t trace(int num_walks, int max_vertices, std::uint64_t seed, std::uint64_t frame);

    int num_walks() const { return static_cast<int>(walk_begin_.size()) - 1; }

    /// Whether the light may not see first vertices: they are not drawn from it.
    bool may_be_dark() const { return by_area_; }

    /// Consecutive walks.
    struct Stretch {
        int first = 0;
        int count = 0;
    };
    /// Finds vertices whose paths may have a length within a band.
    ///
    /// found   receives vertices for path_from(); a few may lie just outside the band
    void find(const PathDomain& domain,
              const OplBand& opl_m,
              const Stretch& walks,
              std::vector<std::uint32_t>& found) const;

    /// The path from the start of a pair's paths by way of a vertex to the light.
    ReusablePath path_from(std::uint32_t vertex) const;

    /// Density with which one walk has a path's vertices, by area at each.
    double pdf_area(const ReusablePath& path) const;

 private:
    struct Walked {
        std::vector<SurfacePoint> points;
        std::uint64_t num_rays = 0;
    };

    Walked trace_walk(int index, int max_vertices, double shift, core::Rng& rng) const;
    PathVertex first_vertex(const SurfacePoint& point) const;
    double pdf_area_of_first(const SurfacePoint& point) const;
    void store(const std::vector<Walked>& walks);

    const Scene* scene_;
    const SurfaceWalk* walk_;
    PathEndpoint light_;  ///< of cameras; on scans the middle of the laser spots
    bool by_area_;        ///< how first vertices are drawn

    std::vector<SurfacePoint> points_;
    std::vector<std::uint32_t> walk_begin_{0};
    std::vector<std::uint32_t> walk_of_;
    // For the search, in single precision and relative to the ray caster's origin.
    std::vector<float> x_, y_, z_;                    ///< the vertex
    std::vector<float> first_x_, first_y_, first_z_;  ///< its walk's first vertex
    /// Length of the walk from the vertex to its first one, for cameras on to their light.
    std::vector<float> to_light_m_;
};

}  // namespace renderer
