// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce.h"

#include "renderer/core/process.h"
#include "renderer/core/stopwatch.h"
#include "renderer/third_bounce/third_bounce_scan.h"
#include "renderer/third_bounce/trial_scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <utility>

namespace renderer {
namespace {

using core::Transient;

constexpr double kDefaultTargetError = 0.01;

// Fineness k has the tolerance target * 2^k. The first one tried meets the target more often than
// not.
constexpr int kCoarsest = 5;
constexpr int kFirst = 1;
constexpr int kFinest = -10;
constexpr int kReferenceSteps = 2;  // a reference is at least this much finer
// A cut with this times the pieces of the coarsest one is as coarse as can be: facets limit it.
constexpr double kNearlyFewest = 1.05;

// A reference has an error of its own, and the trial pairs are not all pairs.
constexpr double kCaution = 1.5;

// Pieces whose visibility may be wrong add up; each may err by this much of the whole.
constexpr double kNegligibleShare = 0.1;

// What visibility may take of the memory that is free.
constexpr double kShareOfMemory = 0.5;

double memory_for_visibility() {
    return kShareOfMemory * static_cast<double>(core::available_memory_bytes());
}

double squared_norm(const Transient& transient) {
    double sum = 0.0;
    for (const float value : transient.values()) sum += double{value} * double{value};
    return sum;
}

double relative_difference(const Transient& a, const Transient& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        const double difference = double{a.values()[i]} - double{b.values()[i]};
        sum += difference * difference;
    }
    const double norm = squared_norm(b);
    if (sum == 0.0) return 0.0;
    return norm > 0.0 ? std::sqrt(sum / norm) : std::numeric_limits<double>::infinity();
}

// Finds the fineness that meets the target, and integrates with it.
class Integrator {
 public:
    Integrator(const Scene& scene,
               const core::Scan& scan,
               const core::TimeAxis& axis,
               const RenderSettings& settings)
        : scene_(scene),
          scan_(scan),
          trial_scan_(trial_scan(scene, scan, axis.num_bins)),
          axis_(axis),
          trial_axis_(trial_axis(axis)),
          target_(settings.target_error.value_or(kDefaultTargetError)),
          seconds_(settings.seconds),
          cutter_(scene, scan, axis, settings.laser_spot_m2) {}

    ThirdBounce run(const core::Progress& progress);

 private:
    double tolerance(int fineness) const { return target_ * std::exp2(fineness); }
    const PieceSet& cut(int fineness);
    double negligible_error(int fineness) const {
        return kNegligibleShare * tolerance(fineness) * norm_per_pair_;
    }
    void count_rays(const ThirdBounceScan& scan) {
        num_rays_ += scan.num_rays();
        tracing_seconds_ += scan.tracing_seconds();
    }
    const Transient& try_out(int fineness);
    double error_of(int fineness);
    int choose_fineness(const core::Progress& progress);
    int finest_in_time(const core::Progress& progress);
    int integrate(int fineness,
                  int first_part,
                  const core::Progress& progress,
                  ThirdBounce& result);

