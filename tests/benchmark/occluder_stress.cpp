// SPDX-License-Identifier: MIT
// True errors of deterministic third bounces behind occluders of 1 mm to 1 m, against what was
// asked for and what was given:
//     occluder_stress <scenes> [<first scene> [<target error>...]]
// Prints a line per scene and target, then how many errors are above 1, 1.2 and 2 times the target.
#include "renderer/third_bounce/third_bounce.h"
#include "tests/support/occluder_scenes.h"

#include <fmt/core.h>

#include <cstdlib>
#include <vector>

int main(int argc, char** argv) {
    const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
    const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
    std::vector<double> targets{0.05, 0.02, 0.01};
    if (argc > 3) targets.clear();
    for (int i = 3; i < argc; ++i) targets.push_back(std::strtod(argv[i], nullptr));
    constexpr double kNumPoints = 120'000;
    struct Tally {
        int all = 0, met = 0, nearly_met = 0, far_off = 0;
        double seconds = 0.0;
    };
    std::vector<Tally> tallies(targets.size());
    fmt::print("{:<32} {:>8} {:>8} {:>8} {:>9} {:>8}\n",
               "scene",
               "target",
               "stated",
               "true",
               "elements",
               "s");
    for (std::uint64_t number = first; number < first + count; ++number) {
        const test_support::OccluderScene setup = test_support::random_occluder_scene(number);
        const renderer::Scene scene = setup.scene();
        const auto truths = test_support::sampled_third_bounces(setup, scene, kNumPoints);
        for (std::size_t t = 0; t < targets.size(); ++t) {
            renderer::RenderSettings settings;
            settings.target_error = targets[t];
            const renderer::ThirdBounce result =
                renderer::integrate_third_bounce(scene, setup.scan, setup.axis, settings, {});
            const double error = test_support::error_against(truths, result.transient);
            fmt::print("{:<32} {:8.4f} {:8.4f} {:8.4f} {:9} {:8.2f}\n",
                       setup.name,
                       targets[t],
                       *result.estimated_error,
                       error,
                       result.num_elements,
                       result.seconds);
            Tally& tally = tallies[t];
            ++tally.all;
            tally.met += error <= targets[t];
            tally.nearly_met += error <= 1.2 * targets[t];
            tally.far_off += error > 2.0 * targets[t];
            tally.seconds += result.seconds;
        }
    }
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const Tally& tally = tallies[t];
        fmt::print(
            "target {}: {} scenes, {} within it, {} within 1.2 times, {} above twice, {:.1f} s\n",
            targets[t],
            tally.all,
            tally.met,
            tally.nearly_met,
            tally.far_off,
            tally.seconds);
    }
    return 0;
}
