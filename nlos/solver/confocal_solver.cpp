// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_solver.h"

#include "nlos/solver/albedo_density.h"
#include "nlos/solver/confocal_admm.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>

namespace nlos {
namespace {

// Of the choice between falloffs.
constexpr int kTrialIterations = 20;
constexpr double kFewCounts = 5.0;      // in the bins that hold most of the light
constexpr double kClearlyBetter = 0.8;  // fraction of the misfit
constexpr double kMuchBlur = 1.0;       // of depth: cosines left out look like surfaces

bool is_much_smeared(const MethodInput& input) {
    return depth_blur(input) > kMuchBlur;
}

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

/// What a few iterations leave unexplained of the data; null where they would not tell: of radiance
/// that is not smeared, and of few counts.
std::optional<double> trial_misfit(const MethodInput& input, const ReconstructSettings& settings) {
    const bool is_smeared = is_much_smeared(input);
    const ConfocalProblem data = make_confocal_problem(input, settings, is_smeared);
    const bool is_poisson = data.likelihood == Likelihood::Poisson;
    if (is_poisson ? mean_intensity(data) < kFewCounts : !is_smeared) return {};
    ConfocalAdmm solver(input, data, settings.solver);
    solver.run(input.progress.part(0.0, 0.0), kTrialIterations);
    return solver.misfit();
}

}  // namespace

Volume solve_confocal(const MethodInput& input, const ReconstructSettings& settings) {
    const bool is_facing = settings.falloff == Falloff::Facing;
    const ConfocalProblem data = make_confocal_problem(input, settings, is_facing);
    const Cone& cone = data.cone;
    ConfocalAdmm solver(input, data, settings.solver);
    const int iterations = solver.run(input.progress);
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
    const double voxel_depth_m =
        (input.z_range_m[1] - input.z_range_m[0]) / static_cast<double>(num_z);
    const double unit = data.unit / std::sqrt(kernel.squared_norm()) *
                        albedo_density_of_light(input) * voxel_depth_m;  // to_depth divides by it
    std::vector<float> units;  // per bin of v; cosines leave z^4 to the albedo
    for (std::size_t v = 0; v < cone.num_v(); ++v) {
        const double squared_depth = 0.5 * (cone.v_edges[v] + cone.v_edges[v + 1]);
        units.push_back(static_cast<float>(is_facing ? unit / std::pow(squared_depth, 2) : unit));
    }
    Volume volume{input.axes, std::vector<float>(cone.num_columns() * num_z), {}};
    core::parallel_for(cone.num_columns(), [&](std::size_t column) {
        std::vector<float> row(cone.num_v());
        for (std::size_t v = 0; v < cone.num_v(); ++v) {
            row[v] =
                units[v] *
                solver.albedo()[(column / cone.ny * cone.num_v() + v) * cone.ny + column % cone.ny];
        }
        to_depth.apply(row.data(), volume.values.data() + column * num_z);
    });
    input.progress.update(1.0, "to depth");
    return volume;
}

std::optional<FalloffChoice> choose_falloff(const MethodInput& input,
                                            const ReconstructSettings& settings,
                                            FalloffTrial trial) {
    if (!is_confocal_grid(input)) return std::nullopt;
    const bool is_smeared = is_much_smeared(input);
    if (trial == FalloffTrial::WhereNeeded && !is_smeared) return std::nullopt;
    FalloffChoice choice{Falloff::Diffuse,
                         "falloff: taken for diffuse, which only many counts tell"};
    std::vector<Falloff> others{Falloff::Retro};
    if (is_smeared) others.push_back(Falloff::Facing);
    auto misfit_of = [&, tried = settings](Falloff falloff) mutable {
        tried.falloff = falloff;
        return trial_misfit(input, tried);
    };
    const std::optional<double> diffuse = misfit_of(Falloff::Diffuse);
    if (!diffuse) return choice;
    double least = kClearlyBetter;
    std::string ratios;
    for (const Falloff falloff : others) {
        const double ratio = *misfit_of(falloff) / *diffuse;
        ratios += fmt::format(", {} {:.2f}", core::enum_name(falloff), ratio);
        if (!(ratio < least)) continue;  // nor where there is no light
        least = ratio;
        choice.falloff = falloff;
    }
    choice.reason =
        fmt::format("falloff: {}; misfit: diffuse 1{}", core::enum_name(choice.falloff), ratios);
    return choice;
}

double solve_confocal_bytes(const MethodInput& input, const ReconstructSettings& settings) {
    const Cone cone = make_cone(input, kVBinsPerRangeBin);
    const double volume = 4.0 * static_cast<double>(input.axes.num_voxels());
    const bool may_be_confined = settings.falloff == Falloff::Facing ||
                                 (settings.falloff == Falloff::Auto && is_much_smeared(input));
    if (!may_be_confined) return ConfocalAdmm::bytes(cone, false) + volume;
    const double num_bins = static_cast<double>(input.time_axis.num_bins);
    const double reach = static_cast<double>(input.measurement.response.weights.size());
    return ConfocalAdmm::bytes(cone, true) * (1.0 + reach / num_bins) + volume;
}

}  // namespace nlos
