// SPDX-License-Identifier: MIT
#include "apps/bench/render/third_bounce.h"

#include "apps/bench/lower_bounds.h"
#include "apps/bench/output.h"
#include "apps/bench/scene.h"
#include "apps/shapes/shapes.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/statistics.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/third_bounce/third_bounce.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace apps {
namespace {

using core::Vec3;
using renderer::ThirdBounce;

constexpr std::array kPatterns{
    core::ScanPattern::Confocal, core::ScanPattern::Single, core::ScanPattern::Exhaustive};

renderer::Object object_of(core::TriangleMesh mesh, double albedo) {
    renderer::Object object;
    object.mesh = std::move(mesh);
    object.material.albedo = albedo;
    return object;
}

core::WallScan random_scan(core::Rng& rng, core::ScanPattern pattern) {
    const int side = pattern == core::ScanPattern::Exhaustive ? 4 : 8;
    renderer::SceneDescription description;
    description.scan.pattern = {pattern};
    description.scan.sensing_points = {side, side};
    description.scan.illumination_points = {side, side};
    core::WallScan scan = renderer::make_scan(description).wall();
    if (pattern == core::ScanPattern::Single) {
        const double x = rng.uniform() - 0.5;
        scan.illumination.positions = {Vec3(x, rng.uniform() - 0.5, 0.0)};
    }
    return scan;
}

// What became of target errors on one random scene.
void try_targets(int number, core::Json& rows) {
    constexpr double kReferenceTarget = 1e-3;
    constexpr double kFarBelow = 5.0;
    const core::ScanPattern pattern =
        kPatterns[static_cast<std::size_t>(number) % kPatterns.size()];
    core::Rng rng(0, static_cast<std::uint64_t>(number), 0);
    const core::WallScan scan = random_scan(rng, pattern);
    const renderer::Scene scene(random_geometry(rng), scan, renderer::RelayWall{});
    const double bin_width = 0.006 + 0.02 * rng.uniform();
    const core::TimeAxis axis{0.4, bin_width, static_cast<int>(2.4 / bin_width)};
    const auto integrate = [&](double target) {
        renderer::RenderSettings settings;
        settings.target_error = target;
        return renderer::integrate_third_bounce(scene, scan, axis, settings, {});
    };
    const core::Capture reference = capture_of(scan, axis, integrate(kReferenceTarget).transient);
    struct Attempt {
        double target;
        ThirdBounce result;
        double rel_l2;
    };
    std::vector<Attempt> attempts;
    for (const double target : {10.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01}) {
        ThirdBounce result = integrate(target);
        const double rel_l2 = relative_l2(capture_of(scan, axis, result.transient), reference);
        attempts.push_back({target, std::move(result), rel_l2});
    }
    for (const auto& [target, result, rel_l2] : std::span(attempts).last(3)) {
        const bool coarser_would_do = std::ranges::any_of(attempts, [&](const Attempt& other) {
            return other.result.num_elements < result.num_elements && other.rel_l2 <= target;
        });
        rows.push_back(
            {{"scene", number},
             {"pattern", core::write_value(pattern)},
             {"target_error", target},
             {"rel_l2", rel_l2},                          // against the same to 0.1 %
             {"stated", result.estimated_error.value()},  // what the integrator says of itself
             {"elements", result.num_elements},           // that the surfaces were cut into
             {"coarser_would_do", coarser_would_do},      // fewer elements meet the target, too
             {"met", rel_l2 <= target},
             {"is_far_below", rel_l2 < target / kFarBelow && coarser_would_do}});
    }
}

// Bins that path knows to 10 %, and both bins beside them, stand for normal variables: next to
// others there may be rare bright paths of which a bin, and its variance, has not seen any. The
// integrator may err by `error` of the pair's largest bin.
core::Json compare_bins(const core::Capture& integrated, const core::Capture& paths, double error) {
    constexpr double kLargestRelativeSigma = 0.1;
    constexpr double kTwoSided95 = 1.959964;
    std::uint64_t num_bins = 0;
    std::uint64_t num_within = 0;
    double largest_z = 0.0;
    double sum_integrated = 0.0;
    double sum_paths = 0.0;
    double sum_variance = 0.0;
    for (std::size_t pair = 0; pair < paths.transient.num_pairs(); ++pair) {
        const auto a = integrated.transient.histogram(pair);
        const auto b = paths.transient.histogram(pair);
        const auto variance = paths.variance.value().histogram(pair);
        const double allowed = error * double{*std::max_element(a.begin(), a.end())};
        const auto is_known = [&](std::size_t bin) {
            const double sigma = std::sqrt(double{variance[bin]});
            return sigma > 0.0 && sigma <= kLargestRelativeSigma * double{b[bin]};
        };
        for (std::size_t bin = 0; bin < a.size(); ++bin) {
            sum_integrated += double{a[bin]};
            sum_paths += double{b[bin]};
            sum_variance += double{variance[bin]};
            if (bin == 0 || bin + 1 == a.size()) continue;
            if (!is_known(bin - 1) || !is_known(bin) || !is_known(bin + 1)) continue;
            const double sigma = std::sqrt(double{variance[bin]});
            const double difference = std::abs(double{a[bin]} - double{b[bin]});
            const double z = std::max(0.0, difference - allowed) / sigma;
            ++num_bins;
            if (z <= kTwoSided95) ++num_within;
            largest_z = std::max(largest_z, z);
        }
    }
    const double tail = std::erfc(largest_z / std::sqrt(2.0));
    return {{"num_bins", num_bins},  // that path knows to 10 %, and their neighbours, too
            {"within_95", num_bins > 0 ? fraction_of(num_within, num_bins) : 0.0},
            {"largest_z", largest_z},  // in standard deviations; its chance among so many bins:
            {"p_value", -std::expm1(static_cast<double>(num_bins) * std::log1p(-tail))},
            {"energy_ratio", sum_integrated / sum_paths},
            {"energy_sigma", std::sqrt(sum_variance) / sum_paths}};
}

// Some points of a confocal scan, spread over all of them and out of step with its rows; the laser
// point of a single scan is none of the others, those of an exhaustive one are.
core::WallScan few_points(const core::WallScan& all, core::ScanPattern pattern) {
    constexpr double kGolden = 0.6180339887498949;
    const auto spread = [&](std::size_t count, double phase) {
        core::WallPoints points;
        for (std::size_t i = 0; i < count; ++i) {
            const double fraction = std::fmod((static_cast<double>(i) + phase) * kGolden, 1.0);
            const auto index =
                static_cast<std::size_t>(fraction * static_cast<double>(all.sensing.size()));
            points.positions.push_back(all.sensing.positions[index]);
            points.normals.push_back(all.sensing.normals[index]);
        }
        return points;
    };
    core::WallScan scan = all;
    scan.pattern = pattern;
    scan.sensing = spread(16, 0.5);
    scan.illumination = pattern == core::ScanPattern::Confocal ? scan.sensing
                        : pattern == core::ScanPattern::Single ? spread(1, 0.8)
                                                               : spread(3, 0.5);
    return scan;
}

// How the integrator and path agree on a scene.
core::Json compare_with_path(const std::string& path, core::ScanPattern pattern) {
    constexpr double kTarget = 5e-4;
    constexpr int kSamples = 100'000;
    const BenchScene bench(path);
    const core::WallScan scan = few_points(bench.scan().wall(path), pattern);
    const auto render = [&](const renderer::RenderSettings& settings) {
        return renderer::render(bench.scene(), scan, bench.axis(), settings, {}).capture;
    };
    renderer::RenderSettings settings = bench.settings();
    settings.max_bounces = 3;
    settings.by_order = false;
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = kTarget;
    const core::Capture integrated = render(settings);
    settings.method = renderer::Estimator::Path;
    settings.target_error.reset();
    settings.samples = kSamples;
    settings.variance = true;
    core::Json row{{"scene", path}, {"pattern", core::write_value(pattern)}};
    row.update(compare_bins(integrated, render(settings), kTarget));
    return row;
}

constexpr double kCostTarget = 0.01;
constexpr double kCostReferenceTarget = 0.002;
constexpr double kGate_m = 0.01;

core::Json cost_of(const std::string& measurement,
                   const BenchScene& bench,
                   const core::TimeAxis& axis,
                   int repeats) {
    renderer::RenderSettings settings = bench.settings();
    const auto integrate = [&](double target) {
        settings.target_error = target;
        return renderer::integrate_third_bounce(
            bench.scene(), bench.scan().wall(), axis, settings, {});
    };
    const core::Capture reference =
        capture_of(bench.scan(), axis, integrate(kCostReferenceTarget).transient);
    double rel_l2 = 0.0;
    double million_rays = 0.0;
    std::vector<double> seconds;
    std::vector<double> tracing_seconds;
    std::vector<double> ray_seconds;
    for (int i = 0; i < repeats; ++i) {
        const double start = core::cpu_seconds();
        const renderer::ThirdBounce result = integrate(kCostTarget);
        seconds.push_back(core::cpu_seconds() - start);
        tracing_seconds.push_back(result.tracing_seconds);
        ray_seconds.push_back(shadow_ray_seconds(bench.scene(), bench.scan().wall()));
        million_rays = 1e-6 * static_cast<double>(result.num_rays);
        rel_l2 = relative_l2(capture_of(bench.scan(), axis, result.transient), reference);
    }
    const double cpu_seconds = core::median(seconds);
    return {{"measurement", measurement},
            {"cpu_seconds", cpu_seconds},
            {"share", nullptr},  // of the histogram's
            {"rel_l2", rel_l2},  // against the same to 0.2 %
            {"million_rays", million_rays},
            // 1e6 rays per second: while rays are traced, and of the whole.
            {"tracing_rate", million_rays / core::median(tracing_seconds)},
            {"whole_rate", million_rays / cpu_seconds},
            // Of Embree alone, with other rays: see shadow_ray_seconds().
            {"embree_rate", 1e-6 / core::median(ray_seconds)}};
}

}  // namespace

