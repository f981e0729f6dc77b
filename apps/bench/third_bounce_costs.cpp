// SPDX-License-Identifier: MIT
#include "apps/bench/third_bounce_costs.h"

#include "apps/bench/scene.h"
#include "nlos/compare.h"
#include "nlos/compare_scores.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"

#include <fmt/core.h>

namespace apps {
namespace {

constexpr double kTarget = 0.01;
constexpr double kReferenceTarget = 0.002;
constexpr double kGate_m = 0.01;

ThirdBounceCost measure(const std::string& measurement,
                        const BenchScene& bench,
                        const core::TimeAxis& axis,
                        int repeats) {
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = kReferenceTarget;
    const core::Capture reference = bench.render(axis, settings);
    settings.target_error = kTarget;
    ThirdBounceCost cost;
    cost.measurement = measurement;
    std::vector<double> seconds;
    for (int i = 0; i < repeats; ++i) {
        const double start = core::cpu_seconds();
        const core::Capture capture = bench.render(axis, settings);
        seconds.push_back(core::cpu_seconds() - start);
        cost.rel_l2 = nlos::compare_captures(capture, reference).rel_l2.value_or(0.0);
    }
    cost.cpu_seconds = nlos::median(seconds);
    return cost;
}

}  // namespace

std::vector<ThirdBounceCost> bench_third_bounce_costs(const std::string& scene_path, int repeats) {
    const core::ThreadLimit one_thread(1);
    const BenchScene bench(scene_path);
    std::vector<ThirdBounceCost> costs{measure("histogram", bench, bench.axis(), repeats)};
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    const core::Capture capture = bench.render(settings);
    for (const double share : {0.1, 0.5, 0.9}) {
        const double opl = bench.axis().bin_begin_m(bin_of_share(capture, share));
        costs.push_back(measure(fmt::format("gate of {:g} mm at {:.2f} m", 1e3 * kGate_m, opl),
                                bench,
                                {opl, kGate_m, 1},
                                repeats));
    }
    const BenchScene exhaustive(scene_path,
                                {"scan.pattern=exhaustive",
                                 "scan.sensing_points=[16,16]",
                                 "scan.illumination_points=[16,16]"});
    costs.push_back(measure("16 x 16 by 16 x 16 pairs", exhaustive, exhaustive.axis(), repeats));
    for (ThirdBounceCost& cost : costs) cost.share = cost.cpu_seconds / costs.front().cpu_seconds;
    return costs;
}

}  // namespace apps
