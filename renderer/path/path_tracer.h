// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/path/tracer.h"

namespace renderer {

/// Transient path tracing from the sensing point.
///
/// Every vertex is drawn either from the hidden area or from the BSDF of the vertex before it; both
/// kinds are weighted by the balance heuristic (source [Veach1997]). Every vertex is connected to
/// the illumination point, which gives one path of every bounce order. The third bounce is traced
/// in packets of coherent shadow rays; longer paths continue from its vertices.
///
/// The indirect light of a pixel comes from few such walks and many connections of its first
/// vertices to light subpaths, which all pixels share; the balance heuristic weighs these too.
class PathTracer : public Tracer {
 public:
    /// scene   must outlive the tracer
    PathTracer(const Scene& scene,
               const RenderSettings& settings,
               ThirdBounceScope scope = ThirdBounceScope::All);

    std::unique_ptr<const LightSubpaths> trace_subpaths(const SensorPairs& sensor_pairs,
                                                        int num_samples,
                                                        const core::Rng& rng) const override;

 private:
    std::unique_ptr<PairWalk> start(const PathEndpoints& ends,
                                    core::Rng& rng,
                                    PassHistogram& histogram) const override;

    class Walk;

    SurfaceWalk pixel_walk_;  ///< of images, beside light subpaths
};

}  // namespace renderer
