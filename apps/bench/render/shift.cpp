// SPDX-License-Identifier: MIT
#include "apps/bench/command.h"
#include "apps/bench/render/shift_workbench.h"
#include "apps/commands.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/shift/charts.h"
#include "renderer/shift/path_functional.h"
#include "renderer/shift/shift_mapping.h"
#include "renderer/shift/shift_side.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace apps {
namespace {

using core::Vec2;
using core::Vec3;
using renderer::Chart;
using renderer::Gauge;
using renderer::ShiftMapping;
using renderer::ShiftSettings;

constexpr int kRepeats = 3;  ///< timings: the quickest counts
constexpr int kMaxDifferences = 500;
constexpr std::size_t kMaxFlowShifts = 300;  ///< one takes thousands of evaluations

std::optional<renderer::ShiftedPath> apply(const ShiftMapping& mapping,
                                           const Shift& shift,
                                           renderer::ShiftCounts& counts) {
    return mapping.shift_path(shift.x, shift.source, shift.target, shift.change, counts);
}

// CPU nanoseconds per item of `body(i)`, i in [0, count).
template <class Body>
double time_ns(std::size_t count, const Body& body) {
    double best = std::numeric_limits<double>::infinity();
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
        const double start = core::cpu_seconds();
        for (std::size_t i = 0; i < count; ++i) body(i);
        best = std::min(best, core::cpu_seconds() - start);
    }
    return 1e9 * best / double(count);
}

double time_shifts(const ShiftMapping& mapping, const std::vector<Shift>& shifts) {
    renderer::ShiftCounts counts;
    return time_ns(shifts.size(), [&](std::size_t i) { apply(mapping, shifts[i], counts); });
}

renderer::ShiftCounts count_shifts(const ShiftMapping& mapping, const std::vector<Shift>& shifts) {
    renderer::ShiftCounts counts;
    for (const Shift& shift : shifts) apply(mapping, shift, counts);
    return counts;
}

// Share of accepted shifts whose way back does not lead to x.
double share_without_return(const ShiftMapping& mapping, const std::vector<Shift>& shifts) {
    renderer::ShiftCounts counts;
    double there = 0.0;
    double lost = 0.0;
    for (const Shift& shift : shifts) {
        const auto result = apply(mapping, shift, counts);
        if (!result) continue;
        const auto back = apply(
            mapping, {result->point, shift.target, shift.source, shift.change.inverse()}, counts);
        const double leg = (shift.source.a - shift.x.position).norm();
        const bool returns = back && (back->point.position - shift.x.position).norm() <= 1e-6 * leg;
        there += 1.0;
        lost += returns ? 0.0 : 1.0;
    }
    return there > 0.0 ? lost / there : 0.0;
}

// Relative error of the determinant against central differences on the surface.
std::optional<double> determinant_error(const renderer::Scene& scene,
                                        const ShiftMapping& mapping,
                                        const Shift& shift) {
    renderer::ShiftCounts counts;
    const auto landing = apply(mapping, shift, counts);
    if (!landing) return std::nullopt;
    const double step = 1e-4 * (shift.source.a - shift.x.position).norm();
    const core::Mat3 frame = scene.facet(shift.x.facet).world_from_facet();
    const core::Mat3 image = scene.facet(landing->point.facet).world_from_facet();
    Eigen::Matrix2d derivative;
    for (int axis = 0; axis < 2; ++axis) {
        const auto at = [&](double side) -> std::optional<Vec3> {
            Shift near = shift;
            near.x.position += side * step * frame.col(axis);
            const auto result = apply(mapping, near, counts);
            // Across an edge the map has a kink.
            if (!result || result->point.facet != landing->point.facet) return std::nullopt;
            return Vec3(image.transpose() * (result->point.position - landing->point.position));
        };
        const auto plus = at(1.0);
        const auto minus = at(-1.0);
        if (!plus || !minus) return std::nullopt;
        derivative.col(axis) = (*plus - *minus).head<2>() / (2.0 * step);
    }
    return std::abs(landing->jacobian / std::abs(derivative.determinant()) - 1.0);
}

