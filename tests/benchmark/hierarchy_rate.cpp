// SPDX-License-Identifier: MIT
// What a draw of an ellipsoidal connection costs, against a shadow ray on the same scene, one
// thread, for gates of several widths.
//   hierarchy_rate SCENE.json [DRAWS] [REPEATS]
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/ellipsoidal/connection_technique.h"
#include "renderer/scene/scene_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>

namespace {

struct Bench {
    const renderer::Scene& scene;
    const core::WallScan& scan;
    const renderer::ConnectionTechnique& technique;
    int draws;
    int repeats;

    renderer::ConnectionEnds ends(int i) const {
        const auto pair = static_cast<std::size_t>(i) % scan.num_pairs();
        const std::size_t s = scan.sensing_index(pair);
        const std::size_t l = scan.illumination_index(pair);
        return {{scan.sensing.positions[s], scan.illumination.positions[l]},
                scan.sensing.normals[s],
                scan.illumination.normals[l]};
    }

    // Nanoseconds per call, the least of the repeats.
    template <class Body>
    double time(const Body& body) const {
        double best = 1e300;
        for (int repeat = 0; repeat < repeats; ++repeat) {
            core::Rng rng(1, 0, static_cast<std::uint64_t>(repeat));
            const double start = core::cpu_seconds();
            for (int i = 0; i < draws; ++i) body(i, rng);
            best = std::min(best, core::cpu_seconds() - start);
        }
        return best / draws * 1e9;
    }
};

double g_sink = 0.0;  ///< keeps results alive

void measure(const Bench& bench, const renderer::OplBand& gate) {
    constexpr int kDrawsPerCut = 64;
    const auto& hierarchy = bench.technique.hierarchy();
    int hits = 0;
    const double descent = bench.time([&](int i, core::Rng& rng) {
        const auto choice = hierarchy.sample(bench.ends(i / 16), gate, rng.uniform());
        if (choice) g_sink += choice->probability;
    });
    std::uint32_t facet = 0;
    const auto num_facets = static_cast<std::uint32_t>(bench.scene.facets().size());
    const double evaluation = bench.time([&](int i, core::Rng&) {
        facet = (facet + 7919) % num_facets;
        g_sink += hierarchy.evaluate(bench.ends(i / 16), gate, facet).probability;
    });
    const double connection = bench.time([&](int i, core::Rng& rng) {
        const auto draw = bench.technique.sample(bench.ends(i / 16), gate, rng);
        if (draw) g_sink += draw->pdf_area;
        if (draw) ++hits;
    });
    renderer::HierarchyCut cut(hierarchy);
    std::size_t hint = 0;
    const double from_cut = bench.time([&](int i, core::Rng& rng) {
        const int draw_index = i % kDrawsPerCut;
        if (draw_index == 0) {
            cut.rebuild(bench.ends(i / kDrawsPerCut), gate, kDrawsPerCut);
            hint = 0;
        }
        if (cut.empty()) return;
        const double u = (draw_index + rng.uniform()) / kDrawsPerCut;
        const auto draw = bench.technique.sample(cut, u, hint, rng);
        if (draw) g_sink += draw->pdf_area;
    });
    fmt::print("{:9.1f} {:9.0f} {:9.0f} {:11.0f} {:11.0f} {:9.2f}\n",
               gate.width_m() * 1e3,
               descent,
               evaluation,
               connection,
               from_cut,
               double(hits) / bench.draws / bench.repeats);
}

double shadow_ray_ns(const Bench& bench) {
    const auto num_facets = static_cast<std::uint32_t>(bench.scene.facets().size());
    return bench.time([&](int i, core::Rng& rng) {
        const auto ends = bench.ends(i / 16);
        const auto index = static_cast<std::uint32_t>(rng.uniform() * num_facets);
        const renderer::Facet& facet = bench.scene.facet(index);
        g_sink += bench.scene.rays().is_blocked(
            ends.foci.a, ends.normal_a, facet.point(0.3, 0.3), facet.normal);
    });
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: hierarchy_rate SCENE.json [DRAWS] [REPEATS]\n");
        return 2;
    }
    const core::ThreadLimit one_thread(1);
    const auto description = renderer::read_scene_description(argv[1], {});
    const core::WallScan scan = renderer::make_scan(description).wall();
    const renderer::Scene scene = renderer::load_scene(description, scan);
    const auto excluded =
        renderer::ExcludedFacets::of(scene, description.time_axis, description.render);
    const renderer::ConnectionTechnique technique(scene, excluded, scan);
    const Bench bench{scene,
                      scan,
                      technique,
                      argc > 2 ? std::atoi(argv[2]) : 400'000,
                      argc > 3 ? std::atoi(argv[3]) : 5};
    fmt::print("{} facets; shadow ray {:.0f} ns; nanoseconds per call:\n",
               scene.facets().size(),
               shadow_ray_ns(bench));
    fmt::print("  gate/mm   descent  evaluate  connection  64 per cut    placed\n");
    const core::TimeAxis& axis = description.time_axis;
    const double center = 1.4;
    measure(bench, {axis.opl_start_m, axis.opl_end_m()});
    for (const double width : {0.1, 0.03, 0.01, 0.003, 0.001}) {
        measure(bench, {center, center + width});
    }
    return g_sink == 0.5 ? 1 : 0;
}
