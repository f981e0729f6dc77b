// SPDX-License-Identifier: MIT
#include "renderer/path/path_tracer.h"

#include "renderer/core/sampling.h"

#include <algorithm>

namespace renderer {

class PathTracer::Walk : public PairWalk {
 public:
    Walk(const PathTracer& tracer,
         const PathEndpoints& ends,
         core::Rng& rng,
         PassHistogram& histogram)
        : PairWalk(tracer, ends, rng, histogram), tracer_(tracer) {}

    void trace_samples(int count) override {
        // The number of each kind is rounded at random, so that its mean is the share that the
        // weights assume.
        const double expected = count * kAreaShareFromWall;
        const int num_area = std::min(count, static_cast<int>(expected + rng_.uniform()));
        trace_walks(num_area, count - num_area, 1.0 / count);
    }

    void trace_pixel_samples(const SensorPairs& sensor_pairs,
                             std::size_t pixel,
                             int count) override {
        const core::Vec2 shift(rng_.uniform(), rng_.uniform());
        for (int i = 0; i < count; ++i) {
            auto vertex = sensor_pairs.first_vertex(pixel, core::lattice_point(i, count, shift));
            ++num_rays_;
            if (!vertex || vertex->order > tracer_.max_order_) continue;
            vertex->throughput *= 1.0 / count;
            connect_to_light(*vertex);
            extend(*vertex);
        }
    }

 private:
    void connect_to_light(const PathVertex& vertex) {
        const double value = tracer_.surface_walk_.connection_value(vertex, ends_);
        if (!(value > 0.0)) return;
        ++num_rays_;
        if (!tracer_.surface_walk_.light_is_hidden(vertex, ends_)) deposit(vertex, value);
    }

    void extend(PathVertex vertex) override {
        const SurfaceWalk& walk = tracer_.surface_walk_;
        while (vertex.order < tracer_.max_order_) {
            if (!walk.survives(vertex, rng_)) return;
            if (!walk.draw_next(vertex, rng_, num_rays_)) return;
            connect_to_light(vertex);
        }
    }

    const PathTracer& tracer_;
};

PathTracer::PathTracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope)
    : Tracer(scene, settings, scope) {}

std::unique_ptr<PairWalk> PathTracer::start(const PathEndpoints& ends,
                                            core::Rng& rng,
                                            PassHistogram& histogram) const {
    return std::make_unique<Walk>(*this, ends, rng, histogram);
}

}  // namespace renderer
