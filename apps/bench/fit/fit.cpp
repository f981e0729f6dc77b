// SPDX-License-Identifier: MIT
#include "apps/bench/fit/fit.h"

#include "apps/bench/command.h"
#include "apps/bench/fit/fit_trials.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/system/process.h"
#include "renderer/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace apps {
namespace {

using core::Vec3;

// Root mean squares over fits of one pose.
struct PoseSummary {
    double lateral_m = 0.0;
    double depth_m = 0.0;
    double spin_deg = 0.0;
    double tilt_deg = 0.0;
    double over_bound = 0.0;  ///< RMS error over the RMS reported one
    double normalised_square = 0.0;
    double cpu_seconds = 0.0;
    double iterations = 0.0;

    void add(const TrialError& error, int trials) {
        lateral_m += error.lateral_m * error.lateral_m / trials;
        depth_m += error.depth_m * error.depth_m / trials;
        spin_deg += error.spin_deg * error.spin_deg / trials;
        tilt_deg += error.tilt_deg * error.tilt_deg / trials;
    }

    void take_roots() {
        for (double* square : {&lateral_m, &depth_m, &spin_deg, &tilt_deg}) {
            *square = std::sqrt(*square);
        }
    }
};

PoseSummary summarise(const TrialSetup& setup, int trials) {
    PoseSummary summary;
    double error2 = 0.0;
    const TrialPose truth = standard_pose();
    const core::Capture light = expected_light(truth);
    for (int i = 0; i < trials; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const core::Capture counts = counted_capture(setup, light, 0.0, seed);
        const double begin = core::cpu_seconds();
        const calib::FitResult fit =
            calib::fit_scene(trial_input(setup, counts, displaced(truth, 0.03, 8.0, seed)), {});
        summary.cpu_seconds += core::cpu_seconds() - begin;
        summary.iterations += fit.iterations;
        const TrialError error = trial_error(fit, truth);
        summary.add(error, trials);
        const Vec3 sigma = fit.objects[0].position_sigma_m;
        const Vec3 turn_sigma = fit.objects[0].rotation_sigma_deg;
        error2 += error.position_m.squaredNorm() / sigma.squaredNorm() +
                  error.turn_deg.squaredNorm() / turn_sigma.squaredNorm();
        Eigen::Matrix<double, 6, 1> all;
        all << error.position_m, error.turn_deg / core::kDegreesPerRadian;
        const Eigen::MatrixXd covariance = fit.covariance.topLeftCorner<6, 6>();
        summary.normalised_square += all.dot(covariance.ldlt().solve(all)) / 6.0;
    }
    summary.take_roots();
    summary.over_bound = std::sqrt(error2 / (2.0 * trials));
    summary.normalised_square /= trials;
    summary.cpu_seconds /= trials;
    summary.iterations /= trials;
    return summary;
}

std::string pose_text(const PoseSummary& s) {
    return fmt::format("{:.2f} mm / {:.2f} mm / {:.2f} deg / {:.2f} deg",
                       s.lateral_m / kMillimetre,
                       s.depth_m / kMillimetre,
                       s.spin_deg,
                       s.tilt_deg);
}

bool within(const PoseSummary& s, double lateral, double depth, double spin, double tilt) {
    return s.lateral_m < lateral * kMillimetre && s.depth_m < depth * kMillimetre &&
           s.spin_deg < spin && s.tilt_deg < tilt;
}

void bench_pose(int trials, FitBench& bench) {
    TrialSetup setup;
    const PoseSummary many = summarise(setup, trials);
    bench.rows.push_back({"pose RMS, 1e5 photons: lateral / depth / spin / tilt",
                          "0.9 mm / 0.25 mm / 0.5 deg / 0.1 deg",
                          pose_text(many),
                          within(many, 0.9, 0.25, 0.5, 0.1)});
    setup.photons = 1e4;
    const PoseSummary few = summarise(setup, trials);
    bench.rows.push_back({"pose RMS, 1e4 photons",
                          "3 mm / 0.8 mm / 1.3 deg / 0.3 deg",
                          pose_text(few),
                          within(few, 3.0, 0.8, 1.3, 0.3)});
    bench.rows.push_back({"RMS over Cramer-Rao bound, 1e5 / 1e4 photons",
                          "<= 1.3",
                          fmt::format("{:.2f} / {:.2f}", many.over_bound, few.over_bound),
                          many.over_bound <= 1.3 && few.over_bound <= 1.3});
    const auto consistent = [](const PoseSummary& s) {
        return s.normalised_square > 0.7 && s.normalised_square < 1.4;
    };
    bench.rows.push_back(
        {"normalised squared error, 1e5 / 1e4 photons",
         "0.7-1.4",
         fmt::format("{:.2f} / {:.2f}", many.normalised_square, few.normalised_square),
         consistent(many) && consistent(few)});
}

// Random poses, and fits that start displaced from them.
struct PoseSearch {
    TrialSetup setup{};
    std::uint64_t first_pose = 0;
    double distance_m = 0.0;  // of the start
    double angle_deg = 0.0;
    double found_m = 0.01;  // what counts as found
    double found_deg = 5.0;
};

struct PosesFound {
    int found = 0;
    double seconds = 0.0;
};

PosesFound search_poses(const PoseSearch& search, int trials) {
    PosesFound result;
    for (int i = 0; i < trials; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const TrialPose truth = random_pose(search.first_pose + seed);
        const core::Capture counts =
            counted_capture(search.setup, expected_light(truth), 0.0, seed);
        const TrialPose start = displaced(truth, search.distance_m, search.angle_deg, seed);
        const double begin = core::cpu_seconds();
        const calib::FitResult fit = calib::fit_scene(trial_input(search.setup, counts, start), {});
        result.seconds += core::cpu_seconds() - begin;
        const TrialError error = trial_error(fit, truth);
        if (error.distance_m() < search.found_m && error.angle_deg() < search.found_deg) {
            ++result.found;
        }
    }
    return result;
}

void bench_basin(int trials, FitBench& bench) {
    const auto fraction = [&](double distance_m, double angle_deg) {
        const PoseSearch from{.distance_m = distance_m, .angle_deg = angle_deg};
        return 100.0 * search_poses(from, trials).found / trials;
    };
    const double both = fraction(0.2, 45.0);
    const double turned = fraction(0.0, 90.0);
    const double far = fraction(0.3, 0.0);
    bench.rows.push_back({"basin with the schedule: 20 cm + 45 deg / 90 deg / 30 cm [%]",
                          "100 / >= 95 / >= 90",
                          fmt::format("{:.0f} / {:.0f} / {:.0f}", both, turned, far),
                          both == 100.0 && turned >= 95.0 && far >= 90.0});
}

void bench_search(int trials, FitBench& bench) {
    PoseSearch anywhere{{}, 1000, 0.5, 170.0, 0.03, 15.0};
    anywhere.setup.photons = 3000.0;
    anywhere.setup.start = "search";
    const auto [found, seconds] = search_poses(anywhere, trials);
    bench.rows.push_back({"from scratch, 3,000 photons",
                          ">= 29 of 30, <= 1 s each",
                          fmt::format("{} of {}, {:.2f} s each", found, trials, seconds / trials),
                          30 * found >= 29 * trials && seconds / trials <= 1.0});
}

// Data by Monte Carlo path tracing of another mesh behind a small occluder, with detector noise.
void bench_monte_carlo(int trials, FitBench& bench) {
    TrialSetup setup;
    const TrialPose truth = standard_pose();
    renderer::SceneGeometry geometry;
    geometry.objects = {trial_rectangle(truth, 7, 5), trial_rectangle(truth, 1, 1)};
    renderer::Object& occluder = geometry.objects[1];
    occluder.name = "occluder";
    for (Vec3& vertex : occluder.mesh.vertices) {
        vertex = Vec3(0.12, -0.1, 0.45) + 0.25 * (vertex - truth.position_m);
    }
    occluder.world_from_node.translation() = Vec3(0.12, -0.1, 0.45);
    const core::WallScan scan = trial_scan();
    const renderer::Scene scene(geometry, scan, {});
    renderer::RenderSettings render_settings;
    render_settings.method = renderer::Estimator::Path;
    render_settings.samples = 8192;
    const core::Capture rendered =
        renderer::render(scene, scan, trial_axis(), render_settings, {}).capture;

    PoseSummary summary;
    double excess = 0.0;
    for (int i = 0; i < trials; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const core::Capture counts = counted_capture(setup, rendered, kTrialFwhm_ps, seed);
        calib::FitInput input = trial_input(setup, counts, displaced(truth, 0.03, 8.0, seed));
        input.geometry.objects.push_back(occluder);
        const calib::FitResult fit = calib::fit_scene(input, {});
        const TrialError error = trial_error(fit, truth);
        summary.add(error, trials);
        excess += (fit.deviance / fit.expected_deviance - 1.0) / trials;
    }
    summary.take_roots();
    bench.rows.push_back({"Monte Carlo data, other mesh, occluder, 1e5 photons",
                          "0.9 mm / 0.25 mm / 0.5 deg / 0.1 deg",
                          pose_text(summary) + fmt::format(", deviance {:+.1f} %", 100.0 * excess),
                          within(summary, 0.9, 0.25, 0.5, 0.1)});
}

void add_point(const std::string& choice, const TrialSetup& setup, int trials, FitBench& bench) {
    const PoseSummary s = summarise(setup, trials);
    bench.points.push_back({choice,
                            s.cpu_seconds,
                            s.iterations,
                            std::hypot(s.lateral_m, s.depth_m),
                            std::hypot(s.spin_deg, s.tilt_deg)});
}

void bench_speed(int trials, FitBench& bench) {
    const int fits = std::max(2, trials / 5);
    for (const double tolerance : {0.2, 0.05, 0.02, 0.005}) {
        TrialSetup setup;
        setup.element_tolerance = tolerance;
        add_point(fmt::format("elements to {}", tolerance), setup, fits, bench);
    }
    for (const auto& schedule : {std::vector<double>{0.0},
                                 std::vector<double>{0.04, 0.0},
                                 std::vector<double>{0.12, 0.04, 0.0}}) {
        TrialSetup setup;
        setup.blur_schedule_m = schedule;
        add_point(fmt::format("{} stages", schedule.size()), setup, fits, bench);
    }
    for (const auto kind : {calib::ResidualKind::Poisson, calib::ResidualKind::LeastSquares}) {
        TrialSetup setup;
        setup.residual = kind;
        add_point(std::string(core::enum_name(kind)), setup, fits, bench);
    }
}

struct BenchPart {
    std::string name;
    std::function<void(int, FitBench&)> run;
};

const std::vector<BenchPart>& bench_parts() {
    static const std::vector<BenchPart> kParts{
        {"forward", [](int, FitBench& bench) { bench_forward(bench); }},
        {"pose", bench_pose},
        {"basin", bench_basin},
        {"search", bench_search},
        {"monte_carlo", bench_monte_carlo},
        {"heights", bench_heights},
        {"direct_returns", bench_direct_returns},
        {"speed", bench_speed}};
    return kParts;
}

void declare_fit_bench(Command& command) {
    auto& settings = add_benchmark(command, measure_fit);
    std::vector<std::string> names;
    for (const BenchPart& part : bench_parts()) names.push_back(part.name);
    add_setting(command, "--trials", settings.trials, "Fits per row of the table", {1, 10000});
    command.add_option("--only", settings.parts, "Parts of the table")->check(one_of(names));
}

}  // namespace

BenchResult measure_fit(const FitBenchSettings& settings, const core::Progress& progress) {
    const core::ThreadLimit one(1);
    FitBench bench;
    int done = 0;
    for (const BenchPart& part : bench_parts()) {
        progress.update(fraction_of(done++, bench_parts().size()), part.name);
        const bool is_wanted =
            settings.parts.empty() || std::ranges::count(settings.parts, part.name) > 0;
        if (is_wanted) part.run(settings.trials, bench);
    }
    BenchResult result{core::write_value(bench)};
    if (bench.points.empty()) return result;
    nlos::Plot plot{"Error against time of fits", "CPU time [s]", "position error [m]", {}};
    for (const FitBenchPoint& point : bench.points) {
        plot.lines.push_back({point.choice, {point.cpu_seconds}, {point.position_rms_m}});
    }
    plot.lines.push_back(pareto_front(plot.lines));
    result.plots[""] = plot;
    return result;
}

extern const CommandRow kFitBench{"fit",
                                  "Fitting and calibration against their targets",
                                  "nlos bench fit -o out/bench --trials 1",
                                  declare_fit_bench};

}  // namespace apps
