// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_data.h"
#include "calib/fit/fit_result.h"
#include "calib/fit/stage_solver.h"
#include "renderer/core/progress.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace calib {

/// A start or another state of interest, by name.
using NamedState = std::pair<std::string, SceneState>;

/// What a fit works on, prepared once from its input: the model, the data and how they are
/// compared.
struct FitDriver {
    /// input, progress   must outlive this
    FitDriver(const FitInput& input, const core::Progress& progress);

    /// The objective for one blur, with a forward model whose elements are as small as that needs.
    struct Stage {
        std::unique_ptr<FitData> data;
        std::unique_ptr<ForwardModel> model;
        std::unique_ptr<FitObjective> objective;
        double blur_m = 0.0;
    };

    /// The stage of one blur for this model or one with other freedoms.
    ///
    /// refinement   how many times as many elements as the tolerance asks for
    Stage make_stage(const SceneModel& free_model, double blur_m, double refinement = 1.0) const;
    /// Whether blurred data are good for anything: light that the axis or a gate cuts off spoils
    /// the ends.
    bool is_usable(const Stage& stage) const;
    /// Throws core::Error when none of a start's light falls on the axis.
    void check_light(const Stage& stage, const SceneState& state) const;
    /// Poisson data with so few photons that the Fisher information says too little.
    bool has_few_photons() const;
    /// The starts to try.
    std::vector<NamedState> starts() const;
    /// A state with one body turned so that it nearly covers itself, as the data may confuse.
    std::vector<NamedState> turned(const SceneState& state) const;
    /// Solves one stage from `state`; repeats while the visibility changes.
    ///
    /// report   called with the number of iterations so far
    SolveSummary solve(Stage& stage,
                       SceneState& state,
                       int max_iterations,
                       const std::function<void(int)>& report) const;

    /// Takes what lies on other faces of the model out of its geometry, and says so.
    void count_places_once(const core::Progress& progress);
    void hold_one_albedo();

    const FitInput& input;
    renderer::SceneGeometry geometry;  ///< the input's, what lies at one place counted once
    FitSettings settings;              ///< without the freedoms that elimination takes out
    core::InstrumentResponse response;
    double response_sigma_m = 0.0;
    bool is_poisson = false;
    bool scale_is_unknown = false;
    Elimination elimination;
    std::string fixed_albedo;  ///< object whose albedo stays at its start; or {}
    FitData data;
    std::vector<double> offset_m;  ///< per pair
    double ambient_guess = 0.0;
    std::array<bool, 2> is_cut{};  ///< light at the axis' begin and end
    double tolerance = 0.02;       ///< of the last stage's elements
    std::unique_ptr<SceneModel> model;
    SolveSettings solve_settings;
};

}  // namespace calib
