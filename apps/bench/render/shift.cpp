// SPDX-License-Identifier: MIT
#include "apps/bench/render/shift.h"

#include "apps/bench/scene.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/core/random.h"
#include "renderer/scene/area_sampler.h"
#include "renderer/scene/scene_file.h"
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

struct Shift {
    renderer::SurfacePoint x;
    renderer::ShiftEnd source;
    renderer::ShiftEnd target;
    renderer::ConstraintChange change;
};

// A scene with shifts to try on it.
class ShiftWorkbench {
 public:
    ShiftWorkbench(const std::string& path, int num_shifts)
        : description_(read_bench_scene(path, {})),
          scan_(renderer::make_scan(description_)),
          scene_(renderer::load_scene(description_, scan_)) {
        const renderer::AreaSampler sampler(scene_);
        // Behind or beside everything the scan sees nothing; such a scene ends after many tries.
        const std::uint64_t most = 1000 * static_cast<std::uint64_t>(num_shifts);
        for (std::uint64_t i = 0; i < most && int(shifts_.size()) < num_shifts; ++i) {
            core::Rng rng(0, i, 0);
            if (const auto shift = draw(sampler, rng)) shifts_.push_back(*shift);
        }
        if (shifts_.empty()) {
            throw core::Error(path, "found no surface that the scan sees", "must have one");
        }
    }

    const renderer::Scene& scene() const { return scene_; }
    const std::vector<Shift>& shifts() const { return shifts_; }

 private:
    renderer::ShiftEnd end_of(std::size_t pair) const {
        const std::size_t l = scan_.illumination_index(pair);
        const core::WallPoints& lit = scan_.illumination;
        return {
            scan_.sensing.positions[scan_.sensing_index(pair)], lit.positions[l], lit.normals[l]};
    }

    // Cosine at x towards a point that sees it, 0 when it does not.
    double seen_cosine(const renderer::SurfacePoint& x, const Vec3& from, const Vec3& n) const {
        const Vec3& normal = scene_.facet(x.facet).normal;
        const Vec3 to_x = (x.position - from).normalized();
        if (n.dot(to_x) <= 0.0) return 0.0;
        if (scene_.rays().is_blocked(from, n, x.position, normal)) return 0.0;
        return std::abs(normal.dot(to_x));
    }

    std::optional<Shift> draw(const renderer::AreaSampler& sampler, core::Rng& rng) const {
        const std::size_t pairs = scan_.num_pairs();
        const auto pair = static_cast<std::size_t>(rng.uniform() * double(pairs));
        const std::size_t next = pair + 1 < pairs ? pair + 1 : pair - 1;
        Shift shift;
        const double u = rng.uniform();
        shift.x = sampler.sample(u, rng.uniform());
        shift.source = end_of(pair);
        shift.target = end_of(next);
        const Vec3& sensing_normal = scan_.sensing.normals[scan_.sensing_index(pair)];
        const double accept = seen_cosine(shift.x, shift.source.a, sensing_normal) *
                              seen_cosine(shift.x, shift.source.y, shift.source.normal_y);
        if (rng.uniform() >= accept) return std::nullopt;
        const double bin = description_.time_axis.bin_width_m;
        shift.change.offset_m = bin * (2.0 * rng.uniform() - 1.0);
        return shift;
    }

    renderer::SceneDescription description_;
    core::Scan scan_;
    renderer::Scene scene_;
    std::vector<Shift> shifts_;
};

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

