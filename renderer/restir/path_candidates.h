// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/ellipsoidal/connection_technique.h"
#include "renderer/restir/light_vertex_cache.h"
#include "renderer/restir/reusable_path.h"

#include <functional>
#include <optional>

namespace renderer {

/// Draws the candidate paths of a pair.
///
/// Techniques are weighted by the balance heuristic on the paths' densities: walks from the sensor
/// and, depending on the settings, an ellipsoidal connection from each vertex to the light, or a
/// stretch of shared walks from the light (source [Veach1997], [Pediredla2019]). From a wall point
/// there are many connections, which share one descent of the hierarchy and are spread evenly over
/// its facets: their noise falls faster than their number grows.
class PathCandidates {
 public:
    /// Receives an unoccluded path whose length lies within the requested interval.
    ///
    /// density   of all techniques together, times their numbers of samples: the sum of
    ///           value / density over all offers estimates the integral over all paths
    using Offer = std::function<void(const ReusablePath&, const PathValue& value, double density)>;

    /// Numbers of samples of the techniques for one pair.
    struct Effort {
        int walks = 1;
        int shared_walks = 0;
        int connections = 0;  ///< from a wall point to its light; pixels have one per walk
    };

    /// Where to draw: a pair, and path lengths within [opl_begin_m, opl_end_m).
    struct Request {
        const PathDomain& domain;
        double opl_begin_m;
        double opl_end_m;
        Effort effort;
    };

    /// All references but `axis` must outlive this. scan: where sensors and lights may be.
    /// axis: lengths asked for, by whose span surfaces are excluded; see ExcludedFacets.
    PathCandidates(const Scene& scene,
                   const core::Scan& scan,
                   const SensorPairs& sensor_pairs,
                   const RandomWalk& walk,
                   const core::TimeAxis& axis,
                   const RenderSettings& settings);

    const PathIntegrand& integrand() const { return integrand_; }
    const ExcludedFacets& excluded() const { return excluded_; }
    int max_vertices() const { return max_vertices_; }

    /// Traces the shared walks of a frame. returns the number of rays
    std::uint64_t prepare(std::uint64_t seed, std::uint64_t frame);

    /// Draws paths and offers those with a contribution. returns the number of rays
    std::uint64_t generate(const Request& request, core::Rng& rng, const Offer& offer) const;

 private:
    class Job;

    const Scene* scene_;
    const RandomWalk* walk_;
    ExcludedFacets excluded_;
    PathIntegrand integrand_;
    LightVertexCache light_vertices_;
    std::optional<ConnectionTechnique> connections_;
    int shared_walks_;  ///< per pair; several times as many are traced
    int max_vertices_;
};

}  // namespace renderer
