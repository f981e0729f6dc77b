// SPDX-License-Identifier: MIT
#include "calib/fit/fit_driver.h"

#include "calib/fit/initial_guesses.h"
#include "calib/model/scene_model.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/error.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace calib {
namespace {

using core::Vec3;

// Bins are merged while they stay this narrow against the response with its blur.
constexpr double kBinPerSigma = 0.7;
constexpr int kMinBins = 8;  // of a stage that is worth solving
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

bool has_free_pose(const SceneModel& model, std::size_t body) {
    return model.is_free(Owner::Body, body, Effect::Translates) ||
           model.is_free(Owner::Body, body, Effect::Rotates);
}

void check_start(const FitDriver& driver, const SceneState& state) {
    const core::WallScan& scan = driver.input.capture.scan.wall();
    for (std::size_t b = 0; b < driver.model->bodies().size(); ++b) {
        if (!has_free_pose(*driver.model, b)) continue;
        const ModelBody& body = driver.model->bodies()[b];
        bool is_in_front = false;
        for (std::size_t v = 0; v < body.vertices.size() && !is_in_front; ++v) {
            const Vec3 p = body.vertex_world(state.bodies[b], v);
            for (std::size_t i = 0; i < scan.sensing.size() && !is_in_front; ++i) {
                is_in_front = scan.sensing.normals[i].dot(p - scan.sensing.positions[i]) > 0.0;
            }
        }
        if (is_in_front) continue;
        throw core::Error("model: start of " + body.name,
                          "found it behind the relay wall",
                          "must be on the hidden side, or use start: search");
    }
}

std::vector<NamedState> searched(const FitDriver& driver, const Vec3& center) {
    std::size_t target = driver.model->bodies().size();
    for (std::size_t b = 0; b < driver.model->bodies().size(); ++b) {
        if (!has_free_pose(*driver.model, b)) continue;
        if (target < driver.model->bodies().size()) {
            throw core::Error("model: start",
                              "found several objects with a free pose",
                              "search places one; give the others' poses");
        }
        target = b;
    }
    std::vector<NamedState> result;
    SceneState state = driver.model->start();
    if (target == driver.model->bodies().size()) return {{"search", state}};
    const ModelBody& body = driver.model->bodies()[target];
    const auto is_free = [&](Effect effect) {
        return driver.model->is_free(Owner::Body, target, effect);
    };
    const int count = is_free(Effect::Rotates) ? driver.settings.search_rotations : 1;
    for (const Eigen::Quaterniond& rotation : spread_rotations(count)) {
        BodyState& pose = state.bodies[target];
        pose.rotation = rotation;
        if (is_free(Effect::Translates)) {
            pose.position_m = center - rotation * surface_center(body);
        }
        result.emplace_back(fmt::format("rotation {}", result.size()), state);
    }
    return result;
}

void place_points(const FitDriver& driver, SceneState& state) {
    if (state.points.empty()) return;
    std::vector<Vec3> positions;
    if (!driver.input.start_points.empty()) {
        positions = cluster_centers(driver.input.start_points, state.points.size());
    } else {
        const double blur = driver.settings.blur_schedule_m.size() > 1
                                ? *(driver.settings.blur_schedule_m.end() - 2)
                                : driver.response_sigma_m;
        const double width = std::hypot(driver.response_sigma_m, blur);
        const int merged =
            std::max(1, static_cast<int>(kBinPerSigma * width / driver.data.axis.bin_width_m));
        const FitData coarse = coarsen(driver.data, blur, merged);
        positions = brightest_points(driver.input.capture.scan.wall(),
                                     coarse,
                                     driver.ambient_guess * merged,
                                     width,
                                     driver.offset_m,
                                     static_cast<int>(state.points.size()));
    }
    for (std::size_t i = 0; i < positions.size(); ++i) state.points[i].position_m = positions[i];
}

// All of a state's light in the data's bins, without ambient light.
double light_of(const FitDriver::Stage& stage, const SceneState& state) {
    stage.model->update(without_added_light(state), renderer::Gradients::Without);
    std::vector<double> sums(stage.model->scan().num_pairs());
    core::parallel_for(sums.size(), [&](std::size_t pair) {
        PairModel model;
        stage.model->evaluate(pair, model);
        const core::BinRange seen = stage.data->observed_range(pair);
        sums[pair] =
            std::accumulate(model.mean.begin() + seen.begin, model.mean.begin() + seen.end, 0.0);
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

// The one factor that all light shares is set by the sums of data and model.
void match_brightness(const FitDriver& driver, FitDriver::Stage& stage, SceneState& state) {
    const double light = light_of(stage, state);
    const FitData& data = *stage.data;
    const double total = std::accumulate(data.values.begin(), data.values.end(), 0.0);
    const double ambient =
        std::min(0.9 * total,
                 driver.ambient_guess * static_cast<double>(data.num_observed()) *
                     stage.model->settings().bins_per_ambient);
    if (!(light > 0.0)) return;
    const double change = std::log((total - ambient) / light);
    if (!std::isfinite(change)) return;
    for (const ParameterBlock& block : driver.model->blocks()) {
        if (block.row->effect != Effect::Multiplies) continue;
        if (driver.scale_is_unknown && block.row->owner != Owner::Scene) continue;
        block.row->numbers(state, block.item)[0] += change;
    }
}

}  // namespace

FitDriver::FitDriver(const FitInput& fit_input, const core::Progress& progress)
    : input(fit_input), geometry(fit_input.geometry), settings(fit_input.settings) {
    validate(settings, "model: ");
    count_places_once(progress);
    settings.response = core::resolve_response(settings.response, input.capture, "model: response");
    response = core::make_response(settings.response, "model: response");
    response_sigma_m = std::sqrt(core::moments(response).variance_m2);
    for (const Parameter* row : parameters()) {
        if (!settings.free.parameters.contains(row->name) || row->refusal == nullptr) continue;
        if (const auto refusal = row->refusal(settings.response)) {
            throw core::Error(
                fmt::format("model: free.{}", row->name), refusal->first, refusal->second);
        }
    }
    is_poisson = settings.residual == ResidualKind::Poisson ||
                 (settings.residual == ResidualKind::Auto && is_integer_valued(input.capture));
    data = crop(input.capture, settings.window_m);
    const double total = std::accumulate(data.values.begin(), data.values.end(), 0.0);
    if (!(total > 0.0)) throw core::Error("capture", "found no light", "must hold some to fit");
    data.min_mean = 1e-6 * total / static_cast<double>(data.num_observed());
    offset_m = input.offset_m;
    for (std::size_t pair = 0; offset_m.size() < input.capture.scan.num_pairs(); ++pair) {
        offset_m.push_back(input.capture.scan.wall().device_segments_m(pair));
    }

    scale_is_unknown = input.capture.unit == core::TransientUnit::Counts &&
                       !input.capture.counts_per_radiance && !geometry.objects.empty() &&
                       !settings.free.objects.empty();
    if (scale_is_unknown) hold_one_albedo();
    if (!is_poisson) elimination = {scale_is_unknown, false};
    for (const Parameter* row : parameters()) {
        if (row->owner != Owner::Scene) continue;
        if (row->effect == Effect::Multiplies && scale_is_unknown && is_poisson) {
            settings.free.parameters.insert(row->name);
        } else if (row->effect == Effect::AddsLight && !is_poisson) {
            elimination.ambient = settings.free.parameters.erase(row->name) > 0;
        }
    }
    model = std::make_unique<SceneModel>(geometry, settings);
    ambient_guess = quietest_level(data);
    is_cut = light_is_cut(data, ambient_guess);
    tolerance = settings.element_tolerance.value_or(is_poisson ? tolerance_for(total)
                                                               : kToleranceWithoutNoise);

    solve_settings.loss = settings.loss;
    solve_settings.loss_scale = settings.loss_scale;
    solve_settings.prior = {settings.laplacian_weight, settings.free.prior_sigma};
    solve_settings.lowest_log_ambient = std::log(data.min_mean);
    solve_settings.stop_requested = progress.stop_requested;
}

void FitDriver::count_places_once(const core::Progress& progress) {
    const std::vector<renderer::Object>& stated = input.geometry.objects;
    const std::vector<renderer::CoincidentFaces> faces = renderer::leave_out_covered_faces(
        geometry.objects,
        face_precedence(stated, settings.free),
        renderer::coincidence_m(stated, input.capture.scan.path_ends()));
    for (const renderer::CoincidentFaces& of_object : faces) {
        const bool is_free = std::ranges::any_of(settings.free.objects, [&](const auto& object) {
            return object.name == of_object.object;
        });
        if (!is_free || of_object.num_left_out < of_object.num_faces) continue;
        throw core::Error(
            "model: free",
            fmt::format("found '{}', which lies on {}", of_object.object, of_object.by),
            "must free one of them");
    }
    if (!faces.empty() && progress.announce) progress.announce(renderer::describe(faces));
}

// Data of unknown scale leave one albedo open: the first free one stays at its start.
void FitDriver::hold_one_albedo() {
    for (FreeObject& object : settings.free.objects) {
        for (const Parameter* row : parameters()) {
            const bool is_factor = row->owner == Owner::Body && row->effect == Effect::Multiplies;
            if (!is_factor || object.parameters.erase(row->name) == 0) continue;
            fixed_albedo = object.name;
            return;
        }
    }
}

FitDriver::Stage FitDriver::make_stage(const SceneModel& free_model,
                                       double blur_m,
                                       double refinement) const {
    Stage stage;
    stage.blur_m = blur_m;
    ForwardSettings forward;
    const double sigma_m = std::hypot(response_sigma_m, blur_m);
    // The edge of a response with a tail is as sharp as its core.
    const double core_m = core::sigma_m_from_fwhm_ps(settings.response.jitter_fwhm_ps);
    const double sharpest_m = core_m > 0.0 ? std::hypot(core_m, blur_m) : sigma_m;
    const double width = sigma_m > 0.0 ? sharpest_m : data.axis.bin_width_m;
    const int merged = std::max(1, static_cast<int>(kBinPerSigma * width / data.axis.bin_width_m));
    // Blurred stages only lead the way: they need few pairs.
    const std::size_t most =
        settings.max_pairs ? static_cast<std::size_t>(*settings.max_pairs) : offset_m.size();
    const PairSubset subset = thin(input.capture.scan.wall(),
                                   blur_m > 0.0 ? std::min(most, kPairsOfBlurredStages) : most);
    const FitData coarse = coarsen(select(data, subset.pairs), blur_m, merged);
    const int spoilt = static_cast<int>(std::ceil(kBlurReach * blur_m / coarse.axis.bin_width_m));
    stage.data =
        std::make_unique<FitData>(trim(coarse, is_cut[0] ? spoilt : 0, is_cut[1] ? spoilt : 0));
    stage.data->min_mean = data.min_mean * merged;
    forward.axis = stage.data->axis;
    forward.bins_per_ambient = merged;
    forward.sigma_m = sigma_m;
    forward.response_fraction =
        sigma_m > 0.0 ? response_sigma_m * response_sigma_m / (sigma_m * sigma_m) : 1.0;
    // Under a wide blur the shape of the response does not matter, only its width and mean.
    const bool is_gaussian = std::holds_alternative<core::GaussianResponse>(response);
    if (!is_gaussian && blur_m == 0.0) forward.measured = response;
    const double mean_delay = forward.measured ? 0.0 : core::moments(response).mean_m;
    for (const std::size_t pair : subset.pairs) {
        forward.offset_m.push_back(offset_m[pair] + mean_delay);
    }
    const WallMotion wall(input.capture.scan.wall());
    const double albedo = input.scene.relay_wall.albedo;
    forward.radiance_factor = albedo * albedo / (core::kPi * core::kPi * core::kPi) *
                              input.capture.counts_per_radiance.value_or(1.0);
    forward.spot_m2 = input.scene.render.laser_spot_m2;
    forward.tolerance = tolerance / refinement;
    if (blur_m > 0.0) forward.tolerance = std::max(forward.tolerance, kBlurredTolerance);
    stage.model = std::make_unique<ForwardModel>(free_model, subset.scan, wall, std::move(forward));
    stage.objective = std::make_unique<FitObjective>(
        *stage.model, *stage.data, is_poisson, elimination, free_model.num_columns());
    return stage;
}

bool FitDriver::is_usable(const Stage& stage) const {
    const int num_bins =
        core::observed_hull(stage.data->observed, stage.data->axis.num_bins).size();
    return num_bins >= std::min(kMinBins, data.axis.num_bins);
}

void FitDriver::check_light(const Stage& stage, const SceneState& state) const {
    stage.model->refresh(state);
    if (light_of(stage, state) > 0.0) return;
    throw core::Error("model: start",
                      "found none of its light on the time axis",
                      fmt::format("must have path lengths from {:.3f} to {:.3f} m, or use start: "
                                  "search",
                                  data.axis.opl_start_m,
                                  data.axis.opl_end_m()));
}

std::vector<NamedState> FitDriver::starts() const {
    std::vector<NamedState> result;
    if (settings.start == "given") {
        result = {{"given", model->start()}};
        check_start(*this, result.front().second);
    } else if (settings.start == "search") {
        result =
            searched(*this, trilaterate(input.capture.scan.wall(), data, ambient_guess, offset_m));
    } else {
        if (input.start_points.empty()) {
            throw core::Error(settings.start, "holds no surface point", "cannot be started from");
        }
        Vec3 sum = Vec3::Zero();
        for (const Vec3& p : input.start_points) sum += p;
        result = searched(*this, sum / static_cast<double>(input.start_points.size()));
    }
    for (auto& [name, state] : result) {
        place_points(*this, state);
        for (const ParameterBlock* block : model->find(Owner::Scene, 0, Effect::AddsLight)) {
            block->row->numbers(state)[0] = std::log(std::max(ambient_guess, 10.0 * data.min_mean));
        }
    }
    return result;
}

bool FitDriver::has_few_photons() const {
    constexpr double kManyPerParameter = 50.0;
    const double total = std::accumulate(data.values.begin(), data.values.end(), 0.0);
    const double ambient = ambient_guess * static_cast<double>(data.num_observed());
    return is_poisson && total - ambient < kManyPerParameter * model->num_columns();
}

std::vector<NamedState> FitDriver::turned(const SceneState& state) const {
    constexpr double kNearlySame = 0.2;
    constexpr double kNearlySameInNoise = 0.6;
    return symmetric_poses(*model, state, has_few_photons() ? kNearlySameInNoise : kNearlySame);
}

SolveSummary FitDriver::solve(Stage& stage,
                              SceneState& state,
                              int max_iterations,
                              const std::function<void(int)>& report) const {
    SolveSettings limits = solve_settings;
    limits.max_iterations = max_iterations;
    if (stage.blur_m > 0.0) limits.prior.laplacian_weight *= kBlurredSmoothness;
    const int rounds = stage.blur_m > 0.0 ? kBlurredVisibilityRounds : kMaxVisibilityRounds;
    SolveSummary total;
    limits.report = [&](int iterations) { report(total.iterations + iterations); };
    for (int round = 0; round < rounds; ++round) {
        stage.model->refresh(state);
        if (round > 0 && !stage.model->visibility_changed()) break;
        if (round == 0) match_brightness(*this, stage, state);
        const SolveSummary summary = solve_stage(*model, *stage.objective, limits, state);
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
