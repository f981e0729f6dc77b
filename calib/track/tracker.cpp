// SPDX-License-Identifier: MIT
#include "calib/track/tracker.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

constexpr std::size_t kCandidates = 3;
constexpr double kLeastScore = 3.0;          // of a candidate worth a fit
constexpr double kStartStrengthSigma = 3.0;  // of the logarithm
constexpr double kKeptProbability = 0.02;
constexpr double kBornProbability = 0.05;
constexpr double kNearestToWall_m = 0.03;
constexpr double kDirectReturnSigmas = 4.0;

double updated(double probability, double log_evidence) {
    const double odds = std::exp(std::min(log_evidence, 500.0));
    return probability * odds / (1.0 - probability + probability * odds);
}

// Whether the sensor only moved along the wall.
bool is_shift(const core::SensorPose& from, const core::SensorPose& to, const Vec3& normal) {
    constexpr double kSame = 1e-6;
    return (from.world_from_sensor() - to.world_from_sensor()).norm() < kSame &&
           std::abs((to.position_m - from.position_m).dot(normal)) < kSame;
}

}  // namespace

Tracker::Tracker(const TrackSettings& settings, const TrackSensor& sensor)
    : settings_(settings),
      sensor_(sensor),
      motion_(settings.motion),
      pose_(settings.poses.empty() ? settings.pose.whole() : settings.poses.front()),
      background_(
          settings.background, sensor.num_zones(), static_cast<std::size_t>(sensor.axis.num_bins)) {
    if (settings_.moves_sensor()) {
        // The wall's distance is known, so is the target's.
        const double z =
            (sensor_.wall.world_from_wall().inverse() * *settings_.target.position_m).z();
        constexpr double kAround_m = 0.15;
        settings_.search.z_range_m = {std::max(kNearestToWall_m, z - kAround_m), z + kAround_m};
    }
    aim(pose_);
    signal_.assign(response_->size(), 0.0);
    if (settings_.noise.dispersion) dispersion_ = *settings_.noise.dispersion;
}

void Tracker::aim(const core::SensorPose& pose) {
    const Vec3 normal = sensor_.wall.normal.normalized();
    const core::SensorFootprints footprints = footprints_at(sensor_, pose);
    response_ =
        std::make_unique<TargetResponse>(response_at(sensor_, footprints, settings_.target));
    if (search_ && is_shift(search_pose_, pose, normal)) {
        search_offset_m_ = pose.position_m - search_pose_.position_m;
    } else {
        box_ = search_box(settings_, sensor_.wall, footprints);
        search_ = std::make_unique<TargetSearch>(*response_, box_, settings_.search.cell_m);
        search_pose_ = pose;
        search_offset_m_ = Vec3::Zero();
    }
    pose_ = pose;
    first_bins_.clear();
    for (const core::ZoneFootprint& zone : footprints.zones) {
        double direct_m = 0.0;
        for (std::size_t i = 0; i < zone.seen.size(); ++i) {
            direct_m = std::max(
                direct_m,
                zone.seen.device_m[i] + (zone.seen.positions[i] - footprints.laser_m).norm());
        }
        if (sensor_.opl_origin == core::OplOrigin::RelayWall) direct_m = 0.0;
        const double until_m = direct_m + kDirectReturnSigmas * sensor_.sigma_m;
        const double bins = (until_m - sensor_.axis.opl_start_m) / sensor_.axis.bin_width_m;
        first_bins_.push_back(
            std::clamp(static_cast<int>(std::ceil(bins)), 0, sensor_.axis.num_bins));
    }
}

void Tracker::learn_background(const std::vector<TrackFrame>& frames) {
    std::vector<std::vector<double>> counts;
    for (const TrackFrame& frame : frames) {
        validate(frame, response_->num_zones(), response_->num_bins());
        if (!frame.counts.empty()) counts.push_back(frame.counts);
    }
    if (counts.empty()) {
        throw core::Error(settings_.background.file, "holds no frame", "must hold frames to learn");
    }
    FrameEstimate unused;
    background_.learn_all(counts, weights_of(frames.front(), unused));
}

void Tracker::warn_once(const std::string& text, FrameEstimate& estimate) {
    if (said_.insert(text).second) estimate.warnings.push_back(text);
}