// One gauge in one chart, as a row of the table.
core::Json measure_gauge(const ShiftWorkbench& bench, ShiftSettings settings) {
    settings.closed_form_on_planes = false;
    std::vector<Shift> shifts = bench.shifts();
    if (settings.gauge == Gauge::Flow) shifts.resize(std::min(shifts.size(), kMaxFlowShifts));
    std::string gauge(core::enum_name(settings.gauge));
    if (settings.gauge == Gauge::Average && settings.chart == Chart::Hemisphere) {
        gauge += settings.metric_gauge ? ", metric" : ", plain";
    }
    const ShiftMapping checked(bench.scene(), settings);
    settings.reverse_check = false;
    const ShiftMapping unchecked(bench.scene(), settings);
    const auto tried = double(shifts.size());
    core::Json row{{"chart", core::write_value(settings.chart)}, {"gauge", gauge}};
    // Share accepted, reverse check on; share of shifts accepted without the check that do not come
    // back; Newton or Runge-Kutta steps per shift tried, without the check.
    row["success"] = double(count_shifts(checked, shifts).accepted) / tried;
    row["no_return"] = share_without_return(unchecked, shifts);
    row["iterations"] = double(count_shifts(unchecked, shifts).iterations) / tried;
    // CPU time per shift tried, without the check and with it.
    row["ns"] = time_shifts(unchecked, shifts);
    row["ns_checked"] = time_shifts(checked, shifts);
    // Of the determinant, relative, against central differences.
    std::vector<double> errors;
    for (std::size_t i = 0; i < shifts.size() && int(errors.size()) < kMaxDifferences; ++i) {
        const auto error = determinant_error(bench.scene(), unchecked, shifts[i]);
        if (error) errors.push_back(*error);
    }
    std::sort(errors.begin(), errors.end());
    row["error_median"] = errors.empty() ? 0.0 : errors[errors.size() / 2];
    row["error_p95"] = errors.empty() ? 0.0 : errors[errors.size() * 95 / 100];
    return row;
}

// One chart on one scene: shares of the shifts tried, and CPU time per shift.
core::Json measure_chart(const ShiftWorkbench& bench, const std::string& path, Chart chart) {
    ShiftSettings settings;
    settings.chart = chart;
    const ShiftMapping mapping(bench.scene(), settings);
    const renderer::ShiftCounts counts = count_shifts(mapping, bench.shifts());
    const auto tried = double(counts.tried());
    core::Json rejected = core::Json::array();
    for (std::size_t i = 0; i < counts.rejected.size(); ++i) {
        if (counts.rejected[i] == 0) continue;
        rejected.push_back({{"name", std::string(renderer::kShiftRejectionNames[i])},
                            {"share", double(counts.rejected[i]) / tried}});
    }
    std::stable_sort(rejected.begin(), rejected.end(), [](const auto& a, const auto& b) {
        return a["share"] > b["share"];
    });
    return {{"scene", path},
            {"chart", core::write_value(chart)},
            {"accepted", double(counts.accepted) / tried},
            {"by_ray", double(counts.by_ray) / tried},
            {"ns", time_shifts(mapping, bench.shifts())},
            {"rejected", rejected}};
}

