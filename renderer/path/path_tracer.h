// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/film/pass_histogram.h"
#include "renderer/path/first_vertex_batch.h"
#include "renderer/path/path_vertex.h"
#include "renderer/path/sensor_pairs.h"
#include "renderer/path/surface_walk.h"

namespace renderer {

/// Which surfaces' third bounce a path tracer adds; all add to higher orders.
enum class ThirdBounceScope { All, NotIntegrable };

/// Transient path tracing from the sensing point.
///
/// Every vertex is drawn either from the hidden area or from the BSDF of the vertex before it; both
/// kinds are weighted by the balance heuristic (source [Veach1997]). Every vertex is connected to
/// the illumination point, which gives one path of every bounce order. The third bounce is traced
/// in packets of coherent shadow rays; longer paths continue from its vertices.
class PathTracer {
 public:
    /// scene   must outlive the tracer
    PathTracer(const Scene& scene,
               const RenderSettings& settings,
               ThirdBounceScope scope = ThirdBounceScope::All);

    /// Adds the contributions of `num_samples` paths to `histogram`, so that their sum estimates H.
    ///
    /// rng       owned by this pair and pass
    /// returns   the number of rays traced
    std::uint64_t trace(const PathEndpoints& ends,
                        int num_samples,
                        core::Rng& rng,
                        PassHistogram& histogram) const;

    /// The same for a pixel, whose paths begin with the surface point seen through it.
    std::uint64_t trace_pixel(const SensorPairs& sensor_pairs,
                              std::size_t pixel,
                              int num_samples,
                              core::Rng& rng,
                              PassHistogram& histogram) const;

 private:
    class Walk;

    const Scene* scene_;
    int max_order_;
    bool by_order_;
    SurfaceWalk surface_walk_;
    FacetTraits facet_traits_;
};

}  // namespace renderer