// 1 for bins that say something.
std::vector<double> Tracker::weights_of(const TrackFrame& frame, FrameEstimate& estimate) {
    const std::size_t bins = response_->num_bins();
    std::vector<double> weights(response_->size(), 0.0);
    for (std::size_t z = 0; z < response_->num_zones(); ++z) {
        const core::BinRange range =
            core::observed_range(frame.observed, z, static_cast<int>(bins));
        double counted = 0.0;
        double awaited = 0.0;
        int full = 0;
        for (int b = std::max(range.begin, first_bins_[z]); b < range.end; ++b) {
            const std::size_t i = z * bins + static_cast<std::size_t>(b);
            counted += frame.counts[i];
            awaited += background_.is_ready() ? background_.mean()[i] : 0.0;
            const auto& ceiling = settings_.noise.saturation_counts;
            if (ceiling && frame.counts[i] >= *ceiling) {
                ++full;
            } else {
                weights[i] = 1.0;
            }
        }
        if (counted == 0.0 && background_.makes_suspicious(awaited, dispersion_)) {
            std::fill_n(weights.begin() + static_cast<std::ptrdiff_t>(z * bins), bins, 0.0);
            warn_once(fmt::format("zone {} counted nothing and is left out", z), estimate);
        }
        if (full > 0) {
            warn_once(
                fmt::format("zone {} is saturated: bins of {:.6g} counts and more are left out",
                            z,
                            *settings_.noise.saturation_counts),
                estimate);
        }
    }
    return weights;
}

// Neighbouring bins expect about the same counts, so that their differences are noise.
double Tracker::dispersion_of(const TrackFrame& frame, const std::vector<double>& weights) {
    if (settings_.noise.dispersion) return *settings_.noise.dispersion;
    if (!counts_are_whole_) {
        counts_are_whole_ = std::all_of(
            frame.counts.begin(), frame.counts.end(), [](double n) { return n == std::floor(n); });
    }
    if (*counts_are_whole_) return 1.0;
    double squares = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < weights.size(); ++i) {
        if (weights[i] == 0.0 || weights[i + 1] == 0.0 || (i + 1) % response_->num_bins() == 0)
            continue;
        const double difference = frame.counts[i + 1] - frame.counts[i];
        squares += difference * difference;
        sum += frame.counts[i + 1] + frame.counts[i];
    }
    if (sum > 0.0) {
        dispersion_frames_ = std::min(dispersion_frames_ + 1.0,
                                      static_cast<double>(settings_.background.memory_frames));
        dispersion_ += (squares / sum - dispersion_) / dispersion_frames_;
    }
    return dispersion_;
}

// A bin may be off by a fraction of what it holds beyond the background; the same for all targets
// that may explain it, so that these can be compared.
void Tracker::add_model_error(const std::vector<double>& counts,
                              std::vector<double>& weights) const {
    const std::vector<double>& background = background_.mean();
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double excess = counts[i] - background[i];
        if (excess <= 0.0) continue;
        const double error = settings_.noise.model_error * excess;
        weights[i] /= 1.0 + weights[i] * error * error / counts[i];
    }
}

bool Tracker::is_hidden(const Vec3& position_m) const {
    const double height = sensor_.wall.normal.normalized().dot(position_m - sensor_.wall.center_m);
    return height > kNearestToWall_m && height < 2.0 * settings_.search.z_range_m[1];
}

void Tracker::predict(double dt_s) {
    const double survival = std::exp(-dt_s / settings_.existence.lifetime_s);
    for (TargetEstimate& target : targets_) {
        target.predicted = dt_s > 0.0 ? motion_.predict(target.state, dt_s) : target.state;
        target.state = target.predicted;
        target.predicted_probability = survival * target.probability;
        target.probability = target.predicted_probability;
        target.log_evidence = 0.0;
    }
}

void Tracker::update(const FrameCounts& frame, FrameEstimate& estimate) {
    std::vector<Gaussian> priors;
    for (const TargetEstimate& target : targets_) priors.push_back(target.predicted);
    const JointUpdate joint =
        update_jointly(*response_, frame, priors, [this](const Vec3& p) { return is_hidden(p); });
    for (std::size_t t = 0; t < targets_.size(); ++t) {
        targets_[t].state = joint.targets[t];
        targets_[t].log_evidence = joint.log_evidence[t];
        targets_[t].probability = updated(targets_[t].predicted_probability, joint.log_evidence[t]);
    }
    estimate.log_likelihood = joint.log_likelihood;
    signal_ = joint.signal;
}

// A target that the frame shows beyond its background.
std::optional<TargetEstimate> Tracker::find(const FrameCounts& frame) const {
    std::optional<TargetEstimate> best;
    for (const Candidate& candidate : search_->find(frame, kCandidates, search_offset_m_)) {
        if (candidate.score < kLeastScore) continue;
        SeenVector mean;
        mean << candidate.position_m, std::log(candidate.strength);
        SeenVector sigma;
        sigma << 0.5 * (box_.ranges_m[0][1] - box_.ranges_m[0][0]),
            0.5 * (box_.ranges_m[1][1] - box_.ranges_m[1][0]),
            0.5 * (box_.ranges_m[2][1] - box_.ranges_m[2][0]), kStartStrengthSigma;
        const SeenMatrix wide = sigma.cwiseAbs2().asDiagonal();
        // Axes of the box are those of the wall.
        Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
        turn.topLeftCorner<3, 3>() = box_.world_from_wall.linear();
        TargetEstimate target;
        target.predicted = motion_.start(mean, turn * wide * turn.transpose());
        const JointUpdate fit =
            update_jointly(*response_, frame, {target.predicted}, [&](const Vec3& p) {
                return box_.holds(p - search_offset_m_) && is_hidden(p);
            });
        target.state = fit.targets.front();
        target.log_evidence = fit.log_evidence.front();
        if (!best || target.log_evidence > best->log_evidence) best = target;
    }
    return best;
}