renderer::SceneGeometry random_geometry(core::Rng& rng) {
    const auto between = [&](double low, double high) {
        return low + (high - low) * rng.uniform();
    };
    // One by one: the order in which arguments are evaluated is not fixed.
    const auto vector = [&](double most_xy, double min_z, double max_z) {
        const double x = between(-most_xy, most_xy);
        const double y = between(-most_xy, most_xy);
        return Vec3(x, y, between(min_z, max_z));
    };
    renderer::SceneGeometry geometry;
    const int num_spheres = 1 + static_cast<int>(2.0 * rng.uniform());
    for (int i = 0; i < num_spheres; ++i) {
        const Vec3 center = vector(0.3, 0.5, 0.9);
        const double radius = between(0.05, 0.15);
        const int cells = 6 * (1 + static_cast<int>(2.0 * rng.uniform()));
        geometry.objects.push_back(
            object_of(make_sphere_mesh(center, radius, cells), between(0.3, 1.0)));
    }
    const int num_sheets = 1 + static_cast<int>(3.0 * rng.uniform());
    for (int i = 0; i < num_sheets; ++i) {
        const Vec3 middle = vector(0.4, 0.3, 1.0);
        const Vec3 half_u = vector(0.15, -0.05, 0.05);
        const Vec3 half_v = vector(0.15, -0.05, 0.05);
        geometry.objects.push_back(object_of(
            make_grid_mesh(
                1, [&](double u, double v) { return Vec3(middle + u * half_u + v * half_v); }),
            between(0.1, 1.0)));
    }
    return geometry;
}

