// SPDX-License-Identifier: MIT
#include "calib/fit/fit_driver.h"

#include "calib/fit/initial_guesses.h"
#include "calib/model/pose_ambiguity.h"
#include "renderer/core/error.h"
#include "renderer/core/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace calib {
namespace {

using core::Vec3;

// Bins are merged while they stay this narrow against the response with its blur.
constexpr double kBinPerSigma = 0.7;
constexpr double kBlurReach = 2.0;  // standard deviations of blur that cut light spoils
constexpr int kMinBins = 8;         // of a stage that is worth solving
// Solves alternate with looking anew at what is seen until the cost, half the deviance, settles.
constexpr int kMaxVisibilityRounds = 3;
constexpr int kBlurredVisibilityRounds = 2;
constexpr double kSettledCost = 0.02;
constexpr std::size_t kPairsOfBlurredStages = 400;

// Errors of elements may be this large while a blurred stage leads the way.
constexpr double kBlurredTolerance = 0.1;

// Noise of all data together is 1/sqrt(counts) of them; the rule for elements bounds the worst
// histogram, several times above what matters for the whole.
double tolerance_for(double counts) {
    return std::clamp(8.0 / std::sqrt(counts), 0.005, 0.1);
}
constexpr double kToleranceWithoutNoise = 0.02;
// Blurred data leave many heights open: kept smooth, they get there in a fifth of the time.
constexpr double kBlurredSmoothness = 100.0;

Vec3 surface_center(const ModelBody& body) {
    Vec3 sum = Vec3::Zero();
    for (const ModelVertex& v : body.vertices) sum += v.position_m;
    return sum / static_cast<double>(body.vertices.size());
}

bool is_free(const FreeObject& object) {
    return object.translation || object.rotation;
}

}  // namespace

FitDriver::FitDriver(const FitInput& input, const core::Progress& progress)
    : input_(input), progress_(progress), settings_(input.settings) {
    validate(settings_, "model: ");
    response_ = core::make_response(settings_.response, "model: response");
    response_sigma_m_ = std::sqrt(core::moments(response_).variance_m2);
    const bool is_gaussian = std::holds_alternative<core::GaussianResponse>(response_);
    if (settings_.free.response_fwhm && !(is_gaussian && response_sigma_m_ > 0.0)) {
        throw core::Error("model: free.response_fwhm",
                          "found a response without a width to scale",
                          "needs response.jitter_fwhm_ps alone");
    }
    is_poisson_ = settings_.residual == ResidualKind::Poisson ||
                  (settings_.residual == ResidualKind::Auto && is_integer_valued(input.capture));
    data_ = crop(input.capture, settings_.window_m);
    const double total = std::accumulate(data_.values.begin(), data_.values.end(), 0.0);
    if (!(total > 0.0)) throw core::Error("capture", "found no light", "must hold some to fit");
    data_.min_mean = 1e-6 * total / static_cast<double>(data_.values.size());
    offset_m_ = input.offset_m;
    for (std::size_t pair = 0; offset_m_.size() < input.capture.scan.num_pairs(); ++pair) {
        offset_m_.push_back(input.capture.scan.device_legs_m(pair));
    }

    // Data of unknown scale leave one albedo open: the first free one stays at its start.
    scale_is_unknown_ = input.capture.unit == core::TransientUnit::Counts &&
                        !input.capture.counts_per_radiance && !input.geometry.objects.empty() &&
                        !settings_.free.objects.empty();
    if (scale_is_unknown_) {
        for (FreeObject& object : settings_.free.objects) {
            if (!object.albedo) continue;
            object.albedo = false;
            fixed_albedo_ = object.name;
            break;
        }
    }
    if (!is_poisson_) {
        elimination_ = {scale_is_unknown_, settings_.free.ambient};
        settings_.free.ambient = false;
    }
    model_ =
        std::make_unique<SceneModel>(input.geometry, settings_, scale_is_unknown_ && is_poisson_);
    ambient_guess_ = quietest_level(data_);
    is_cut_ = light_is_cut(data_, ambient_guess_);
    tolerance_ = settings_.element_tolerance.value_or(is_poisson_ ? tolerance_for(total)
                                                                  : kToleranceWithoutNoise);

    solve_.loss = settings_.loss;
    solve_.loss_scale = settings_.loss_scale;
    solve_.laplacian_weight = settings_.laplacian_weight;
    solve_.time_zero_sigma_m = settings_.free.time_zero_sigma_m;
    solve_.lowest_log_ambient = std::log(data_.min_mean);
    solve_.stop_requested = progress.stop_requested;
}

