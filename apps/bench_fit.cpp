// SPDX-License-Identifier: MIT
#include "apps/bench_fit.h"

#include "apps/fit_trials.h"
#include "calib/fit_objective.h"
#include "calib/jet_model.h"
#include "calib/state_vector.h"
#include "renderer/core/exact_arcs.h"
#include "renderer/core/parallel.h"
#include "renderer/core/process.h"
#include "renderer/render.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace apps {
namespace {

using core::Vec3;

constexpr double kMillimetre = 1e-3;
constexpr double kDegrees = 180.0 / core::kPi;

FitBenchRow row_of(const std::string& name,
                   const std::string& target,
                   const std::string& ours,
                   bool holds) {
    return {name, target, ours, holds};
}

// The rectangle's forward model, without fitting anything.
struct Bare {
    renderer::SceneGeometry geometry;
    core::Scan scan = trial_scan(16);
    std::unique_ptr<calib::SceneModel> model;
    std::unique_ptr<calib::ForwardModel> light;

    Bare(const TrialPose& pose, int cells_x, int cells_y, double tolerance, bool is_filtered) {
        geometry.objects = {trial_rectangle(pose, cells_x, cells_y)};
        calib::FitSettings settings;
        settings.free.objects = {{"target", true, true, false, true, false}};
        model = std::make_unique<calib::SceneModel>(geometry, settings, true);
        calib::ForwardSettings forward;
        forward.axis = trial_axis();
        forward.axis.num_bins = 288;
        forward.sigma_m = core::sigma_m_from_fwhm_ps(94.0);
        if (is_filtered) forward.measured = core::GaussianResponse{forward.sigma_m};
        forward.offset_m.assign(scan.num_pairs(), 0.0);
        forward.tolerance = tolerance;
        light =
            std::make_unique<calib::ForwardModel>(*model, scan, calib::WallMotion(scan), forward);
        light->refresh(start());
    }

    calib::SceneState start() const {
        calib::SceneState state = model->start();
        state.has_ambient = false;
        return state;
    }

