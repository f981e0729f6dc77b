// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/path/path_vertex.h"
#include "renderer/path/random_walk.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace renderer {

/// Density [1/m^2] with which a walk from a light begins at a surface point that the light sees.
double pdf_area_from_light(const Scene& scene,
                           const PathEndpoint& light,
                           const SurfacePoint& point);

/// The direction in which such a walk leaves the light, from u uniform in [0, 1)^2.
core::Vec3 sample_direction_from_light(const Scene& scene,
                                       const PathEndpoint& light,
                                       const core::Vec2& u);

/// Walks from the light of an image, traced once for a pass and shared by its pixels.
///
/// Every vertex of a walk completes a path when it is connected to the first vertex of a pixel's
/// path. Walks draw their first vertex by direction from the light and the others as paths from the
/// camera do, so that any of these paths may also be drawn from the camera (source [Veach1997],
/// bidirectional path tracing).
class LightSubpaths {
 public:
    /// Numbers that vertices are looked up by many at a time.
    enum Column {
        kX,
        kY,
        kZ,
        kNormalX,  ///< on the side that the light comes from
        kNormalY,
        kNormalZ,
        /// What leaves the vertex per unit of projected solid angle, over the density of its walk;
        /// without the BSDF where that varies.
        kRadiance,
        kOpl,       ///< from the light to here [m]
        kVelocity,  ///< of that length [m/s]
        /// Density with which a path from the camera that came here would draw the walk's other
        /// vertices, over that of the walk [m^2]; without the first factor where the BSDF varies.
        kRatio,
        kNumColumns
    };

    /// Traces walks, the same for any number of threads.
    ///
    /// light          of the image
    /// num_walks      any run of them is stratified by its direction from the light
    /// max_vertices   of a walk
    /// rng            owned by this pass
    LightSubpaths(const Scene& scene,
                  const RandomWalk& walk,
                  const PathEndpoint& light,
                  int num_walks,
                  int max_vertices,
                  core::Rng rng);

    int num_walks() const { return static_cast<int>(walk_begin_.size()) - 1; }
    std::uint64_t num_rays() const { return num_rays_; }

    /// Vertices [begin(walk), begin(walk + 1)) are those of a walk, from the light on.
    std::size_t begin(int walk) const { return walk_begin_[static_cast<std::size_t>(walk)]; }
    const double* column(Column column) const { return columns_[column].data(); }
    int depth(std::size_t vertex) const { return depth_[vertex]; }  ///< 1 for the first of a walk
    int max_vertices() const { return max_vertices_; }              ///< of a walk
    /// Whether a vertex's BSDF depends on directions.
    bool varies(std::size_t vertex) const { return varies_[vertex] != 0; }
    bool any_varies() const { return any_varies_; }

    /// The vertex as its walk leaves it: throughput and extent are those from the light.
    const PathVertex& vertex(std::size_t index) const { return vertices_[index]; }

 private:
    /// A vertex of a walk, and its kRatio.
    struct Step {
        PathVertex vertex;
        double ratio;
    };
    struct Walked {
        std::vector<Step> steps;
        std::uint64_t num_rays = 0;
    };

    Walked trace_walk(const core::Vec2& u, int max_vertices, core::Rng& rng) const;
    void store(const Walked& walked);

    const Scene* scene_;
    const RandomWalk* walk_;
    PathEndpoint light_;
    int max_vertices_;
    bool any_varies_ = false;
    std::uint64_t num_rays_ = 0;
    std::vector<std::size_t> walk_begin_{0};
    std::vector<PathVertex> vertices_;
    std::vector<int> depth_;
    std::vector<char> varies_;
    std::array<std::vector<double>, kNumColumns> columns_;
};

}  // namespace renderer
