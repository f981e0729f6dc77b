// SPDX-License-Identifier: MIT
#include "renderer/path/path_tracer.h"

#include "renderer/core/sampling.h"
#include "renderer/path/subpath_connections.h"

#include <algorithm>
#include <array>
#include <vector>

namespace renderer {
namespace {

// Vertices that the hidden area draws for pixels are those that light subpaths draw better.
constexpr double kAreaFractionOfPixels = 0.0;

// Enough that what pixels share does not show in their noise, and few enough to cost little beside
// them and to stay in the cache.
int num_subpaths(std::size_t num_pixels, int num_samples) {
    constexpr double kMin = 4096.0;
    constexpr double kMax = 16384.0;
    constexpr double kSamplesPerSubpath = 128.0;
    const double samples = static_cast<double>(num_pixels) * num_samples;
    return static_cast<int>(
        std::min(samples, std::clamp(samples / kSamplesPerSubpath, kMin, kMax)));
}

// Connections seldom hit narrow lobes and leave them to few walks: images would become noisier than
// by walks alone.
bool has_narrow_lobes(const Scene& scene) {
    constexpr double kLeastAlpha = 0.4 * 0.4;
    return std::ranges::any_of(scene.objects(), [](const Object& object) {
        const auto lobe = lobe_of(make_bsdf(object.material), 1.0);
        return lobe && lobe->alpha < kLeastAlpha;
    });
}

}  // namespace

class PathTracer::Walk : public PairWalk {
 public:
    Walk(const PathTracer& tracer,
         const PathEndpoints& ends,
         core::Rng& rng,
         PassHistogram& histogram)
        : PairWalk(tracer, ends, rng, histogram), tracer_(tracer) {}

    void trace_samples(int count) override {
        // The number of each kind is rounded at random, so that its mean is the fraction that the
        // weights assume.
        const double expected = count * kAreaFractionFromWall;
        const int num_area = std::min(count, static_cast<int>(expected + rng_.uniform()));
        trace_walks(num_area, count - num_area, 1.0 / count);
    }

    void trace_pixel_samples(const SensorPairs& sensor_pairs,
                             std::size_t pixel,
                             int count,
                             const LightSubpaths* subpaths) override {
        if (subpaths != nullptr) {
            trace_and_connect(sensor_pairs, pixel, count, *subpaths);
            return;
        }
        for_first_vertices(
            sensor_pairs, pixel, count, [&](const PathVertex& vertex) { extend(vertex); });
    }

 private:
    // Calls `use` for first vertices that are already connected to the light.
    template <class Use>
    void for_first_vertices(const SensorPairs& sensor_pairs,
                            std::size_t pixel,
                            int count,
                            const Use& use) {
        const core::Vec2 shift(rng_.uniform(), rng_.uniform());
        if (sensor_pairs.first_order() > tracer_.max_order_) return;
        std::array<core::Vec2, SensorPairs::kAtOnce> positions;
        for (int begin = 0; begin < count; begin += SensorPairs::kAtOnce) {
            const int size = std::min(SensorPairs::kAtOnce, count - begin);
            for (int i = 0; i < size; ++i) {
                positions[static_cast<std::size_t>(i)] =
                    core::lattice_point(begin + i, count, shift);
            }
            first_vertices_.clear();
            sensor_pairs.find_first_vertices(
                pixel, {positions.data(), static_cast<std::size_t>(size)}, first_vertices_);
            num_rays_ += static_cast<std::uint64_t>(size);
            for (PathVertex& vertex : first_vertices_) {
                vertex.throughput *= 1.0 / count;
                connect_to_light(vertex, tracer_.random_walk_.connection_value(vertex, ends_));
                use(vertex);
            }
        }
    }

    void trace_and_connect(const SensorPairs& sensor_pairs,
                           std::size_t pixel,
                           int count,
                           const LightSubpaths& subpaths) {
        SubpathConnections connections(scene_,
                                       tracer_.pixel_walk_,
                                       subpaths,
                                       {tracer_.max_order_, tracer_.by_order_},
                                       rng_,
                                       histogram_,
                                       shadow_rays_);
        // Systematic sampling: each vertex gets a walk with the probability of its split.
        double turn = rng_.uniform();
        for_first_vertices(sensor_pairs, pixel, count, [&](const PathVertex& vertex) {
            const IndirectSplit split = IndirectSplit::at(vertex);
            connections.connect(vertex, split);
            turn += split.walks;
            if (turn < 1.0) return;
            turn -= 1.0;
            extend_beside_connections(vertex, split);
        });
        connections.finish();
    }

    void extend(PathVertex vertex) override {
        const RandomWalk& walk = tracer_.random_walk_;
        while (vertex.order < tracer_.max_order_) {
            if (!walk.survives(vertex, rng_)) return;
            if (!walk.draw_next(vertex, rng_, num_rays_)) return;
            connect_to_light(vertex, walk.connection_value(vertex, ends_));
        }
    }

    // The same for a pixel's paths, which light subpaths draw too.
    void extend_beside_connections(PathVertex vertex, const IndirectSplit& split) {
        const RandomWalk& walk = tracer_.pixel_walk_;
        SubpathDensity density(scene_, walk, ends_.light);
        vertex.throughput /= split.walks;
        while (vertex.order < tracer_.max_order_) {
            if (!walk.survives(vertex, rng_)) return;
            const PathVertex from = vertex;
            const auto pdf_area = walk.draw_next(vertex, rng_, num_rays_);
            if (!pdf_area) return;
            density.add_step(from, vertex, *pdf_area);
            connect_to_light(
                vertex, split.walk_weight(density.ratio()) * walk.connection_value(vertex, ends_));
        }
    }

    const PathTracer& tracer_;
    std::vector<PathVertex> first_vertices_;
};

PathTracer::PathTracer(const Scene& scene, const RenderSettings& settings, ThirdBounceScope scope)
    : Tracer(scene, settings, scope),
      pixel_walk_(scene, settings.laser_spot_m2, kAreaFractionOfPixels) {}

std::unique_ptr<const LightSubpaths> PathTracer::trace_subpaths(const SensorPairs& sensor_pairs,
                                                                int num_samples,
                                                                const core::Rng& rng) const {
    const int max_vertices = max_order_ - sensor_pairs.first_order();
    if (!sensor_pairs.is_image() || max_vertices < 1 || has_narrow_lobes(*scene_)) return nullptr;
    return std::make_unique<const LightSubpaths>(
        *scene_,
        pixel_walk_,
        sensor_pairs.ends(0).light,
        num_subpaths(sensor_pairs.num_pairs(), num_samples),
        max_vertices,
        rng);
}

std::unique_ptr<PairWalk> PathTracer::start(const PathEndpoints& ends,
                                            core::Rng& rng,
                                            PassHistogram& histogram) const {
    return std::make_unique<Walk>(*this, ends, rng, histogram);
}

}  // namespace renderer