GaugeRow measure_gauge(const ShiftWorkbench& bench, ShiftSettings settings) {
    settings.closed_form_on_planes = false;
    std::vector<Shift> shifts = bench.shifts();
    if (settings.gauge == Gauge::Flow) shifts.resize(std::min(shifts.size(), kMaxFlowShifts));
    GaugeRow row;
    row.chart = core::enum_name(settings.chart);
    row.gauge = core::enum_name(settings.gauge);
    if (settings.gauge == Gauge::Average && settings.chart == Chart::Hemisphere) {
        row.gauge += settings.metric_gauge ? ", metric" : ", plain";
    }
    const ShiftMapping checked(bench.scene(), settings);
    settings.reverse_check = false;
    const ShiftMapping unchecked(bench.scene(), settings);
    const auto tried = double(shifts.size());
    row.success = double(count_shifts(checked, shifts).accepted) / tried;
    row.iterations = double(count_shifts(unchecked, shifts).iterations) / tried;
    row.no_return = share_without_return(unchecked, shifts);
    row.ns = time_shifts(unchecked, shifts);
    row.ns_checked = time_shifts(checked, shifts);
    std::vector<double> errors;
    for (std::size_t i = 0; i < shifts.size() && int(errors.size()) < kMaxDifferences; ++i) {
        const auto error = determinant_error(bench.scene(), unchecked, shifts[i]);
        if (error) errors.push_back(*error);
    }
    if (!errors.empty()) {
        std::sort(errors.begin(), errors.end());
        row.error_median = errors[errors.size() / 2];
        row.error_p95 = errors[errors.size() * 95 / 100];
    }
    return row;
}

ChartRow measure_chart(const ShiftWorkbench& bench, Chart chart) {
    ShiftSettings settings;
    settings.chart = chart;
    const ShiftMapping mapping(bench.scene(), settings);
    const renderer::ShiftCounts counts = count_shifts(mapping, bench.shifts());
    const auto tried = double(counts.tried());
    ChartRow row;
    row.chart = core::enum_name(chart);
    row.accepted = double(counts.accepted) / tried;
    row.by_ray = double(counts.by_ray) / tried;
    row.ns = time_shifts(mapping, bench.shifts());
    for (std::size_t i = 0; i < counts.rejected.size(); ++i) {
        if (counts.rejected[i] == 0) continue;
        row.rejected.push_back(
            {std::string(renderer::kShiftRejectionNames[i]), double(counts.rejected[i]) / tried});
    }
    std::stable_sort(row.rejected.begin(), row.rejected.end(), [](const auto& a, const auto& b) {
        return a.share > b.share;
    });
    return row;
}

std::vector<ShiftCost> measure_costs(const ShiftWorkbench& bench) {
    const auto& shifts = bench.shifts();
    const renderer::Scene& scene = bench.scene();
    const renderer::PlanarPatches patches(scene);
    renderer::ShiftTrace trace;
    double sink = 0.0;  // keeps the timed work alive; what it adds up to is no matter
    std::vector<ShiftCost> costs;
    const auto add = [&](const std::string& operation, const auto& body) {
        costs.push_back({operation, time_ns(shifts.size(), body)});
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

}  // namespace

ShiftBench bench_shift(const std::vector<std::string>& scene_paths,
                       int num_shifts,
                       const core::Progress& progress) {
    const core::ThreadLimit one_thread(1);
    ShiftBench result;
    for (std::size_t s = 0; s < scene_paths.size(); ++s) {
        const std::string& path = scene_paths[s];
        progress.update(double(s) / double(scene_paths.size()), path);
        const ShiftWorkbench bench(path, num_shifts);
        for (const Chart chart :
             {Chart::Plane, Chart::Barycentric, Chart::Hemisphere, Chart::Adaptive}) {
            if (progress.should_stop()) throw core::Failure("bench shift", "interrupted");
            result.charts.push_back(measure_chart(bench, chart));
            result.charts.back().scene = path;
        }
        if (s > 0) continue;
        result.gauge_scene = path;
        for (const Chart chart : {Chart::Plane, Chart::Hemisphere}) {
            for (const auto& [gauge, name] : core::EnumNames<Gauge>::value) {
                if (progress.should_stop()) throw core::Failure("bench shift", "interrupted");
                ShiftSettings settings;
                settings.chart = chart;
                settings.gauge = gauge;
                result.gauges.push_back(measure_gauge(bench, settings));
                if (gauge != Gauge::Average || chart == Chart::Plane) continue;
                settings.metric_gauge = false;
                result.gauges.push_back(measure_gauge(bench, settings));
            }
        }
        result.costs = measure_costs(bench);
    }
    return result;
}

}  // namespace apps
