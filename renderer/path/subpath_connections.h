// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/pass_histogram.h"
#include "renderer/path/light_subpaths.h"
#include "renderer/path/shadow_ray_queue.h"

namespace renderer {

/// How the indirect light of a first vertex is sampled.
struct IndirectSplit {
    double walks = 1.0;   ///< probability of a walk
    int connections = 0;  ///< number of light subpaths that are connected to the vertex

    /// MIS weight of a walk (source [Veach1997]); that of all connections is what is missing to 1.
    ///
    /// ratio   density with which a light subpath draws the vertices of the walk, over its own
    double walk_weight(double ratio) const { return walks / (walks + connections * ratio); }

    /// The split for a vertex: narrow lobes find their light by walks.
    static IndirectSplit at(const PathVertex& vertex);
};

/// Follows how much more often light subpaths draw the path of a walk than the walk itself does.
class SubpathDensity {
 public:
    SubpathDensity(const Scene& scene, const RandomWalk& walk, const PathEndpoint& light)
        : scene_(&scene), walk_(&walk), light_(&light) {}

    /// To be called after every step of a walk from a first vertex.
    ///
    /// pdf_area   of the step [1/m^2]
    void add_step(const PathVertex& from, const PathVertex& to, double pdf_area);
    /// Density of the light subpath from the last vertex back to the second, over that of the walk.
    double ratio() const;

 private:
    const Scene* scene_;
    const RandomWalk* walk_;
    const PathEndpoint* light_;
    int num_steps_ = 0;
    double ratio_ = 1.0;  ///< without the steps back from the last vertex
    PathVertex from_;     ///< of the last step
    PathVertex to_;
};

/// Connects first vertices of a pixel to light subpaths.
///
/// Connections are computed without visibility for many candidates. Few of them get shadow rays:
/// they are drawn by systematic sampling with probabilities proportional to what they contribute,
/// in the order of path lengths, so that every bin gets its part (source [Veach1997], Russian
/// roulette; [Madow1949], systematic sampling).
class SubpathConnections {
 public:
    /// Which bounce orders there are, and whether each has a channel of its own.
    struct Orders {
        int max = 0;
        bool are_separate = false;
    };

    /// All must outlive this.
    SubpathConnections(const Scene& scene,
                       const RandomWalk& walk,
                       const LightSubpaths& subpaths,
                       const Orders& orders,
                       core::Rng& rng,
                       const PassHistogram& histogram,
                       ShadowRayQueue& shadow_rays);

    /// Adds the indirect light of a vertex by connections to the next light subpaths.
    void connect(const PathVertex& vertex, const IndirectSplit& split);
    /// Draws from the candidates so far; to be called after the last connect().
    void finish();

 private:
    static constexpr std::size_t kMaxAtOnce = 64;
    static constexpr std::size_t kMaxCandidates = 2048;
    static constexpr std::size_t kMaxVertices = 64;

    /// Connections without visibility.
    struct Candidates {
        std::array<double, kMaxCandidates> value;
        std::array<double, kMaxCandidates> opl_m;
        std::array<std::uint32_t, kMaxCandidates> subpath_vertex;
        std::array<std::uint8_t, kMaxCandidates> first_vertex;
    };

    /// Contributions and lengths of connections to consecutive vertices.
    struct Connected {
        alignas(64) std::array<double, kMaxAtOnce> value;
        alignas(64) std::array<double, kMaxAtOnce> opl_m;
    };

    void connect_range(const PathVertex& vertex,
                       const IndirectSplit& split,
                       std::size_t begin,
                       std::size_t count);
    void evaluate_range(const PathVertex& vertex,
                        const IndirectSplit& split,
                        std::size_t begin,
                        std::size_t count,
                        Connected& connected) const;
    void reevaluate_varying(const PathVertex& vertex,
                            const IndirectSplit& split,
                            std::size_t begin,
                            std::size_t count,
                            Connected& connected) const;
    double varying_contribution(const PathVertex& vertex,
                                const IndirectSplit& split,
                                std::size_t index) const;
    void draw_shadow_rays();
    void sort_by_length();
    void append(std::size_t candidate, double value);

    const Scene& scene_;
    const RandomWalk& walk_;
    const LightSubpaths& subpaths_;
    Orders orders_;
    core::Rng& rng_;
    bool resolves_velocity_;
    double begin_m_;  ///< of lengths that the gate admits
    double end_m_;
    ShadowRayQueue& shadow_rays_;
    int next_walk_;

    std::vector<PathVertex> vertices_;  ///< of the candidates
    std::size_t num_candidates_ = 0;
    Candidates candidates_;
    std::array<std::uint16_t, kMaxCandidates> order_;  ///< of candidates by length
};

}  // namespace renderer