FitDriver::Stage FitDriver::make_stage(const SceneModel& model,
                                       double blur_m,
                                       double tolerance) const {
    Stage stage;
    stage.blur_m = blur_m;
    ForwardSettings forward;
    const double sigma_m = std::hypot(response_sigma_m_, blur_m);
    // The edge of a response with a tail is as sharp as its core.
    const double core_m = core::sigma_m_from_fwhm_ps(settings_.response.jitter_fwhm_ps);
    const double sharpest_m = core_m > 0.0 ? std::hypot(core_m, blur_m) : sigma_m;
    const double width = sigma_m > 0.0 ? sharpest_m : data_.axis.bin_width_m;
    const int merged = std::max(1, static_cast<int>(kBinPerSigma * width / data_.axis.bin_width_m));
    // Blurred stages only lead the way: they need few pairs.
    const std::size_t most =
        settings_.max_pairs ? static_cast<std::size_t>(*settings_.max_pairs) : offset_m_.size();
    const PairSubset subset =
        thin(input_.capture.scan, blur_m > 0.0 ? std::min(most, kPairsOfBlurredStages) : most);
    const FitData coarse = coarsen(select(data_, subset.pairs), blur_m, merged);
    const int spoilt = static_cast<int>(std::ceil(kBlurReach * blur_m / coarse.axis.bin_width_m));
    stage.data =
        std::make_unique<FitData>(trim(coarse, is_cut_[0] ? spoilt : 0, is_cut_[1] ? spoilt : 0));
    stage.data->min_mean = data_.min_mean * merged;
    forward.axis = stage.data->axis;
    forward.bins_per_ambient = merged;
    forward.sigma_m = sigma_m;
    forward.response_share =
        sigma_m > 0.0 ? response_sigma_m_ * response_sigma_m_ / (sigma_m * sigma_m) : 1.0;
    // Under a wide blur the shape of the response does not matter, only its width and mean.
    const bool is_gaussian = std::holds_alternative<core::GaussianResponse>(response_);
    if (!is_gaussian && blur_m == 0.0) forward.measured = response_;
    const double mean_delay = forward.measured ? 0.0 : core::moments(response_).mean_m;
    for (const std::size_t pair : subset.pairs) {
        forward.offset_m.push_back(offset_m_[pair] + mean_delay);
    }
    const WallMotion wall(input_.capture.scan);
    const double albedo = input_.scene.relay_wall.albedo;
    forward.radiance_factor = albedo * albedo / (core::kPi * core::kPi * core::kPi) *
                              input_.capture.counts_per_radiance.value_or(1.0);
    forward.spot_m2 = input_.scene.render.laser_spot_m2;
    forward.tolerance = blur_m > 0.0 ? std::max(tolerance, kBlurredTolerance) : tolerance;
    stage.model = std::make_unique<ForwardModel>(model, subset.scan, wall, std::move(forward));
    stage.objective = std::make_unique<FitObjective>(
        *stage.model, *stage.data, is_poisson_, elimination_, model.num_columns());
    return stage;
}

bool FitDriver::is_usable(const Stage& stage) const {
    return stage.data->axis.num_bins >= std::min(kMinBins, data_.axis.num_bins);
}

void FitDriver::check_light(const Stage& stage, const SceneState& state) const {
    stage.model->refresh(state);
    if (light_of(stage, state) > 0.0) return;
    throw core::Error("model: start",
                      "found none of its light on the time axis",
                      fmt::format("must have path lengths from {:.3f} to {:.3f} m, or use start: "
                                  "search",
                                  data_.axis.opl_start_m,
                                  data_.axis.opl_end_m()));
}

void FitDriver::check_start(const SceneState& state) const {
    const core::Scan& scan = input_.capture.scan;
    for (std::size_t b = 0; b < model_->bodies().size(); ++b) {
        if (!is_free(model_->bodies()[b].free)) continue;
        bool is_in_front = false;
        for (std::size_t v = 0; v < model_->bodies()[b].vertices.size() && !is_in_front; ++v) {
            const Vec3 p = model_->vertex_world(state.bodies[b], b, v);
            for (std::size_t i = 0; i < scan.sensing.size() && !is_in_front; ++i) {
                is_in_front = scan.sensing.normals[i].dot(p - scan.sensing.positions[i]) > 0.0;
            }
        }
        if (is_in_front) continue;
        throw core::Error("model: start of " + model_->bodies()[b].name,
                          "found it behind the relay wall",
                          "must be on the hidden side, or use start: search");
    }
}

std::vector<std::pair<std::string, SceneState>> FitDriver::searched(const Vec3& center) const {
    std::size_t target = model_->bodies().size();
    for (std::size_t b = 0; b < model_->bodies().size(); ++b) {
        if (!is_free(model_->bodies()[b].free)) continue;
        if (target < model_->bodies().size()) {
            throw core::Error("model: start",
                              "found several objects with a free pose",
                              "search places one; give the others' poses");
        }
        target = b;
    }
    std::vector<std::pair<std::string, SceneState>> result;
    SceneState state = model_->start();
    if (target == model_->bodies().size()) return {{"search", state}};
    const ModelBody& body = model_->bodies()[target];
    const int count = body.free.rotation ? settings_.search_rotations : 1;
    for (const Eigen::Quaterniond& rotation : spread_rotations(count)) {
        BodyState& pose = state.bodies[target];
        pose.rotation = rotation;
        if (body.free.translation) pose.position_m = center - rotation * surface_center(body);
        result.emplace_back(fmt::format("rotation {}", result.size()), state);
    }
    return result;
}