void Tracker::look_for_more(const FrameCounts& frame, double dt_s) {
    const double birth = std::min(0.5, settings_.existence.birth_per_s * dt_s);
    const bool is_full = targets_.size() >= static_cast<std::size_t>(settings_.max_targets);
    auto weakest =
        std::min_element(targets_.begin(), targets_.end(), [](const auto& a, const auto& b) {
            return a.probability < b.probability;
        });
    std::vector<double> expected(frame.background.begin(), frame.background.end());
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] += signal_[i];
    if (is_full) {
        // Whether the frame is better explained by another target in place of the weakest.
        std::vector<double> unit(response_->size(), 0.0);
        response_->evaluate(weakest->state.position_m(), unit, {});
        const double strength = weakest->state.strength();
        for (std::size_t i = 0; i < expected.size(); ++i) {
            expected[i] = std::max(expected[i] - strength * unit[i], frame.background[i]);
        }
    }
    auto found = find({frame.counts, expected, frame.weights});
    if (!found) return;
    found->predicted_probability = birth;
    found->probability = updated(birth, found->log_evidence);
    if (found->probability < kBornProbability) return;
    found->predicted = found->state;  // nothing was known of it before
    if (is_full) {
        const double continued =
            std::log(std::max(weakest->predicted_probability, 1e-300)) + weakest->log_evidence;
        if (std::log(birth) + found->log_evidence < continued) return;
        targets_.erase(weakest);
    }
    // The background is not to learn from it, not even in this frame.
    std::vector<double> unit(response_->size(), 0.0);
    response_->evaluate(found->state.position_m(), unit, {});
    for (std::size_t i = 0; i < unit.size(); ++i) {
        signal_[i] = expected[i] - frame.background[i] + found->state.strength() * unit[i];
    }
    found->id = next_id_++;
    targets_.push_back(std::move(*found));
}

void Tracker::report(FrameEstimate& estimate) const {
    double none = 1.0;
    for (const TargetEstimate& target : targets_) {
        none *= 1.0 - target.probability;
        TargetEstimate& one = estimate.targets.emplace_back(target);
        one.is_named = target.probability >= settings_.existence.name_at;
    }
    estimate.probability = 1.0 - none;
    if (sensor_.setup) estimate.pose = pose_;
}

FrameEstimate Tracker::step(const TrackFrame& frame) {
    validate(frame, response_->num_zones(), response_->num_bins());
    FrameEstimate estimate;
    estimate.time_s = frame.time_s;
    if (last_time_s_ && !(frame.time_s > *last_time_s_)) {
        estimate.warnings.push_back(
            fmt::format("frame at {:.6g} s does not follow that at {:.6g} s and is left out",
                        frame.time_s,
                        *last_time_s_));
        estimate.is_used = false;
        return estimate;
    }
    estimate.dt_s = last_time_s_ ? frame.time_s - *last_time_s_ : sensor_.frame_s;
    last_time_s_ = frame.time_s;
    if (frame.pose && sensor_.setup) {
        if (settings_.moves_sensor()) {
            warn_once("poses of frames are not used where the sensor's pose is free", estimate);
        } else {
            aim(*frame.pose);
        }
    }
    predict(estimate.dt_s);
    if (frame.counts.empty()) {
        warn_once("frames are missing; targets are moved on without them", estimate);
        report(estimate);
        return estimate;
    }
    std::vector<double> weights = weights_of(frame, estimate);
    const double dispersion = dispersion_of(frame, weights);
    if (!background_.is_ready()) {
        background_.learn(frame.counts, weights);
        estimate.is_learning = true;
        return estimate;
    }
    for (double& weight : weights) weight /= dispersion * (1.0 + background_.excess_variance());
    add_model_error(frame.counts, weights);
    const FrameCounts data{frame.counts, background_.mean(), weights};
    std::fill(signal_.begin(), signal_.end(), 0.0);
    if (!targets_.empty()) update(data, estimate);
    look_for_more(data, estimate.dt_s);
    std::erase_if(targets_,
                  [](const TargetEstimate& t) { return t.probability < kKeptProbability; });
    report(estimate);
    background_.follow(frame.counts, weights, signal_);
    return estimate;
}

}  // namespace calib
