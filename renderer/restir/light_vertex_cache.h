// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"
#include "renderer/path/sensor_pairs.h"
#include "renderer/restir/reusable_path.h"

#include <array>
#include <cstdint>
#include <vector>

namespace renderer {

/// Vertices of walks from the light, traced once and shared by all pairs of a measurement.
///
/// The first vertex of a walk is drawn so that it serves every pair: for scans uniformly from the
/// hidden area, since the laser spot differs between pairs; for cameras along directions from the
/// light. Every vertex of a walk completes a path when connected to the start of a pair's paths.
class LightVertexCache {
 public:
    /// All must outlive this.
    LightVertexCache(const Scene& scene, const RandomWalk& walk, const SensorPairs& sensor_pairs);

    /// Replaces all vertices by those of new walks; the same bits for any number of threads.
    ///
    /// num_walks      total; first vertices are stratified, also within any run of walks
    /// max_vertices   per walk
    /// returns        the number of rays traced
    std::uint64_t trace(int num_walks, int max_vertices, std::uint64_t seed, std::uint64_t frame);

    int num_walks() const { return static_cast<int>(walk_begin_.size()) - 1; }

    /// Whether first vertices may be occluded from the light, since they are not drawn from it.
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

    /// The path from the start of a pair's paths through a vertex to the light.
    ReusablePath path_from(std::uint32_t vertex) const;

    /// Density of one walk at a path's vertices, by area at each.
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
    const RandomWalk* walk_;
    PathEndpoint light_;  ///< of cameras; on scans the middle of the laser spots
    bool by_area_;        ///< how first vertices are drawn

    std::vector<SurfacePoint> points_;
    std::vector<std::uint32_t> walk_begin_{0};
    std::vector<std::uint32_t> walk_of_;
    // For the search, in single precision and relative to the ray caster's origin.
    enum Column { kX, kY, kZ, kFirstX, kFirstY, kFirstZ, kToLight, kNumColumns };
    /// Per vertex: its position, that of its walk's first vertex, and the length of the walk from
    /// one to the other, for cameras on to their light.
    std::array<std::vector<float>, kNumColumns> columns_;
};

}  // namespace renderer
