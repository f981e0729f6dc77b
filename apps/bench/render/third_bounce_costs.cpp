// SPDX-License-Identifier: MIT
#include "apps/bench/render/third_bounce_costs.h"

#include "apps/bench/lower_bounds.h"
#include "apps/bench/scene.h"
#include "nlos/compare/compare_scores.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/third_bounce/third_bounce.h"

#include <fmt/core.h>

namespace apps {
namespace {

constexpr double kCostTarget = 0.01;
constexpr double kCostReferenceTarget = 0.002;
constexpr double kGate_m = 0.01;

ThirdBounceCost cost_of(const std::string& measurement,
                        const BenchScene& bench,
                        const core::TimeAxis& axis,
                        int repeats) {
    renderer::RenderSettings settings = bench.settings();
    const auto integrate = [&](double target) {
        settings.target_error = target;
        return renderer::integrate_third_bounce(bench.scene(), bench.scan(), axis, settings, {});
    };
    const core::Capture reference =
        capture_of(bench.scan(), axis, integrate(kCostReferenceTarget).transient);
    ThirdBounceCost cost;
    cost.measurement = measurement;
    std::vector<double> seconds;
    std::vector<double> tracing_seconds;
    std::vector<double> ray_seconds;
    for (int i = 0; i < repeats; ++i) {
        const double start = core::cpu_seconds();
        const renderer::ThirdBounce result = integrate(kCostTarget);
        seconds.push_back(core::cpu_seconds() - start);
        tracing_seconds.push_back(result.tracing_seconds);
        ray_seconds.push_back(shadow_ray_seconds(bench.scene(), bench.scan()));
        cost.million_rays = 1e-6 * static_cast<double>(result.num_rays);
        cost.rel_l2 = relative_l2(capture_of(bench.scan(), axis, result.transient), reference);
    }
    cost.cpu_seconds = nlos::median(seconds);
    cost.tracing_rate = cost.million_rays / nlos::median(tracing_seconds);
    cost.whole_rate = cost.million_rays / cost.cpu_seconds;
    cost.embree_rate = 1e-6 / nlos::median(ray_seconds);
    return cost;
}

}  // namespace

std::vector<ThirdBounceCost> bench_third_bounce_costs(const std::string& scene_path, int repeats) {
    const core::ThreadLimit one_thread(1);
    const BenchScene bench(scene_path);
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    const core::Capture capture = bench.render(settings);
    std::vector<ThirdBounceCost> costs{cost_of("histogram", bench, bench.axis(), repeats)};
    for (const double share : {0.1, 0.5, 0.9}) {
        const double opl = bench.axis().bin_begin_m(bin_of_share(capture, share));
        costs.push_back(cost_of(fmt::format("gate of {:g} mm at {:.2f} m", 1e3 * kGate_m, opl),
                                bench,
                                {opl, kGate_m, 1},
                                repeats));
    }
    const BenchScene exhaustive(scene_path,
                                {"scan.pattern=exhaustive",
                                 "scan.sensing_points=[16,16]",
                                 "scan.illumination_points=[16,16]"});
    costs.push_back(cost_of("16 x 16 by 16 x 16 pairs", exhaustive, exhaustive.axis(), repeats));
    for (ThirdBounceCost& cost : costs) cost.share = cost.cpu_seconds / costs.front().cpu_seconds;
    return costs;
}

}  // namespace apps