core::Json bench_target_errors(int num_scenes, const core::Progress& progress) {
    core::Json rows = core::Json::array();
    for (int scene = 0; scene < num_scenes; ++scene) {
        progress.update(fraction_of(scene, num_scenes), "target errors");
        try_targets(scene, rows);
    }
    return rows;
}

core::Json bench_agreement(const std::vector<std::string>& scenes, const core::Progress& progress) {
    core::Json rows = core::Json::array();
    for (const std::string& scene : scenes) {
        for (const core::ScanPattern pattern : kPatterns) {
            progress.update(fraction_of(rows.size(), kPatterns.size() * scenes.size()),
                            "agreement with path");
            rows.push_back(compare_with_path(scene, pattern));
        }
    }
    return rows;
}

core::Json bench_third_bounce_costs(const std::string& scene_path, int repeats) {
    const core::ThreadLimit one_thread(1);
    const BenchScene bench(scene_path);
    renderer::RenderSettings settings = bench.settings();
    settings.method = renderer::Estimator::ThirdBounce;
    const core::Capture capture = bench.render(settings);
    core::Json costs = core::Json::array();
    costs.push_back(cost_of("histogram", bench, bench.axis(), repeats));
    for (const double fraction : {0.1, 0.5, 0.9}) {
        const double opl = bench.axis().bin_begin_m(bin_of_fraction(capture, fraction));
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
    for (core::Json& cost : costs) {
        cost["share"] =
            fraction_of(cost["cpu_seconds"].get<double>(), costs[0]["cpu_seconds"].get<double>());
    }
    return costs;
}

}  // namespace apps