    const Scene& scene_;
    const core::Scan& scan_;
    core::Scan trial_scan_;
    core::TimeAxis axis_;
    core::TimeAxis trial_axis_;
    double target_;
    std::optional<double> seconds_;
    PieceCutter cutter_;
    std::deque<std::pair<int, PieceSet>> cuts_;  ///< the latest
    bool stopped_ = false;                       ///< before all trials were made
    double norm_per_pair_ = 0.0;
    std::map<int, Transient> trials_;
    std::map<int, std::size_t> num_pieces_;
    std::map<int, double> shadow_errors_;  // expected ones, absolute
    std::map<int, double> errors_;
    // What trials took, and cutting the surfaces for them.
    std::map<int, double> trial_seconds_;
    std::map<int, double> cut_seconds_;
    std::uint64_t num_rays_ = 0;
    double tracing_seconds_ = 0.0;
};

// Valid until two others are asked for: the fineness chosen is often the one before that which
// missed the target.
const PieceSet& Integrator::cut(int fineness) {
    constexpr std::size_t kMostCuts = 2;
    for (const auto& [cut_fineness, pieces] : cuts_) {
        if (cut_fineness == fineness) return pieces;
    }
    if (cuts_.size() == kMostCuts) cuts_.pop_front();
    return cuts_.emplace_back(fineness, cutter_.cut(tolerance(fineness))).second;
}

const Transient& Integrator::try_out(int fineness) {
    if (const auto it = trials_.find(fineness); it != trials_.end()) return it->second;
    const core::Stopwatch cutting;
    const PieceSet& pieces = cut(fineness);
    cut_seconds_[fineness] = cutting.seconds();
    num_pieces_[fineness] = pieces.num_pieces;
    const core::Stopwatch watch;
    ThirdBounceScan trial(scene_,
                          trial_scan_,
                          trial_axis_,
                          pieces,
                          negligible_error(fineness),
                          memory_for_visibility());
    Transient& result =
        trials_.try_emplace(fineness, trial_scan_.num_pairs(), trial_axis_.num_bins).first->second;
    trial.integrate(
        0, [](double) { return true; }, result);
    trial_seconds_[fineness] = watch.seconds();
    shadow_errors_[fineness] = std::sqrt(trial.squared_shadow_error());
    count_rays(trial);
    if (norm_per_pair_ == 0.0) {
        norm_per_pair_ =
            std::sqrt(squared_norm(result) / static_cast<double>(trial_scan_.num_pairs()));
    }
    return result;
}

// Against the finest trial so far, which is at least kReferenceSteps finer.
double Integrator::error_of(int fineness) {
    if (trials_.empty() || trials_.begin()->first > fineness - kReferenceSteps) {
        try_out(fineness - kReferenceSteps);
    }
    const Transient& trial = try_out(fineness);
    const Transient& reference = trials_.begin()->second;
    const double norm = std::sqrt(squared_norm(reference));
    // Shadow edges that both trials leave uncertain do not show in their difference.
    const double shadows = norm > 0.0 ? shadow_errors_[fineness] / norm : 0.0;
    const double error = kCaution * std::hypot(relative_difference(trial, reference), shadows);
    errors_[fineness] = error;
    return error;
}

// The finest that will be done in time, its error known, if all pairs take as long as those of the
// trials, and a finer trial longer by as much as the last ones did.
int Integrator::finest_in_time(const core::Progress& progress) {
    const double trials_to_all =
        static_cast<double>(scan_.num_pairs()) / static_cast<double>(trial_scan_.num_pairs());
    const core::Stopwatch watch;
    int fineness = kCoarsest;
    error_of(fineness);
    for (; fineness > kFinest && !progress.should_stop(); --fineness) {
        const int next = fineness - 1;
        const int finest = trials_.begin()->first;
        const auto trial_and_cut = [&](int k) { return trial_seconds_[k] + cut_seconds_[k]; };
        const double growth =
            std::max(1.0, trial_and_cut(finest) / trial_and_cut(finest + kReferenceSteps));
        const double reference = std::pow(growth, 1.0 / kReferenceSteps) * trial_and_cut(finest);
        if (watch.seconds() + reference > *seconds_) break;
        error_of(next);
        const double all = trial_seconds_[next] * trials_to_all + cut_seconds_[next];
        if (watch.seconds() + all > *seconds_) break;
    }
    stopped_ = progress.should_stop();
    return fineness;
}

// The coarsest fineness that meets the target, or simply the coarsest when the caller will not
// wait.
int Integrator::choose_fineness(const core::Progress& progress) {
    if (seconds_) return finest_in_time(progress);
    int fineness = kFirst;
    // Fine enough for the next finer one, too. A coarser reference misses shadows that both leave
    // out.
    try_out(fineness - 1 - kReferenceSteps);
    if (error_of(fineness) > target_) {
        while (fineness > kFinest && error_of(--fineness) > target_) {
            if (!progress.should_stop()) continue;
            stopped_ = true;
            return kCoarsest;
        }
        return fineness;
    }
    const auto fewest = static_cast<double>(cutter_.fewest_pieces(tolerance(kCoarsest)));
    const auto can_be_coarser = [&] {
        return static_cast<double>(num_pieces_.at(fineness)) > kNearlyFewest * fewest;
    };
    while (fineness < kCoarsest && can_be_coarser() && error_of(fineness + 1) <= target_) {
        ++fineness;
    }
    return fineness;
}

// Integrates parts from `first_part` on; returns the first part that is left.
int Integrator::integrate(int fineness,
                          int first_part,
                          const core::Progress& progress,
                          ThirdBounce& result) {
    const PieceSet& pieces = cut(fineness);
    ThirdBounceScan scan(
        scene_, scan_, axis_, pieces, negligible_error(fineness), memory_for_visibility());
    const auto go_on = [&](double share) {
        progress.update(share, fmt::format("{} pieces", pieces.num_pieces));
        return !progress.should_stop();
    };
    const int part = scan.integrate(first_part, go_on, result.transient);
    result.num_pieces = std::max(result.num_pieces, pieces.num_pieces);
    count_rays(scan);
    if (!errors_.contains(fineness)) error_of(fineness);
    result.estimated_error = std::max(result.estimated_error, errors_.at(fineness));
    return part;
}

ThirdBounce Integrator::run(const core::Progress& progress) {
    ThirdBounce result;
    result.transient = Transient(scan_.num_pairs(), axis_.num_bins);
    const int part = integrate(choose_fineness(progress), 0, progress, result);
    result.interrupted = stopped_ || part < ThirdBounceScan::kParts;
    if (part < ThirdBounceScan::kParts) {
        core::Progress to_the_end;
        to_the_end.report = progress.report;
        integrate(kCoarsest, part, to_the_end, result);
    }
    result.num_rays = num_rays_;
    result.tracing_seconds = tracing_seconds_;
    const double wall = scene_.wall_albedo() / core::kPi;
    for (float& value : result.transient.values()) value = static_cast<float>(value * wall * wall);
    const double norm = squared_norm(result.transient);
    if (norm > 0.0) result.squared_error = std::pow(result.estimated_error, 2) * norm;
    return result;
}

}  // namespace

ThirdBounce integrate_third_bounce(const Scene& scene,
                                   const core::Scan& scan,
                                   const core::TimeAxis& axis,
                                   const RenderSettings& settings,
                                   const core::Progress& progress) {
    const core::Stopwatch watch;
    ThirdBounce result = Integrator(scene, scan, axis, settings).run(progress);
    result.seconds = watch.seconds();
    return result;
}

}  // namespace renderer
