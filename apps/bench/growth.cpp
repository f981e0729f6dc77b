// SPDX-License-Identifier: MIT
#include "apps/bench/growth.h"

#include "apps/bench/power_law.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/render.h"
#include "renderer/scene_file.h"

#include <fmt/core.h>

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
};

// A sheet of 0.8 m with waves of 4 cm, 1 m behind the wall.
renderer::Object sheet(int cells) {
    renderer::Object object;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double x = 2.0 * i / cells - 1.0;
            const double y = 2.0 * j / cells - 1.0;
            const double z = 1.0 + 0.04 * std::sin(5.0 * x + 1.0) * std::cos(4.0 * y);
            object.mesh.vertices.emplace_back(0.4 * x, 0.4 * y, z);
        }
    }
    const auto index = [&](int i, int j) {
        return static_cast<std::uint32_t>(j * (cells + 1) + i);
    };
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
            object.mesh.triangles.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
        }
    }
    return object;
}

double seconds_of(Estimator method, const Sizes& sizes) {
    renderer::SceneDescription description;
    description.scan.sensing_points = {sizes.points, sizes.points};
    description.time_axis = {1.4, kSpan_m / sizes.bins, sizes.bins};
    description.render.method = method;
    description.render.max_bounces = sizes.bounces;
    description.render.samples = 256;
    if (method == Estimator::ThirdBounce) description.render.target_error = 0.02;
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene({{sheet(sizes.cells)}, {}}, scan, {});
    const double start = core::cpu_seconds();
    renderer::render(scene, scan, description.time_axis, description.render, {});
    return core::cpu_seconds() - start;
}

struct Series {
    std::string of;
    std::vector<Sizes> steps;
    double (*size)(const Sizes&);
};

std::vector<Series> all_series() {
    std::vector<Series> series{
        {"triangles", {}, [](const Sizes& s) { return 2.0 * s.cells * s.cells; }},
        {"wall points", {}, [](const Sizes& s) { return 1.0 * s.points * s.points; }},
        {"bins", {}, [](const Sizes& s) { return 1.0 * s.bins; }},
        {"bounces", {}, [](const Sizes& s) { return 1.0 * s.bounces; }}};
    for (const int cells : {16, 50, 158, 500}) series[0].steps.push_back({.cells = cells});
    for (const int points : {8, 16, 32, 64}) series[1].steps.push_back({.points = points});
    for (const int bins : {64, 256, 1024, 4096}) series[2].steps.push_back({.bins = bins});
    for (const int bounces : {3, 4, 6, 10}) series[3].steps.push_back({.bounces = bounces});
    return series;
}

}  // namespace

std::vector<RenderGrowth> bench_render_growth(const core::Progress& progress) {
    const core::ThreadLimit one_thread(1);
    std::vector<RenderGrowth> result;
    for (const Series& series : all_series()) {
        for (const Estimator method : {Estimator::ThirdBounce, Estimator::Path}) {
            if (method == Estimator::ThirdBounce && series.of == "bounces") continue;
            RenderGrowth growth{std::string(core::enum_name(method)), series.of, {}, {}, 0.0, 0.0};
            for (const Sizes& sizes : series.steps) {
                if (progress.should_stop()) throw core::Failure("bench", "interrupted");
                progress.update(double(result.size()) / 7.0, "growth with " + series.of);
                growth.sizes.push_back(series.size(sizes));
                growth.cpu_seconds.push_back(seconds_of(method, sizes));
            }
            growth.exponent = fit_power_law(growth.sizes, growth.cpu_seconds).exponent;
            growth.last = fit_power_law(std::span(growth.sizes).last(2),
                                        std::span(growth.cpu_seconds).last(2))
                              .exponent;
            result.push_back(std::move(growth));
        }
    }
    return result;
}

}  // namespace apps
