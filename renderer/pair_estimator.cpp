// SPDX-License-Identifier: MIT
#include "renderer/pair_estimator.h"

#include <memory>

namespace renderer {
namespace {

template <class Tracer>
PairEstimator estimator_of(const Scene& scene,
                           const core::Scan& scan,
                           std::shared_ptr<const Tracer> tracer) {
    return [sensor_pairs = SensorPairs(scene, scan), tracer = std::move(tracer)](
               std::size_t pair, int num_samples, core::Rng& rng, PassHistogram& histogram) {
        return sensor_pairs.is_image()
                   ? tracer->trace_pixel(sensor_pairs, pair, num_samples, rng, histogram)
                   : tracer->trace(sensor_pairs.ends(pair), num_samples, rng, histogram);
    };
}

}  // namespace

PairEstimator path_estimator(const Scene& scene,
                             const core::Scan& scan,
                             const RenderSettings& settings,
                             ThirdBounceScope scope) {
    return estimator_of(scene, scan, std::make_shared<const PathTracer>(scene, settings, scope));
}

PairEstimator ellipsoidal_estimator(const Scene& scene,
                                    const core::Scan& scan,
                                    const core::TimeAxis& axis,
                                    const RenderSettings& settings,
                                    ConnectionScope scope) {
    return estimator_of(
        scene, scan, std::make_shared<const EllipsoidalTracer>(scene, scan, axis, settings, scope));
}

}  // namespace renderer
