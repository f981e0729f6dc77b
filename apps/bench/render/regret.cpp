// SPDX-License-Identifier: MIT
#include "apps/bench/render/regret.h"

#include "apps/bench/command.h"
#include "apps/bench/render/third_bounce.h"
#include "apps/bench/scene.h"
#include "apps/bench/statistics.h"
#include "apps/shapes/shapes.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/statistics.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/estimators.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>

namespace apps {
namespace {

using renderer::Estimator;

constexpr std::uint64_t kSeedOfReferences = 1'000'000;
constexpr std::array kTargetErrors{0.05, 0.01, 0.003};  // the first is tried before the others
constexpr std::array kMostBounces{3, 5, 8};
constexpr std::array kGateWidths_mm{0.0, 100.0, 10.0, 2.0, 1.0};

/// A scene with its own scan, or one of wall points that any pattern may take.
struct RegretScene {
    const char* name;
    std::vector<std::string> overrides{};
    bool takes_patterns = false;
    renderer::SceneGeometry (*make)(core::Rng& rng) = nullptr;  ///< null: a scene of scenes/
};

/// A bumpy sphere: rough, fine and full of its own shadows.
renderer::SceneGeometry rough_geometry(core::Rng&) {
    constexpr int kCells = 100;
    constexpr double kRadius_m = 0.22;
    constexpr double kAmplitude = 0.2;  // of the radius
    const core::Vec3 center(0.0, 0.0, 0.7);
    renderer::Object object;
    object.mesh = make_sphere_mesh(center, kRadius_m, kCells);
    for (core::Vec3& vertex : object.mesh.vertices) {
        const core::Vec3 from_center = vertex - center;
        const core::Vec3 phase = 60.0 / kRadius_m * from_center;
        const double bump = std::sin(phase.x()) * std::sin(phase.y() + 1.0) * std::sin(phase.z());
        vertex = center + (1.0 + kAmplitude * bump) * from_center;
    }
    object.material.albedo = 0.7;
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(std::move(object));
    return geometry;
}

const std::vector<RegretScene>& regret_scenes() {
    static const std::vector<RegretScene> scenes{
        {"letter", {}, true},
        {"bars", {}, true},
        {"animal", {}, true},
        {"corner", {"render.by_order=false"}, true},
        {"curved"},
        {"room", {"camera.resolution=[32,24]"}},
        {"visitor",
         {R"(time_axis={"opl_start_m":0.0,"bin_width_m":0.03,"num_bins":160})",
          "render.direct_return=false"}},
        {"rough", {}, true, rough_geometry},
        {"random", {}, true, random_geometry}};
    return scenes;
}

/// What is rendered.
struct RegretJob {
    RegretRow row;
    core::Scan scan;
    std::shared_ptr<const renderer::Scene> scene;
    core::TimeAxis axis;
};

struct TimedRender {
    renderer::RenderResult result;
    double cpu_seconds = 0.0;
};

/// Renders until it is done, or for about so many CPU seconds.
TimedRender run(const RegretJob& job,
                renderer::RenderSettings settings,
                double most_seconds = std::numeric_limits<double>::infinity()) {
    settings.max_bounces = job.row.max_bounces;
    const double start = core::cpu_seconds();
    core::Progress progress;
    progress.stop_requested = [&] { return core::cpu_seconds() - start > most_seconds; };
    TimedRender timed{renderer::render(*job.scene, job.scan, {job.axis, {}}, settings, progress)};
    timed.cpu_seconds = core::cpu_seconds() - start;
    return timed;
}

template <class Choices>
auto drawn(const Choices& choices, core::Rng& rng) {
    const auto count = static_cast<double>(std::size(choices));
    return choices[static_cast<std::size_t>(rng.uniform() * count)];
}

renderer::SceneDescription description_of(const RegretScene& scene, core::ScanPattern pattern) {
    std::vector<std::string> overrides = scene.overrides;
    if (scene.takes_patterns) {
        const bool is_exhaustive = pattern == core::ScanPattern::Exhaustive;
        const int side = is_exhaustive ? 4 : 16;
        overrides.push_back("scan.pattern=" + std::string(core::enum_name(pattern)));
        overrides.push_back(fmt::format("scan.sensing_points=[{},{}]", side, side));
        if (is_exhaustive) {
            overrides.push_back(fmt::format("scan.illumination_points=[{},{}]", side, side));
        }
    }
    // What is made here has the letter's wall, scan and axis.
    return read_bench_scene(
        fmt::format("scenes/{}/scene.json", scene.make == nullptr ? scene.name : "letter"),
        overrides);
}

/// A gate where a tenth or nine tenths of the light have arrived.
core::TimeAxis gate_axis(const RegretJob& job) {
    renderer::RenderSettings settings;
    settings.method = Estimator::Path;
    settings.samples = 1024;
    const core::Capture light = run(job, settings).result.capture;
    const double fraction = job.row.gate_at == "early" ? 0.1 : 0.9;
    const double width_m = 1e-3 * job.row.gate_mm;
    const double center_m = job.axis.bin_center_m(bin_of_fraction(light, fraction));
    return {std::max(0.0, center_m - 0.5 * width_m), width_m, 1};
}

RegretJob draw_job(core::Rng& rng) {
    constexpr std::array kPatterns{
        core::ScanPattern::Confocal, core::ScanPattern::Single, core::ScanPattern::Exhaustive};
    const RegretScene scene = drawn(regret_scenes(), rng);
    const core::ScanPattern pattern = drawn(kPatterns, rng);
    RegretJob job;
    job.row.scene = scene.name;
    job.row.gate_mm = drawn(kGateWidths_mm, rng);
    job.row.max_bounces = drawn(kMostBounces, rng);
    job.row.target_error = drawn(kTargetErrors, rng);
    const bool is_early = rng.uniform() < 0.5;
    const renderer::SceneDescription description = description_of(scene, pattern);
    job.scan = renderer::make_scan(description);
    job.axis = description.time_axis;
    job.row.pattern = job.scan.has_wall() ? core::enum_name(job.scan.wall().pattern)
                      : job.scan.as<core::SensorScan>() != nullptr ? "sensor"
                                                                   : "camera";
    job.scene =
        scene.make == nullptr
            ? std::make_shared<const renderer::Scene>(renderer::load_scene(description, job.scan))
            : std::make_shared<const renderer::Scene>(
                  scene.make(rng), job.scan, description.relay_wall);
    if (job.row.gate_mm > 0.0) {
        job.row.gate_at = is_early ? "early" : "late";
        job.axis = gate_axis(job);
    }
    return job;
}

/// `auto` to the largest error, and to the job's where that does not take too long.
TimedRender run_auto(RegretJob& job, double most_seconds) {
    renderer::RenderSettings settings;
    settings.target_error = kTargetErrors.front();
    TimedRender timed = run(job, settings, most_seconds);
    const double asked = job.row.target_error;
    job.row.target_error = kTargetErrors.front();
    for (const double target : kTargetErrors) {
        const double expected = timed.cpu_seconds * std::pow(kTargetErrors.front() / target, 2);
        if (target >= asked && expected <= most_seconds) job.row.target_error = target;
    }
    if (job.row.target_error == kTargetErrors.front()) return timed;
    settings.target_error = job.row.target_error;
    return run(job, settings, most_seconds);
}

/// Two renders without bias; orders told apart are neither left out nor averaged over neighbours.
std::array<core::Capture, 2> references(const RegretJob& job, double auto_seconds) {
    renderer::RenderSettings settings;
    settings.by_order = true;
    settings.target_error = job.row.target_error / (job.row.max_bounces == 3 ? 4.0 : 2.0);
    settings.seconds = std::max(1.0, 8.0 * auto_seconds);
    settings.seed = kSeedOfReferences;
    core::Capture a = run(job, settings).result.capture;
    ++settings.seed;
    return {std::move(a), run(job, settings).result.capture};
}

bool can_render(const RegretJob& job, const renderer::RenderSettings& settings) {
    if (renderer::traits_of(settings.method).max_bounces < job.row.max_bounces) return false;
    renderer::RenderSettings of_job = settings;
    of_job.max_bounces = job.row.max_bounces;
    try {
        renderer::require_possible({*job.scene, job.scan, {job.axis, {}}, of_job, {}});
    } catch (const core::Error&) {
        return false;
    }
    return true;
}

std::string estimators_of(const renderer::RenderResult& result) {
    std::vector<std::string> names;
    for (const renderer::OrderSource& source : result.sources) {
        const std::string name(core::enum_name(source.estimator));
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

/// CPU time to the error asked for from that to the error reached. Integrators get no credit for
/// what they are better: they cannot stop earlier.
double seconds_to_target(const TimedRender& timed, double error, double target_error) {
    const bool is_integrated =
        std::ranges::all_of(timed.result.sources, [](const renderer::OrderSource& source) {
            return renderer::traits_of(source.estimator).is_deterministic;
        });
    const double above = error / target_error;
    return timed.cpu_seconds * (is_integrated ? std::max(1.0, above) : above * above);
}

RegretRow measure(RegretJob job, double most_seconds) {
    constexpr double kTimesAuto = 3.0;      // others are stopped then
    constexpr double kLeastSeconds = 0.05;  // what reading a scene takes
    RegretRow& row = job.row;
    const TimedRender own = run_auto(job, most_seconds);
    const auto [a, b] = references(job, own.cpu_seconds);
    const auto error_of = [&, &a = a, &b = b](const TimedRender& timed) {
        const ErrorSums sums = errors_of(timed.result.capture.transient, a.transient, b.transient);
        return std::sqrt(std::max(0.0, sums.rel_mse()));
    };
    row.error = error_of(own);
    row.cpu_seconds = own.cpu_seconds;
    row.chose = estimators_of(own.result);
    for (std::size_t i = 0; i < renderer::kEstimators.size(); ++i) {
        renderer::RenderSettings settings;
        settings.method = static_cast<Estimator>(i);
        settings.target_error = row.target_error;
        if (settings.method == Estimator::Auto || !can_render(job, settings)) continue;
        const TimedRender other =
            run(job, settings, kTimesAuto * std::max(kLeastSeconds, own.cpu_seconds));
        const double seconds = seconds_to_target(other, error_of(other), row.target_error);
        if (!row.best.empty() && seconds >= row.best_seconds) continue;
        row.best = renderer::kEstimators[i].name;
        row.best_seconds = seconds;
    }
    row.regret = std::max(kLeastSeconds, seconds_to_target(own, row.error, row.target_error)) /
                 std::max(kLeastSeconds, row.best_seconds);
    return row;
}

std::vector<Target> regret_targets(const std::vector<RegretRow>& rows) {
    std::vector<double> regrets;
    for (const RegretRow& row : rows) regrets.push_back(row.regret);
    std::vector<Target> targets;
    const auto add = [&](const char* name, double most, double ours) {
        targets.push_back(
            {name, fmt::format("<= {:g}", most), fmt::format("{:.3g}", ours), ours <= most});
    };
    add("median of all jobs", 1.05, core::median(regrets));
    add("95 % of them", 1.3, core::quantile(regrets, 0.95));
    add("the worst", 2.0, *std::ranges::max_element(regrets));
    return targets;
}

nlos::Plot regret_plot(const std::vector<RegretRow>& rows) {
    nlos::Plot plot{"Regret of auto", "fraction of jobs", "CPU time over the best one's", {}};
    plot.x_scale = nlos::AxisScale::Linear;
    plot.lines.emplace_back();
    for (std::size_t i = 0; i < rows.size(); ++i) {
        plot.lines[0].add(fraction_of(rows.size() - i, rows.size()), rows[i].regret);
    }
    return plot;
}

void declare_regret_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_regret);
    add_setting(command, "--jobs", settings.jobs, "Jobs drawn", {1, 10'000});
    add_setting(command, "--seed", settings.seed, "Seed of the drawing", {0, 1'000'000});
    add_setting(command, "--most-seconds", settings.most_seconds, "CPU time of auto per job, about")
        ->check(CLI::PositiveNumber);
}

}  // namespace

BenchResult measure_regret(const RegretBenchSettings& settings, const core::Progress& progress) {
    const core::ThreadLimit one_thread(1);
    std::vector<RegretRow> rows;
    for (int i = 0; i < settings.jobs; ++i) {
        core::Rng rng(static_cast<std::uint64_t>(settings.seed), static_cast<std::uint64_t>(i), 0);
        const RegretJob job = draw_job(rng);
        progress.update(fraction_of(i, settings.jobs),
                        fmt::format("{} {}, {} bounces, {} mm",
                                    job.row.scene,
                                    job.row.pattern,
                                    job.row.max_bounces,
                                    job.row.gate_mm));
        rows.push_back(measure(job, settings.most_seconds));
    }
    std::ranges::sort(rows, std::greater(), &RegretRow::regret);
    BenchResult result{
        {{"targets", core::write_value(regret_targets(rows))}, {"jobs", core::write_value(rows)}}};
    result.plots[""] = regret_plot(rows);
    return result;
}

extern const CommandRow kRegretBench{"regret",
                                     "How far auto is from the best estimator",
                                     "nlos bench regret -o out/bench --jobs 12 --most-seconds 1",
                                     declare_regret_bench};

}  // namespace apps
