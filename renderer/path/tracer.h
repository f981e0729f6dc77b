// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/film/pass_histogram.h"
#include "renderer/path/first_vertex_batch.h"
#include "renderer/path/light_subpaths.h"
#include "renderer/path/path_vertex.h"
#include "renderer/path/random_walk.h"
#include "renderer/path/sensor_pairs.h"
#include "renderer/path/shadow_ray_queue.h"

#include <memory>

namespace renderer {

class PairWalk;

/// Which surfaces' third bounce a tracer adds; all add to higher orders.
enum class ThirdBounceScope { All, NotIntegrable };

/// Estimates H by tracing paths from the sensing point.
class Tracer {
 public:
    virtual ~Tracer() = default;

    /// Adds the contributions of `num_samples` paths to `histogram`, so that their sum estimates H.
    ///
    /// rng       owned by this pair and pass
    /// returns   the number of rays traced
    std::uint64_t trace(const PathEndpoints& ends,
                        int num_samples,
                        core::Rng& rng,
                        PassHistogram& histogram) const;

    /// The same for a pair of a scan, or a pixel: its paths begin with the surface point that is
    /// seen through it.
    ///
    /// subpaths   of this pass; null: pixels do without
    std::uint64_t trace(const SensorPairs& sensor_pairs,
                        std::size_t pair,
                        int num_samples,
                        core::Rng& rng,
                        PassHistogram& histogram,
                        const LightSubpaths* subpaths = nullptr) const;

    /// What the pixels of an image share in a pass; null when its paths share nothing, or
    /// meet lobes that connections seldom hit.
    ///
    /// rng   owned by this pass
    virtual std::unique_ptr<const LightSubpaths> trace_subpaths(const SensorPairs& sensor_pairs,
                                                                int num_samples,
                                                                const core::Rng& rng) const;

 protected:
    friend class PairWalk;

    Tracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope);

    virtual std::unique_ptr<PairWalk> start(const PathEndpoints& ends,
                                            core::Rng& rng,
                                            PassHistogram& histogram) const = 0;

    const Scene* scene_;
    int max_order_;
    bool by_order_;
    RandomWalk random_walk_;
    FacetTraits facet_traits_;
};

/// One call of Tracer::trace(): what is fixed for the pair, and the paths under construction.
class PairWalk {
 public:
    PairWalk(const Tracer& tracer,
             const PathEndpoints& ends,
             core::Rng& rng,
             PassHistogram& histogram);
    virtual ~PairWalk() = default;

    virtual void trace_samples(int count) = 0;
    virtual void trace_pixel_samples(const SensorPairs& sensor_pairs,
                                     std::size_t pixel,
                                     int count,
                                     const LightSubpaths* subpaths) = 0;
    /// Traces what waits; to be called after all samples.
    void finish() { shadow_rays_.finish(); }
    std::uint64_t num_rays() const { return num_rays_ + shadow_rays_.num_rays(); }

 protected:
    /// Traces paths whose first vertices are drawn from the hidden area and by direction.
    ///
    /// weight   of one of them: 1 / their expected number
    void trace_walks(int num_area, int num_directions, double weight);
    /// Weighs the contributions of first vertices against another technique that draws them.
    virtual void weigh_first_vertices() {}
    /// Continues a path from a vertex and connects the vertices that follow to the light.
    virtual void extend(PathVertex vertex) = 0;

    /// Sets what the first vertices contribute over the density of walks.
    void evaluate_first_vertices(double weight);
    /// Adds what the first vertices contribute where the light sees them, and removes them.
    void connect_first_vertices();
    void deposit(const PathVertex& vertex, double value);
    /// Deposits `value`, sooner or later, if it is positive and the light sees the vertex.
    void connect_to_light(const PathVertex& vertex, double value);

    const Scene& scene_;
    const PathEndpoints& ends_;
    core::Rng& rng_;
    PassHistogram& histogram_;
    FirstVertexBatch first_;
    ShadowRayQueue shadow_rays_;
    std::uint64_t num_rays_ = 0;

 private:
    void finish_first_vertices(double weight);
    /// Draws the first vertices of longer paths, as FirstVertexBatch::draw_by_throughput().
    void draw_continued(double step_in_means);
    /// Where paths count that go from a vertex straight to the light.
    int channel_of(const PathVertex& vertex) const;

    const Tracer& tracer_;
    std::vector<PathVertex> continued_;  ///< first vertices of longer paths
};

/// Adds orders 1 and 2 of a wall pair, which have no vertex to sample; its ends are at rest.
void add_short_paths(const Scene& scene,
                     const PathEndpoints& ends,
                     const RenderSettings& settings,
                     PassHistogram& histogram);

}  // namespace renderer
