// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/path/tracer.h"

namespace renderer {

/// Transient path tracing from the sensing point. This page is where to start reading the room.
///
/// What is estimated. For a lit point l and a seen point s, H(l, s; b) is the radiance that leaves
/// s for 1 W on l, of light whose path has a length in bin b. Between s and l the path has vertices
/// x_1 ... x_k on surfaces; k = 1 is the third bounce: wall, surface, wall. H is the path integral
/// ([Veach1997], chapter 8)
///
///     H(b) = sum over k of  integral f(x) [length(x) in b] dA(x_1) ... dA(x_k),
///     f(x) = W(s -> x_1) G(s, x_1) B(x_1) G(x_1, x_2) B(x_2) ... G(x_k, l) W(l -> x_k).
///
/// B(x_i) is the BSDF at x_i between the segments before and after it. G(x, y) is the cosines at
/// surfaces of both ends over the squared distance, and 0 where something is in the way. W is an
/// end's factor without its cosine (PathEndpoint::factor() has both): albedo/pi on the wall. A
/// pixel of an image has its paths begin at a camera, with the surface seen through a random point
/// of the pixel as x_1. What of the path moves gives the velocity (OpticalPath) beside the length.
///
/// The estimate. Paths are drawn with some density p(x) per area of their vertices, and each adds
/// f(x) / p(x) to the bin of its length, whose mean is H(b). PathVertex::throughput is this
/// quotient up to a vertex; `film/pass_histogram.h` collects what paths add.
///
/// How a sample goes (PairWalk in `tracer.cpp`, and Walk in `path_tracer.cpp`):
///
/// 1. First vertices are drawn in batches, three in four by area from the hidden surfaces, the rest
///    by directions from s with the cosine (`first_vertex_batch.h`, `scene/area_sampler.h`,
///    `endpoint_direction_sampler.h`).
/// 2. Each is connected to l: a path of order 3. Large contributions get a shadow ray each; of the
///    small ones a systematic sample in proportion to their size (`systematic_sampler.h`).
/// 3. Some continue, in proportion to throughput: RandomWalk::draw_next() in `random_walk.h`
///    draws the next vertex by area or by the BSDF.
/// 4. Every new vertex is connected to l (RandomWalk::connection_value()), which gives one path of
///    each higher order. Shadow rays wait until they fill a packet (`shadow_ray_queue.h`).
/// 5. From order 5 on Russian roulette ends walks where surfaces reflect little (survives()).
///
/// Where MIS weights come from. A vertex x that either of two techniques may draw, with
/// probabilities c_1 and c_2 and densities p_1 and p_2, is divided by c_1 p_1(x) + c_2 p_2(x),
/// whichever drew it. That is the balance heuristic ([Veach1997], chapter 9) with one sample; no
/// weight appears as a factor. RandomWalk::step_to() computes this density for later vertices,
/// FirstVertexBatch::evaluate() for first ones. p_2 per area is the density of the direction times
/// cosine over squared distance.
///
/// Images have a third technique for what comes after x_1. Walks from the light, which all pixels
/// share (`light_subpaths.h`), are connected to first vertices (`subpath_connections.h`); few of
/// these connections get shadow rays. If a path is drawn w times by walks in the mean and n times
/// by connections, the balance heuristic gives a walk the weight w p_w / (w p_w + n p_l).
/// IndirectSplit says w and n for a vertex, SubpathDensity follows p_l / p_w along a walk, and
/// LightSubpaths does so along a light subpath, up to the steps that only the connection decides.
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

    RandomWalk pixel_walk_;  ///< of images, beside light subpaths
};

}  // namespace renderer
