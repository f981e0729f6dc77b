// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/connection_technique.h"
#include "renderer/ellipsoidal/pixel_position_sampler.h"
#include "renderer/film/pass_histogram.h"
#include "renderer/path/first_vertex_batch.h"
#include "renderer/path/sensor_pairs.h"
#include "renderer/path/surface_walk.h"

namespace renderer {

/// Which connection vertices an ellipsoidal tracer adds: by whether their facets are excluded.
enum class ConnectionScope { All, Kept, Excluded };

/// Transient path tracing that chooses the length first.
///
/// From every vertex of a walk from the sensor, the vertex before the light is drawn twice: by the
/// walk itself, from the hidden area or the BSDF, and on an ellipsoid, so that the whole path's
/// length falls within the time axis. The balance heuristic weighs the two (source [Veach1997],
/// [Pediredla2019]). Third bounces share one cut of the hierarchy per pair and packets of rays. An
/// image's first vertex is chosen by length, too: see PixelPositionSampler.
class EllipsoidalTracer {
 public:
    /// scene   must outlive the tracer
    /// scan    where sensors and lights may be
    /// axis    its whole span is asked for, and what the gate's shape lets through beyond
    EllipsoidalTracer(const Scene& scene,
                      const core::Scan& scan,
                      const core::TimeAxis& axis,
                      const RenderSettings& settings,
                      ConnectionScope scope);

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

    bool in_scope(std::uint32_t facet) const {
        return scope_ == ConnectionScope::All ||
               excluded_.facets[facet] == (scope_ == ConnectionScope::Excluded);
    }

    const Scene* scene_;
    int max_order_;
    bool by_order_;
    ConnectionScope scope_;
    OplBand lengths_;  ///< of whole paths
    SurfaceWalk surface_walk_;
    FacetTraits facet_traits_;
    ExcludedFacets excluded_;
    ConnectionTechnique technique_;
    std::optional<PixelPositionSampler> pixel_places_;  ///< of images
};

}  // namespace renderer