// Where the time of a shift goes.
core::Json measure_costs(const ShiftWorkbench& bench) {
    const auto& shifts = bench.shifts();
    const renderer::Scene& scene = bench.scene();
    const renderer::PlanarPatches patches(scene);
    renderer::ShiftTrace trace;
    double sink = 0.0;  // keeps the timed work alive; what it adds up to is no matter
    core::Json costs = core::Json::array();
    const auto add = [&](const std::string& operation, const auto& body) {
        costs.push_back({{"operation", operation}, {"ns", time_ns(shifts.size(), body)}});
    };
    const auto plane_of = [&](const Shift& shift) -> const renderer::Facet& {
        return patches.plane(patches.patch_of(shift.x.facet));
    };
    add("closed form on a plane", [&](std::size_t i) {
        const Shift& s = shifts[i];
        const Vec3& x = s.x.position;
        const auto moved = shift_on_plane(plane_of(s),
                                          {s.source.a - x, s.source.y - x},
                                          {s.target.a - x, s.target.y - x},
                                          s.change,
                                          0.0,
                                          trace);
        sink += moved ? moved->jacobian : 0.0;
    });
    add("finding a point's facet", [&](std::size_t i) {
        const auto& x = shifts[i].x;
        sink += *patches.locate(patches.patch_of(x.facet), x.position, x.facet);
    });
    add("length, slope, Hessian on a plane", [&](std::size_t i) {
        const Shift& s = shifts[i];
        const renderer::Facet& plane = plane_of(s);
        const renderer::AffineChart chart(
            Vec3::Zero(), plane.edge1, plane.edge2, Vec3::Zero(), 0.0);
        const renderer::ShiftSide<renderer::AffineChart, renderer::OpticalLength> side{
            chart,
            renderer::OpticalLength{s.source.a - s.x.position, s.source.y - s.x.position},
            1.0};
        sink += side.at(Vec2::Zero())->h12;
    });
    add("ray from y", [&](std::size_t i) {
        const Shift& s = shifts[i];
        const Vec3 direction = (s.x.position - s.source.y).normalized();
        const auto hit = scene.rays().first_hit(s.source.y, s.source.normal_y, direction);
        sink += hit ? hit->distance_m : 0.0;
    });
    add("point of the hemisphere, ray included", [&](std::size_t i) {
        const Shift& s = shifts[i];
        const renderer::HemisphereChart chart(
            scene, s.source.y, s.source.normal_y, s.x.position, 0.0);
        const auto xi = chart.coordinates_of(s.x.position);
        const auto point = xi ? chart.at(*xi) : std::nullopt;
        sink += point ? point->second12.x() : 0.0;
    });
    if (!std::isfinite(sink)) throw core::Failure("bench shift", "a shift is not finite");
    return costs;
}

core::Json measure_gauges(const ShiftWorkbench& bench, const core::Progress& progress) {
    core::Json rows = core::Json::array();
    for (const Chart chart : {Chart::Plane, Chart::Hemisphere}) {
        for (const auto& [gauge, name] : core::EnumNames<Gauge>::value) {
            progress.update(0.0, "gauges");
            ShiftSettings settings;
            settings.chart = chart;
            settings.gauge = gauge;
            rows.push_back(measure_gauge(bench, settings));
            if (gauge != Gauge::Average || chart == Chart::Plane) continue;
            settings.metric_gauge = false;
            rows.push_back(measure_gauge(bench, settings));
        }
    }
    return rows;
}

struct ShiftBenchSettings {
    std::vector<std::string> scenes{
        "scenes/corner/scene.json", "scenes/letter/scene.json", "scenes/bars/scene.json"};
    int shifts = 20'000;
};

/// Compares charts of the shift mapping on all scenes, gauges and the parts of a shift on the first,
/// on one thread.
BenchResult measure(const ShiftBenchSettings& settings, const core::Progress& progress) {
    const core::ThreadLimit one_thread(1);
    core::Json figures{{"gauge_scene", settings.scenes.front()},
                       {"gauges", core::Json::array()},
                       {"charts", core::Json::array()},
                       {"costs", core::Json::array()}};
    for (std::size_t s = 0; s < settings.scenes.size(); ++s) {
        const std::string& path = settings.scenes[s];
        const ShiftWorkbench bench(path, settings.shifts);
        for (const Chart chart :
             {Chart::Plane, Chart::Barycentric, Chart::Hemisphere, Chart::Adaptive}) {
            progress.update(share_of(s, settings.scenes.size()), path);
            figures["charts"].push_back(measure_chart(bench, path, chart));
        }
        if (s > 0) continue;
        figures["gauges"] = measure_gauges(bench, progress);
        figures["costs"] = measure_costs(bench);
    }
    return {figures};
}

void declare(CLI::App& command, ShiftBenchSettings& settings) {
    add_setting(command, "--scene", settings.scenes, "Scene descriptions; gauges on the first");
    add_setting(command, "--shifts", settings.shifts, "Shifts per scene", {1, 100'000'000});
}

}  // namespace

void add_bench_shift_command(CLI::App& bench) {
    add_benchmark<ShiftBenchSettings>(bench,
                                      {"shift",
                                       "Gauges and charts of the path-length-aware shift",
                                       "nlos bench shift -o out/bench"},
                                      declare,
                                      measure);
}

}  // namespace apps
