// SPDX-License-Identifier: MIT
#include "apps/bench/fit/fit.h"
#include "apps/bench/fit/fit_trials.h"
#include "calib/fit/fit_objective.h"
#include "calib/forward/autodiff_reference.h"
#include "calib/model/state_vector.h"
#include "renderer/core/process.h"
#include "renderer/triangle/exact_arcs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace apps {
namespace {

using core::Vec3;

// The rectangle's forward model, without fitting anything.
struct Bare {
    renderer::SceneGeometry geometry;
    core::WallScan scan = trial_scan();
    std::unique_ptr<calib::SceneModel> model;
    std::unique_ptr<calib::ForwardModel> light;

    Bare(int cells_x, int cells_y, bool is_filtered = false, double offset_m = 0.0) {
        constexpr double kNoFurtherCut = 1e9;
        geometry.objects = {trial_rectangle(standard_pose(), cells_x, cells_y)};
        calib::FitSettings settings;
        settings.free.objects = {{"target", true, true, false, true, false}};
        model = std::make_unique<calib::SceneModel>(geometry, settings, true);
        calib::ForwardSettings forward;
        forward.axis = trial_axis();
        forward.axis.num_bins = 288;
        forward.sigma_m = core::sigma_m_from_fwhm_ps(kTrialFwhm_ps);
        if (is_filtered) forward.measured = core::GaussianResponse{forward.sigma_m};
        forward.offset_m.assign(scan.num_pairs(), offset_m);
        forward.tolerance = kNoFurtherCut;
        light =
            std::make_unique<calib::ForwardModel>(*model, scan, calib::WallMotion(scan), forward);
        light->refresh(start());
    }

    calib::SceneState start() const {
        calib::SceneState state = model->start();
        state.has_ambient = false;
        return state;
    }

    double milliseconds(renderer::Gradients gradients) const {
        constexpr int kRepeats = 7;
        std::vector<double> times;
        calib::PairModel pair;
        for (int i = 0; i < kRepeats; ++i) {
            const double begin = core::cpu_seconds();
            light->update(start(), gradients);
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
        const auto part =
            renderer::confocal_arcs({v[a], v[b], v[c]}, wall_point, Vec3::UnitZ(), fine);
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

// Meshes of cells whose diagonals are `elements` long, against arcs, for a few wall points.
ForwardError forward_error(int cells_x, int cells_y) {
    const Bare bare(cells_x, cells_y);
    bare.light->update(bare.start(), renderer::Gradients::Without);
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

// Largest relative change of a histogram's sum when all its light moves by parts of a bin.
double change_under_shifts() {
    constexpr int kShifts = 7;
    double worst = 0.0;
    std::vector<double> reference;
    for (int i = 0; i <= kShifts; ++i) {
        const double shift_m = trial_axis().bin_width_m * i / (kShifts + 1);
        const Bare bare(11, 9, false, shift_m);
        bare.light->update(bare.start(), renderer::Gradients::Without);
        calib::PairModel model;
        for (std::size_t pair = 0; pair < bare.scan.num_pairs(); ++pair) {
            bare.light->evaluate(pair, model);
            const double sum = std::accumulate(model.mean.begin(), model.mean.end(), 0.0);
            if (i == 0) reference.push_back(sum);
            worst = std::max(worst, std::abs(sum / reference[pair] - 1.0));
        }
    }
    return worst;
}

}  // namespace

void bench_forward(FitBench& bench) {
    const ForwardError coarse = forward_error(5, 4);  // diagonals of 0.11 m, edges up to 0.08 m
    const ForwardError fine = forward_error(11, 9);
    bench.rows.push_back({"forward against arcs, elements <= 10 cm / <= 5 cm [relative L2]",
                          "1.5e-2 / 1.5e-3",
                          fmt::format("{:.1e} / {:.1e}", coarse.shape, fine.shape),
                          coarse.shape < 1.5e-2 && fine.shape < 1.5e-3});
    const double change = change_under_shifts();
    bench.rows.push_back({"energy error / change of energy under sub-bin shifts, elements <= 5 cm",
                          "1e-5 / 1e-5",
                          fmt::format("{:.1e} / {:.1e}", fine.energy, change),
                          fine.energy < 1e-5 && change < 1e-5});
    const Bare bare(4, 3);
    const Bare filtered(4, 3, true);
    const double plain = bare.milliseconds(renderer::Gradients::Without);
    const double gradients = bare.milliseconds(renderer::Gradients::With);
    const double fir = filtered.milliseconds(renderer::Gradients::Without);
    bench.rows.push_back(
        {"forward / with Jacobian / filtered, 24 triangles x 256 points x 288 bins [ms]",
         "12 / 20 / 3",
         fmt::format("{:.1f} / {:.1f} / {:.1f}", plain, gradients, fir),
         plain < 12.0 && gradients < 20.0 && fir < 3.0});
}

void bench_gradients(FitBench& bench) {
    constexpr double kStep = 1e-6;
    constexpr std::size_t kPair = 77;
    const Bare bare(4, 3);
    const auto columns = static_cast<std::size_t>(bare.model->num_columns());
    const calib::SceneState state = bare.start();
    bare.light->update(state, renderer::Gradients::With);
    calib::PairModel gradients;
    bare.light->evaluate(kPair, gradients);
    const auto jets = calib::autodiff_jacobian(*bare.model, state, *bare.light, kPair);
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
        bare.light->update(calib::moved_by(*bare.model, state, step), renderer::Gradients::Without);
        bare.light->evaluate(kPair, above);
        bare.light->update(calib::moved_by(*bare.model, state, -step),
                           renderer::Gradients::Without);
        bare.light->evaluate(kPair, below);
        for (std::size_t b = 0; b < above.mean.size(); ++b) {
            analytic.push_back(gradients.gradients[b * columns + c]);
            jet_error.push_back(0.5 * jets[b * 6 + c] - analytic.back());  // albedo
            difference_error.push_back((above.mean[b] - below.mean[b]) / (2.0 * kStep) -
                                       analytic.back());
        }
        from_jets = std::max(from_jets, norm(jet_error) / norm(analytic));
        from_differences = std::max(from_differences, norm(difference_error) / norm(analytic));
    }
    bench.rows.push_back({"Jacobian against Jets / differences [relative]",
                          "1e-9 / 1e-5",
                          fmt::format("{:.1e} / {:.1e}", from_jets, from_differences),
                          from_jets < 1e-9 && from_differences < 1e-5});
}

}  // namespace apps
