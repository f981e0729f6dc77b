// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_solver.h"

#include "nlos/solver/confocal_admm.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace nlos {
namespace {

// Of the choice between falloffs.
constexpr int kTrialIterations = 20;
constexpr double kFewCounts = 5.0;      // in the bins that hold most of the light
constexpr double kClearlyBetter = 0.8;  // share of the misfit

/// The mean of counts, weighted by themselves.
double mean_intensity(const ConfocalProblem& data) {
    double sum = 0.0;
    double squares = 0.0;
    for (const float value : data.values) {
        sum += static_cast<double>(value);
        squares += static_cast<double>(value) * static_cast<double>(value);
    }
    return sum > 0.0 ? squares / sum : 0.0;
}

double num_observed_bins(const ConfocalProblem& data) {
    double count = 0.0;
    for (const core::BinRange& range : data.observed) count += range.size();
    return std::max(1.0, count);
}

}  // namespace

Volume solve_confocal(const MethodInput& input,
                      const ReconstructSettings& settings,
                      std::size_t /*num_slabs*/) {
    const ConfocalProblem data = make_confocal_problem(input, settings);
    const Cone& cone = data.cone;
    ConfocalAdmm solver(input, data, settings.solver);
    const int iterations = solver.run(input.progress, settings.solver.max_iterations);
    if (input.progress.announce) {
        input.progress.announce(
            fmt::format("solver: weight {:.2g} of total variation, {} iterations, {:.3g} of "
                        "deviance per observed bin",
                        solver.weight(),
                        iterations,
                        solver.misfit() / num_observed_bins(data)));
    }
    // A surface fills few bins: its depth is where they lie together.
    const ConservativeResampling to_depth = squared_range_to_depth(input, cone, BinSpread::Linear);
    const std::size_t num_z = input.axes.z_m.size();
    const ConeKernel kernel(cone, *input.wall.grid);
    const auto unit = static_cast<float>(data.unit / std::sqrt(kernel.squared_norm()));
    Volume volume{input.axes, std::vector<float>(cone.num_columns() * num_z), {}};
    core::parallel_for(cone.num_columns(), [&](std::size_t column) {
        std::vector<float> row(cone.num_v());
        for (std::size_t v = 0; v < cone.num_v(); ++v) {
            row[v] =
                unit *
                solver.albedo()[(column / cone.ny * cone.num_v() + v) * cone.ny + column % cone.ny];
        }
        to_depth.apply(row.data(), volume.values.data() + column * num_z);
    });
    input.progress.update(1.0, "to depth");
    return volume;
}

FalloffChoice choose_falloff(const MethodInput& input, ReconstructSettings settings) {
    const core::Progress silent = input.progress.part(0.0, 0.0);
    std::array<double, 2> misfits{};
    for (const Falloff falloff : {Falloff::Diffuse, Falloff::Retro}) {
        settings.falloff = falloff;
        const ConfocalProblem data = make_confocal_problem(input, settings);
        if (data.likelihood != Likelihood::Poisson || mean_intensity(data) < kFewCounts) {
            return {Falloff::Diffuse, "falloff: taken for diffuse, which only many counts tell"};
        }
        ConfocalAdmm solver(input, data, settings.solver);
        solver.run(silent, kTrialIterations);
        misfits[static_cast<std::size_t>(falloff)] = solver.misfit();
    }
    const double ratio = misfits[1] / misfits[0];
    const bool is_retro = ratio < kClearlyBetter;
    return {is_retro ? Falloff::Retro : Falloff::Diffuse,
            fmt::format("falloff: {}, misfit of retroreflective over diffuse light {:.2f}",
                        is_retro ? "retroreflective" : "diffuse",
                        ratio)};
}

double solve_confocal_bytes(const MethodInput& input,
                            const ReconstructSettings& /*settings*/,
                            std::size_t /*num_slabs*/) {
    const Cone cone = make_cone(input, kVBinsPerRangeBin);
    return ConfocalAdmm::bytes(cone) + 4.0 * static_cast<double>(input.axes.num_voxels());
}

}  // namespace nlos