    double milliseconds(core::Slopes slopes) const {
        constexpr int kRepeats = 7;
        std::vector<double> times;
        calib::PairModel pair;
        for (int i = 0; i < kRepeats; ++i) {
            const double begin = core::cpu_seconds();
            light->update(start(), slopes);
            for (std::size_t p = 0; p < scan.num_pairs(); ++p) light->evaluate(p, pair);
            times.push_back(1e3 * (core::cpu_seconds() - begin));
        }
        return *std::min_element(times.begin(), times.end());
    }
};

double norm(const std::vector<double>& values) {
    return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
}

// The rectangle's transient by exact arcs, filtered on fine bins.
std::vector<double> arcs_through_response(const renderer::Object& object,
                                          const Vec3& wall_point,
                                          const core::TimeAxis& axis,
                                          double sigma_m) {
    constexpr int kFine = 32;
    core::TimeAxis fine = axis;
    fine.bin_width_m /= kFine;
    fine.num_bins *= kFine;
    std::vector<double> sharp(static_cast<std::size_t>(fine.num_bins));
    for (const auto& [a, b, c] : object.mesh.triangles) {
        const auto& v = object.mesh.vertices;
        const auto part = core::confocal_arcs({v[a], v[b], v[c]}, wall_point, Vec3::UnitZ(), fine);
        for (std::size_t i = 0; i < sharp.size(); ++i) sharp[i] += 0.5 * part[i];  // albedo
    }
    std::vector<double> smooth(sharp.size());
    core::apply_filter<double, double>(
        core::sample_response(core::GaussianResponse{sigma_m}, fine.bin_width_m), sharp, smooth);
    std::vector<double> result(static_cast<std::size_t>(axis.num_bins));
    for (std::size_t i = 0; i < smooth.size(); ++i) result[i / kFine] += smooth[i];
    return result;
}

struct ForwardError {
    double shape = 0.0;
    double energy = 0.0;
};

// Meshes of cells whose diagonals are `pieces` long, against arcs, for a few wall points.
ForwardError forward_error(int cells_x, int cells_y) {
    constexpr double kNoFurtherCut = 1e9;
    const Bare bare(standard_pose(), cells_x, cells_y, kNoFurtherCut, false);
    bare.light->update(bare.start(), core::Slopes::Without);
    const renderer::Object whole = trial_rectangle(standard_pose(), 1, 1);
    ForwardError worst;
    const double sigma_m = bare.light->settings().sigma_m;
    for (const std::size_t pair : {0U, 37U, 120U, 200U, 255U}) {
        const auto exact = arcs_through_response(
            whole, bare.scan.sensing.positions[pair], bare.light->settings().axis, sigma_m);
        calib::PairModel model;
        bare.light->evaluate(pair, model);
        std::vector<double> difference = model.mean;
        for (std::size_t b = 0; b < exact.size(); ++b) difference[b] -= exact[b];
        worst.shape = std::max(worst.shape, norm(difference) / norm(exact));
        const double sum = std::accumulate(exact.begin(), exact.end(), 0.0);
        const double off = std::accumulate(difference.begin(), difference.end(), 0.0);
        worst.energy = std::max(worst.energy, std::abs(off) / sum);
    }
    return worst;
}

void bench_forward(FitBench& bench) {
    const ForwardError coarse = forward_error(5, 4);  // diagonals of 0.11 m, edges up to 0.08 m
    const ForwardError fine = forward_error(11, 9);
    bench.rows.push_back(row_of("forward against arcs, pieces <= 10 cm / <= 5 cm [relative L2]",
                                "1.5e-2 / 1.5e-3",
                                fmt::format("{:.1e} / {:.1e}", coarse.shape, fine.shape),
                                coarse.shape < 1.5e-2 && fine.shape < 1.5e-3));
    bench.rows.push_back(row_of("energy error, pieces <= 5 cm",
                                "1e-5",
                                fmt::format("{:.1e}", fine.energy),
                                fine.energy < 1e-5));
    const Bare bare(standard_pose(), 4, 3, 1e9, false);
    const Bare filtered(standard_pose(), 4, 3, 1e9, true);
    const double plain = bare.milliseconds(core::Slopes::Without);
    const double slopes = bare.milliseconds(core::Slopes::With);
    const double fir = filtered.milliseconds(core::Slopes::Without);
    bench.rows.push_back(
        row_of("forward / with Jacobian / filtered, 24 triangles x 256 points x 288 bins [ms]",
               "12 / 20 / 3",
               fmt::format("{:.1f} / {:.1f} / {:.1f}", plain, slopes, fir),
               plain < 12.0 && slopes < 20.0 && fir < 3.0));
}

void bench_slopes(FitBench& bench) {
    constexpr double kStep = 1e-6;
    constexpr std::size_t kPair = 77;
    const Bare bare(standard_pose(), 4, 3, 1e9, false);
    const auto columns = static_cast<std::size_t>(bare.model->num_columns());
    const calib::SceneState state = bare.start();
    bare.light->update(state, core::Slopes::With);
    calib::PairModel slopes;
    bare.light->evaluate(kPair, slopes);
    const auto jets = calib::jet_slopes(*bare.model,
                                        state,
                                        bare.light->pieces(),
                                        bare.scan,
                                        kPair,
                                        bare.light->settings().axis,
                                        bare.light->settings().sigma_m);
    double from_jets = 0.0;
    double from_differences = 0.0;
    for (std::size_t c = 0; c < 6; ++c) {
        std::vector<double> analytic;
        std::vector<double> jet_error;
        std::vector<double> difference_error;
        Eigen::VectorXd step = Eigen::VectorXd::Zero(bare.model->num_columns());
        step[static_cast<Eigen::Index>(c)] = kStep;
        calib::PairModel above;
        calib::PairModel below;
        bare.light->update(calib::moved_by(*bare.model, state, step), core::Slopes::Without);
        bare.light->evaluate(kPair, above);
        bare.light->update(calib::moved_by(*bare.model, state, -step), core::Slopes::Without);
        bare.light->evaluate(kPair, below);
        for (std::size_t b = 0; b < above.mean.size(); ++b) {
            analytic.push_back(slopes.slopes[b * columns + c]);
            jet_error.push_back(0.5 * jets[b * 6 + c] - analytic.back());  // albedo
            difference_error.push_back((above.mean[b] - below.mean[b]) / (2.0 * kStep) -
                                       analytic.back());
        }
        from_jets = std::max(from_jets, norm(jet_error) / norm(analytic));
        from_differences = std::max(from_differences, norm(difference_error) / norm(analytic));
    }
    bench.rows.push_back(row_of("Jacobian against Jets / differences [relative]",
                                "1e-9 / 1e-5",
                                fmt::format("{:.1e} / {:.1e}", from_jets, from_differences),
                                from_jets < 1e-9 && from_differences < 1e-5));
}

// Root mean squares over fits of one pose.
struct PoseSummary {
    double lateral_m = 0.0;
    double depth_m = 0.0;
    double spin_deg = 0.0;
    double tilt_deg = 0.0;
    double over_bound = 0.0;  ///< RMS error over the RMS stated one
    double normalised_square = 0.0;
    double cpu_seconds = 0.0;
    double iterations = 0.0;
    int count = 0;
};

PoseSummary summarise(const TrialSetup& setup, int trials) {
    PoseSummary summary;
    double error2 = 0.0;
    double bound2 = 0.0;
    const TrialPose truth = standard_pose();
    const core::Capture light = expected_light(setup, truth);
    for (int i = 0; i < trials; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const core::Capture counts = counted_capture(setup, light, 0.0, seed);
        const double begin = core::cpu_seconds();
        const calib::FitResult fit =
            calib::fit_scene(trial_input(setup, counts, displaced(truth, 0.03, 8.0, seed)), {});
        summary.cpu_seconds += core::cpu_seconds() - begin;
        summary.iterations += fit.iterations;
        const TrialError error = trial_error(fit, truth);
        summary.lateral_m += error.lateral_m * error.lateral_m;
        summary.depth_m += error.depth_m * error.depth_m;
        summary.spin_deg += error.spin_deg * error.spin_deg;
        summary.tilt_deg += error.tilt_deg * error.tilt_deg;
        const Vec3 sigma = fit.objects[0].position_sigma_m;
        const Vec3 turn_sigma = fit.objects[0].rotation_sigma_deg;
        error2 += error.position_m.squaredNorm() / sigma.squaredNorm() +
                  error.turn_deg.squaredNorm() / turn_sigma.squaredNorm();
        bound2 += 2.0;
        summary.normalised_square += (error.position_m.cwiseQuotient(sigma).squaredNorm() +
                                      error.turn_deg.cwiseQuotient(turn_sigma).squaredNorm()) /
                                     6.0;
        ++summary.count;
    }
    const double n = summary.count;
    for (double* square :
         {&summary.lateral_m, &summary.depth_m, &summary.spin_deg, &summary.tilt_deg}) {
        *square = std::sqrt(*square / n);
    }
    summary.over_bound = std::sqrt(error2 / bound2);
    summary.normalised_square /= n;
    summary.cpu_seconds /= n;
    summary.iterations /= n;
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
    bench.rows.push_back(row_of("pose RMS, 1e5 photons: lateral / depth / spin / tilt",
                                "0.9 mm / 0.25 mm / 0.5 deg / 0.1 deg",
                                pose_text(many),
                                within(many, 0.9, 0.25, 0.5, 0.1)));
    setup.photons = 1e4;
    const PoseSummary few = summarise(setup, trials);
    bench.rows.push_back(row_of("pose RMS, 1e4 photons",
                                "3 mm / 0.8 mm / 1.3 deg / 0.3 deg",
                                pose_text(few),
                                within(few, 3.0, 0.8, 1.3, 0.3)));
    bench.rows.push_back(row_of("RMS over Cramer-Rao bound, 1e5 / 1e4 photons",
                                "<= 1.3",
                                fmt::format("{:.2f} / {:.2f}", many.over_bound, few.over_bound),
                                many.over_bound <= 1.3 && few.over_bound <= 1.3));
    const auto consistent = [](const PoseSummary& s) {
        return s.normalised_square > 0.7 && s.normalised_square < 1.4;
    };
    bench.rows.push_back(
        row_of("normalised squared error, 1e5 / 1e4 photons",
               "0.7-1.4",
               fmt::format("{:.2f} / {:.2f}", many.normalised_square, few.normalised_square),
               consistent(many) && consistent(few)));
}

bool is_found(const TrialError& error) {
    constexpr double kFound_m = 0.01;
    constexpr double kFound_deg = 5.0;
    return error.distance_m() < kFound_m && error.angle_deg() < kFound_deg;
}

double found_share(const TrialSetup& setup, double distance_m, double angle_deg, int trials) {
    int found = 0;
    for (int i = 0; i < trials; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const TrialPose truth = random_pose(seed);
        const core::Capture counts =
            counted_capture(setup, expected_light(setup, truth), 0.0, seed);
        const TrialPose start = displaced(truth, distance_m, angle_deg, seed);
        const calib::FitResult fit = calib::fit_scene(trial_input(setup, counts, start), {});
        if (is_found(trial_error(fit, truth))) ++found;
    }
    return 100.0 * found / trials;
}

void bench_basin(int trials, FitBench& bench) {
    const TrialSetup setup;
    const double both = found_share(setup, 0.2, 45.0, trials);
    const double turned = found_share(setup, 0.0, 90.0, trials);
    const double far = found_share(setup, 0.3, 0.0, trials);
    bench.rows.push_back(row_of("basin with the schedule: 20 cm + 45 deg / 90 deg / 30 cm [%]",
                                "100 / >= 95 / >= 90",
                                fmt::format("{:.0f} / {:.0f} / {:.0f}", both, turned, far),
                                both == 100.0 && turned >= 95.0 && far >= 90.0));
}

void bench_search(int trials, FitBench& bench) {
    TrialSetup setup;
    setup.photons = 3000.0;
    setup.start = "search";
    int found = 0;
    double seconds = 0.0;
    for (int i = 0; i < trials; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const TrialPose truth = random_pose(1000 + seed);
        const core::Capture counts =
            counted_capture(setup, expected_light(setup, truth), 0.0, seed);
        const TrialPose anywhere = displaced(truth, 0.5, 170.0, seed);
        const double begin = core::cpu_seconds();
        const calib::FitResult fit = calib::fit_scene(trial_input(setup, counts, anywhere), {});
        seconds += core::cpu_seconds() - begin;
        const TrialError error = trial_error(fit, truth);
        if (error.distance_m() < 0.03 && error.angle_deg() < 15.0) ++found;
    }
    bench.rows.push_back(
        row_of("from scratch, 3,000 photons",
               ">= 29 of 30, <= 1 s each",
               fmt::format("{} of {}, {:.2f} s each", found, trials, seconds / trials),
               30 * found >= 29 * trials && seconds / trials <= 1.0));
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
    const core::Scan scan = trial_scan(setup.scan_points);
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
        const core::Capture counts = counted_capture(setup, rendered, setup.fwhm_ps, seed);
        calib::FitInput input = trial_input(setup, counts, displaced(truth, 0.03, 8.0, seed));
        input.geometry.objects.push_back(occluder);
        const calib::FitResult fit = calib::fit_scene(input, {});
        const TrialError error = trial_error(fit, truth);
        summary.lateral_m += error.lateral_m * error.lateral_m / trials;
        summary.depth_m += error.depth_m * error.depth_m / trials;
        summary.spin_deg += error.spin_deg * error.spin_deg / trials;
        summary.tilt_deg += error.tilt_deg * error.tilt_deg / trials;
        excess += (fit.deviance / fit.expected_deviance - 1.0) / trials;
    }
    for (double* square :
         {&summary.lateral_m, &summary.depth_m, &summary.spin_deg, &summary.tilt_deg}) {
        *square = std::sqrt(*square);
    }
    bench.rows.push_back(
        row_of("Monte Carlo data, other mesh, occluder, 1e5 photons",
               "0.9 mm / 0.25 mm / 0.5 deg / 0.1 deg",
               pose_text(summary) + fmt::format(", deviance {:+.1f} %", 100.0 * excess),
               within(summary, 0.9, 0.25, 0.5, 0.1)));
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
        setup.piece_tolerance = tolerance;
        add_point(fmt::format("pieces to {}", tolerance), setup, fits, bench);
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
        {"slopes", [](int, FitBench& bench) { bench_slopes(bench); }},
        {"pose", bench_pose},
        {"basin", bench_basin},
        {"search", bench_search},
        {"monte_carlo", bench_monte_carlo},
        {"speed", bench_speed}};
    return kParts;
}

}  // namespace

const std::vector<std::string>& fit_bench_parts() {
    static const std::vector<std::string> kNames = [] {
        std::vector<std::string> names;
        for (const BenchPart& part : bench_parts()) names.push_back(part.name);
        return names;
    }();
    return kNames;
}

FitBench bench_fit(int trials,
                   const std::vector<std::string>& parts,
                   const core::Progress& progress) {
    const core::ThreadLimit one(1);
    FitBench bench;
    double done = 0.0;
    for (const BenchPart& part : bench_parts()) {
        progress.update(done++ / static_cast<double>(bench_parts().size()), part.name);
        if (progress.should_stop()) throw core::Failure("bench fit", "interrupted");
        const bool is_wanted =
            parts.empty() || std::find(parts.begin(), parts.end(), part.name) != parts.end();
        if (is_wanted) part.run(trials, bench);
    }
    return bench;
}

}  // namespace apps
