// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/connection_technique.h"
#include "renderer/ellipsoidal/pixel_position_sampler.h"
#include "renderer/film/pass_histogram.h"
#include "renderer/path/tracer.h"

namespace renderer {

/// Which connection vertices an ellipsoidal tracer adds, by whether their facets are excluded.
enum class ConnectionScope { All, Kept, Excluded };

/// Transient path tracing that chooses the length first.
///
/// From every vertex of a walk from the sensor, the vertex before the light is drawn twice: by the
/// walk itself, from the hidden area or the BSDF, and on an ellipsoid, so that the whole path's
/// length falls within the time axis. The balance heuristic weighs the two (source [Veach1997],
/// [Pediredla2019]). Third bounces share one cut of the hierarchy per pair and packets of rays. The
/// first vertex of an image's path is also chosen by length: see PixelPositionSampler.
class EllipsoidalTracer : public Tracer {
 public:
    /// scene   must outlive the tracer
    /// scan    where sensors and lights may be
    /// axis    its span, extended by a shaped gate, is the range of lengths asked for
    /// third_bounces   which of them are added, beside all higher orders
    EllipsoidalTracer(const Scene& scene,
                      const core::Scan& scan,
                      const core::TimeAxis& axis,
                      const RenderSettings& settings,
                      ConnectionScope scope,
                      ThirdBounceScope third_bounces = ThirdBounceScope::All);

 private:
    std::unique_ptr<PairWalk> start(const PathEndpoints& ends,
                                    core::Rng& rng,
                                    PassHistogram& histogram) const override;

    class Walk;

    // The facets of the scope are in the hierarchy, or else none is.
    bool connects() const { return scope_ != ConnectionScope::Excluded; }
    bool in_scope(std::uint32_t facet) const {
        return scope_ == ConnectionScope::All ||
               excluded_.facets[facet] == (scope_ == ConnectionScope::Excluded);
    }

    ConnectionScope scope_;
    OplBand lengths_;  ///< of whole paths
    ExcludedFacets excluded_;
    ConnectionTechnique technique_;
    std::optional<PixelPositionSampler> pixel_positions_;  ///< of images
};

}  // namespace renderer
