// SPDX-License-Identifier: MIT
#include "apps/bench/lower_bounds.h"
#include "apps/bench/render/render.h"
#include "apps/bench/statistics.h"
#include "apps/shapes/shapes.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/render.h"
#include "renderer/scene/scene_file.h"

#include <cmath>
#include <span>

namespace apps {
namespace {

using core::Vec3;
using renderer::Estimator;

constexpr double kSpan_m = 2.4;  ///< of the time axis

// One size of everything that can grow.
struct Sizes {
    int cells = 50;  ///< of the sheet, per side; two triangles each
    int points = 16;
    int bins = 256;
    int bounces = 3;
    int threads = 1;
};

// A sheet of 0.8 m with waves of 4 cm, 1 m behind the wall.
renderer::Object sheet(int cells) {
    renderer::Object object;
    object.mesh = make_grid_mesh(cells, [](double u, double v) {
        return Vec3(0.4 * u, 0.4 * v, 1.0 + 0.04 * std::sin(5.0 * u + 1.0) * std::cos(4.0 * v));
    });
    return object;
}

struct Figures {
    double cpu_seconds = 0.0;
    double elapsed_seconds = 0.0;
    double limit_seconds = 0.0;
    double peak_bytes = 0.0;
};

Figures measure(Estimator method, const Sizes& sizes) {
    renderer::SceneDescription description;
    description.scan.sensing_points = {sizes.points, sizes.points};
    description.time_axis = {{1.4, kSpan_m / sizes.bins, sizes.bins}};
    description.render.method = method;
    description.render.max_bounces = sizes.bounces;
    description.render.samples = 256;
    if (renderer::traits_of(method).is_deterministic) description.render.target_error = 0.02;
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene({{sheet(sizes.cells)}, {}}, scan, {});
    const core::ThreadLimit limit(sizes.threads);
    core::reset_peak_rss();
    const double cpu_start = core::cpu_seconds();
    const renderer::RenderResult result =
        renderer::render(scene, scan, description.time_axis, description.render, {});
    Figures figures;
    figures.cpu_seconds = core::cpu_seconds() - cpu_start;
    figures.elapsed_seconds = result.seconds;
    figures.peak_bytes = static_cast<double>(core::peak_rss_bytes());
    figures.limit_seconds =
        static_cast<double>(result.num_rays) * shadow_ray_seconds(scene, scan.wall());
    return figures;
}

struct Series {
    std::string of;
    std::vector<Estimator> methods;
    std::vector<Sizes> steps;
    double (*size)(const Sizes&);
};

std::vector<Series> all_series() {
    const std::vector<Estimator> both{Estimator::ThirdBounce, Estimator::Path};
    std::vector<Series> series{
        {"triangles", both, {}, [](const Sizes& s) { return 2.0 * s.cells * s.cells; }},
        {"wall points", both, {}, [](const Sizes& s) { return 1.0 * s.points * s.points; }},
        {"bins", both, {}, [](const Sizes& s) { return 1.0 * s.bins; }},
        {"bounces",
         {Estimator::Path, Estimator::Restir},
         {},
         [](const Sizes& s) { return 1.0 * s.bounces; }},
        {"threads",
         {Estimator::ThirdBounce, Estimator::Path, Estimator::Restir},
         {},
         [](const Sizes& s) { return 1.0 * s.threads; }}};
    for (const int cells : {16, 50, 158, 500}) series[0].steps.push_back({.cells = cells});
    for (const int points : {8, 16, 32, 64}) series[1].steps.push_back({.points = points});
    for (const int bins : {64, 256, 1024, 4096}) series[2].steps.push_back({.bins = bins});
    for (const int bounces : {3, 4, 6, 10}) series[3].steps.push_back({.bounces = bounces});
    const int max_threads = core::thread_count();
    for (int threads = 1; threads < max_threads; threads *= 2) {
        series[4].steps.push_back({.points = 32, .threads = threads});
    }
    series[4].steps.push_back({.points = 32, .threads = max_threads});
    return series;
}

RenderScaling measure_series(const Series& series, Estimator method) {
    RenderScaling scaling{
        std::string(core::enum_name(method)), series.of, {}, {}, {}, {}, 0.0, 0.0};
    const bool by_threads = series.of == "threads";
    for (const Sizes& sizes : series.steps) {
        const Figures figures = measure(method, sizes);
        scaling.sizes.push_back(series.size(sizes));
        scaling.cpu_seconds.push_back(by_threads ? figures.elapsed_seconds : figures.cpu_seconds);
        scaling.limit_seconds.push_back(by_threads ? scaling.cpu_seconds.front() / sizes.threads
                                                   : figures.limit_seconds);
        scaling.peak_bytes.push_back(figures.peak_bytes);
    }
    if (scaling.sizes.size() < 2) return scaling;
    scaling.exponent = fit_power_law(scaling.sizes, scaling.cpu_seconds).exponent;
    scaling.last =
        fit_power_law(std::span(scaling.sizes).last(2), std::span(scaling.cpu_seconds).last(2))
            .exponent;
    return scaling;
}

}  // namespace

std::vector<RenderScaling> bench_render_scaling(const core::Progress& progress) {
    std::vector<RenderScaling> result;
    const std::vector<Series> all = all_series();
    for (const Series& series : all) {
        for (const Estimator method : series.methods) {
            progress.update(fraction_of(&series - all.data(), all.size()),
                            "scaling with " + series.of);
            result.push_back(measure_series(series, method));
        }
    }
    return result;
}

}  // namespace apps