void FitDriver::place_points(SceneState& state) const {
    if (state.points.empty()) return;
    std::vector<Vec3> positions;
    if (!input_.start_points.empty()) {
        positions = cluster_centers(input_.start_points, state.points.size());
    } else {
        const double blur = settings_.blur_schedule_m.size() > 1
                                ? *(settings_.blur_schedule_m.end() - 2)
                                : response_sigma_m_;
        const double width = std::hypot(response_sigma_m_, blur);
        const int merged =
            std::max(1, static_cast<int>(kBinPerSigma * width / data_.axis.bin_width_m));
        const FitData coarse = coarsen(data_, blur, merged);
        positions = brightest_points(input_.capture.scan,
                                     coarse,
                                     ambient_guess_ * merged,
                                     width,
                                     offset_m_,
                                     static_cast<int>(state.points.size()));
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        state.points[i].position_m = positions[i];
        state.points[i].log_albedo = std::log(1e-3);
    }
}

std::vector<std::pair<std::string, SceneState>> FitDriver::starts() const {
    std::vector<std::pair<std::string, SceneState>> result;
    if (settings_.start == "given") {
        result = {{"given", model_->start()}};
        check_start(result.front().second);
    } else if (settings_.start == "search") {
        result = searched(trilaterate(input_.capture.scan, data_, ambient_guess_, offset_m_));
    } else {
        if (input_.start_points.empty()) {
            throw core::Error(settings_.start, "holds no surface point", "cannot be started from");
        }
        Vec3 sum = Vec3::Zero();
        for (const Vec3& p : input_.start_points) sum += p;
        result = searched(sum / static_cast<double>(input_.start_points.size()));
    }
    for (auto& [name, state] : result) {
        place_points(state);
        state.log_ambient = std::log(std::max(ambient_guess_, 10.0 * data_.min_mean));
    }
    return result;
}

bool FitDriver::has_few_photons() const {
    constexpr double kManyPerParameter = 50.0;
    const double total = std::accumulate(data_.values.begin(), data_.values.end(), 0.0);
    const double ambient = ambient_guess_ * static_cast<double>(data_.values.size());
    return is_poisson_ && total - ambient < kManyPerParameter * model_->num_columns();
}

std::vector<std::pair<std::string, SceneState>> FitDriver::turned(const SceneState& state) const {
    constexpr double kNearlySame = 0.2;
    constexpr double kNearlySameInNoise = 0.6;
    return symmetric_poses(*model_, state, has_few_photons() ? kNearlySameInNoise : kNearlySame);
}

// All of a state's light in the data's bins, without ambient light.
double FitDriver::light_of(const Stage& stage, const SceneState& state) const {
    SceneState dark = state;
    dark.has_ambient = false;
    stage.model->update(dark, renderer::Gradients::Without);
    std::vector<double> sums(stage.model->scan().num_pairs());
    core::parallel_for(sums.size(), [&](std::size_t pair) {
        PairModel model;
        stage.model->evaluate(pair, model);
        sums[pair] = std::accumulate(model.mean.begin(), model.mean.end(), 0.0);
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

// The one factor that all light shares is set by the sums of data and model.
void FitDriver::match_brightness(Stage& stage, SceneState& state) const {
    const double light = light_of(stage, state);
    const double total = std::accumulate(stage.data->values.begin(), stage.data->values.end(), 0.0);
    const double ambient =
        std::min(0.9 * total,
                 ambient_guess_ * static_cast<double>(stage.data->values.size()) *
                     stage.model->settings().bins_per_ambient);
    if (!(light > 0.0)) return;
    const double change = std::log((total - ambient) / light);
    if (!std::isfinite(change)) return;
    if (model_->find(ParameterKind::Scale) != nullptr) state.log_scale += change;
    if (scale_is_unknown_) return;
    for (std::size_t b = 0; b < state.bodies.size(); ++b) {
        if (model_->bodies()[b].free.albedo) state.bodies[b].log_albedo += change;
    }
    for (PointState& point : state.points) point.log_albedo += change;
}

SolveSummary FitDriver::solve(Stage& stage, SceneState& state, int max_iterations) const {
    SolveSettings solve_settings = solve_;
    solve_settings.max_iterations = max_iterations;
    if (stage.blur_m > 0.0) solve_settings.laplacian_weight *= kBlurredSmoothness;
    const int rounds = stage.blur_m > 0.0 ? kBlurredVisibilityRounds : kMaxVisibilityRounds;
    SolveSummary total;
    for (int round = 0; round < rounds; ++round) {
        stage.model->refresh(state);
        if (round > 0 && !stage.model->visibility_changed()) break;
        if (round == 0) match_brightness(stage, state);
        const SolveSummary summary = solve_stage(*model_, *stage.objective, solve_settings, state);
        const bool is_settled = std::abs(total.cost - summary.cost) < kSettledCost;
        total.cost = summary.cost;
        total.converged = summary.converged;
        total.message = summary.message;
        total.iterations += summary.iterations;
        if (round > 0 && is_settled) break;
    }
    return total;
}

}  // namespace calib
