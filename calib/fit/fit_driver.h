// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_data.h"
#include "calib/fit/fit_result.h"
#include "calib/fit/stage_solver.h"
#include "renderer/core/progress.h"

#include <memory>
#include <string>
#include <vector>

namespace calib {

/// A fit under way: the model, the prepared data and the stages from coarse to sharp.
class FitDriver {
 public:
    FitDriver(const FitInput& input, const core::Progress& progress);

    /// Objective of one blur; the forward model inside is cut for it.
    struct Stage {
        std::unique_ptr<FitData> data;
        std::unique_ptr<ForwardModel> model;
        std::unique_ptr<FitObjective> objective;
        double blur_m = 0.0;
    };

    /// Poisson data with so few photons that the Fisher information says too little.
    bool has_few_photons() const;
    /// The best state turned so that its bodies nearly cover themselves, as the data may confuse.
    std::vector<std::pair<std::string, SceneState>> turned(const SceneState& state) const;
    bool is_poisson() const { return is_poisson_; }
    const SceneModel& model() const { return *model_; }
    const FitData& data() const { return data_; }
    const SolveSettings& solve_settings() const { return solve_; }
    const FitSettings& settings() const { return settings_; }
    const renderer::SceneGeometry& geometry() const { return input_.geometry; }
    bool scale_is_unknown() const { return scale_is_unknown_; }
    bool has_fixed_albedo() const { return !fixed_albedo_.empty(); }
    const std::string& fixed_albedo() const { return fixed_albedo_; }

    Stage make_stage(double blur_m) const { return make_stage(*model_, blur_m, tolerance_); }
    /// The last one for a model that has other freedoms.
    Stage make_stage(const SceneModel& model) const { return make_stage(model, 0.0, tolerance_); }
    /// The last one with this many times as many elements.
    Stage make_fine_stage(double factor) const {
        return make_stage(*model_, 0.0, tolerance_ / factor);
    }
    /// Whether blurred data are good for anything: light that the axis cuts off spoils its ends.
    bool is_usable(const Stage& stage) const;
    /// Throws core::Error when none of a start's light falls on the axis.
    void check_light(const Stage& stage, const SceneState& state) const;
    /// The starts to try, by name.
    std::vector<std::pair<std::string, SceneState>> starts() const;
    /// Solves one stage from `state`; repeats while what is seen changes.
    SolveSummary solve(Stage& stage, SceneState& state, int max_iterations) const;

 private:
    Stage make_stage(const SceneModel& model, double blur_m, double tolerance) const;
    double light_of(const Stage& stage, const SceneState& state) const;
    void match_brightness(Stage& stage, SceneState& state) const;
    std::vector<std::pair<std::string, SceneState>> searched(const core::Vec3& center) const;
    void place_points(SceneState& state) const;
    void check_start(const SceneState& state) const;

    const FitInput& input_;
    const core::Progress& progress_;
    FitSettings settings_;  ///< with what elimination takes out
    core::InstrumentResponse response_;
    bool is_poisson_ = false;
    bool scale_is_unknown_ = false;
    Elimination elimination_;
    std::string fixed_albedo_;
    std::unique_ptr<SceneModel> model_;
    FitData data_;
    std::vector<double> offset_m_;
    double response_sigma_m_ = 0.0;
    double ambient_guess_ = 0.0;
    std::array<bool, 2> is_cut_{};  ///< data at the axis' begin and end
    double tolerance_ = 0.02;       ///< of the last stage's elements
    SolveSettings solve_;
};

}  // namespace calib
