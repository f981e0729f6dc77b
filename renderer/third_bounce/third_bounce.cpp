// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce.h"

#include "renderer/core/process.h"
#include "renderer/core/stopwatch.h"
#include "renderer/third_bounce/pilot_scan.h"
#include "renderer/third_bounce/third_bounce_scan.h"

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

// Refinement level k has the tolerance target * 2^k. The first one tried meets the target more
// often than not.
constexpr int kCoarsest = 5;
constexpr int kFirst = 1;
constexpr int kFinest = -10;
constexpr int kReferenceSteps = 2;  // a reference is at least this much finer
// A cut with this times the elements of the coarsest one is as coarse as can be: facets limit it.
constexpr double kNearlyFewest = 1.05;

// A reference has an error of its own, and the pilot run pairs are not all pairs.
constexpr double kCaution = 1.5;

// Elements whose visibility may be wrong add up; each may err by this much of the whole.
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

// Finds the refinement level that meets the target, and integrates with it.
class Integrator {
 public:
    Integrator(const Scene& scene,
               const core::Scan& scan,
               const core::TimeAxis& axis,
               const RenderSettings& settings)
        : scene_(scene),
          scan_(scan),
          pilot_scan_(pilot_scan(scene, scan, axis.num_bins)),
          axis_(axis),
          pilot_axis_(pilot_axis(axis)),
          target_(settings.target_error.value_or(kDefaultTargetError)),
          seconds_(settings.seconds),
          cutter_(scene, scan, axis, settings.laser_spot_m2) {}

    ThirdBounce run(const core::Progress& progress);

 private:
    double tolerance(int level) const { return target_ * std::exp2(level); }
    const ElementSet& cut(int level);
    double negligible_error(int level) const {
        return kNegligibleShare * tolerance(level) * norm_per_pair_;
    }
    void count_rays(const ThirdBounceScan& scan) {
        num_rays_ += scan.num_rays();
        tracing_seconds_ += scan.tracing_seconds();
    }
    const Transient& run_pilot(int level);
    double error_of(int level);
    int choose_level(const core::Progress& progress);
    int finest_in_time(const core::Progress& progress);
    int integrate(int level, int first_part, const core::Progress& progress, ThirdBounce& result);

    const Scene& scene_;
    const core::Scan& scan_;
    core::Scan pilot_scan_;
    core::TimeAxis axis_;
    core::TimeAxis pilot_axis_;
    double target_;
    std::optional<double> seconds_;
    SurfaceSubdivider cutter_;
    std::deque<std::pair<int, ElementSet>> cuts_;  ///< the latest
    bool stopped_ = false;                         ///< before all pilot runs were made
    double norm_per_pair_ = 0.0;
    std::map<int, Transient> pilots_;
    std::map<int, std::size_t> num_elements_;
    std::map<int, double> shadow_errors_;  // expected ones, absolute
    std::map<int, double> errors_;
    // What pilot runs took, and cutting the surfaces for them.
    std::map<int, double> pilot_seconds_;
    std::map<int, double> cut_seconds_;
    std::uint64_t num_rays_ = 0;
    double tracing_seconds_ = 0.0;
};

// Valid until two others are asked for: the refinement level chosen is often the one before that
// which missed the target.
const ElementSet& Integrator::cut(int level) {
    constexpr std::size_t kMaxCuts = 2;
    for (const auto& [cut_level, elements] : cuts_) {
        if (cut_level == level) return elements;
    }
    if (cuts_.size() == kMaxCuts) cuts_.pop_front();
    return cuts_.emplace_back(level, cutter_.cut(tolerance(level))).second;
}

const Transient& Integrator::run_pilot(int level) {
    if (const auto it = pilots_.find(level); it != pilots_.end()) return it->second;
    const core::Stopwatch cutting;
    const ElementSet& elements = cut(level);
    cut_seconds_[level] = cutting.seconds();
    num_elements_[level] = elements.num_elements;
    const core::Stopwatch watch;
    ThirdBounceScan pilot(scene_,
                          pilot_scan_,
                          pilot_axis_,
                          elements,
                          negligible_error(level),
                          memory_for_visibility());
    Transient& result =
        pilots_.try_emplace(level, pilot_scan_.num_pairs(), pilot_axis_.num_bins).first->second;
    pilot.integrate(
        0, [](double) { return true; }, result);
    pilot_seconds_[level] = watch.seconds();
    shadow_errors_[level] = std::sqrt(pilot.squared_shadow_error());
    count_rays(pilot);
    if (norm_per_pair_ == 0.0) {
        norm_per_pair_ =
            std::sqrt(squared_norm(result) / static_cast<double>(pilot_scan_.num_pairs()));
    }
    return result;
}

// Against the finest pilot run so far, which is at least kReferenceSteps finer.
double Integrator::error_of(int level) {
    if (pilots_.empty() || pilots_.begin()->first > level - kReferenceSteps) {
        run_pilot(level - kReferenceSteps);
    }
    const Transient& pilot = run_pilot(level);
    const Transient& reference = pilots_.begin()->second;
    const double norm = std::sqrt(squared_norm(reference));
    // Shadow edges that both pilot runs leave uncertain do not show in their difference.
    const double shadows = norm > 0.0 ? shadow_errors_[level] / norm : 0.0;
    const double error = kCaution * std::hypot(relative_difference(pilot, reference), shadows);
    errors_[level] = error;
    return error;
}

// The finest that will be done in time, its error known, if all pairs take as long as those of the
// pilot runs, and a finer pilot run longer by as much as the last ones did.
int Integrator::finest_in_time(const core::Progress& progress) {
    const double pilots_to_all =
        static_cast<double>(scan_.num_pairs()) / static_cast<double>(pilot_scan_.num_pairs());
    const core::Stopwatch watch;
    int level = kCoarsest;
    error_of(level);
    for (; level > kFinest && !progress.should_stop(); --level) {
        const int next = level - 1;
        const int finest = pilots_.begin()->first;
        const auto pilot_and_cut = [&](int k) { return pilot_seconds_[k] + cut_seconds_[k]; };
        const double growth =
            std::max(1.0, pilot_and_cut(finest) / pilot_and_cut(finest + kReferenceSteps));
        const double reference = std::pow(growth, 1.0 / kReferenceSteps) * pilot_and_cut(finest);
        if (watch.seconds() + reference > *seconds_) break;
        error_of(next);
        const double all = pilot_seconds_[next] * pilots_to_all + cut_seconds_[next];
        if (watch.seconds() + all > *seconds_) break;
    }
    stopped_ = progress.should_stop();
    return level;
}

// The coarsest refinement level that meets the target, or simply the coarsest when the caller will
// not wait.
int Integrator::choose_level(const core::Progress& progress) {
    if (seconds_) return finest_in_time(progress);
    int level = kFirst;
    // Fine enough for the next finer one, too. A coarser reference misses shadows that both leave
    // out.
    run_pilot(level - 1 - kReferenceSteps);
    if (error_of(level) > target_) {
        while (level > kFinest && error_of(--level) > target_) {
            if (!progress.should_stop()) continue;
            stopped_ = true;
            return kCoarsest;
        }
        return level;
    }
    const auto fewest = static_cast<double>(cutter_.min_elements(tolerance(kCoarsest)));
    const auto can_be_coarser = [&] {
        return static_cast<double>(num_elements_.at(level)) > kNearlyFewest * fewest;
    };
    while (level < kCoarsest && can_be_coarser() && error_of(level + 1) <= target_) {
        ++level;
    }
    return level;
}

// Integrates parts from `first_part` on; returns the first part that is left.
int Integrator::integrate(int level,
                          int first_part,
                          const core::Progress& progress,
                          ThirdBounce& result) {
    const ElementSet& elements = cut(level);
    ThirdBounceScan scan(
        scene_, scan_, axis_, elements, negligible_error(level), memory_for_visibility());
    const auto go_on = [&](double share) {
        progress.update(share, fmt::format("{} elements", elements.num_elements));
        return !progress.should_stop();
    };
    const int part = scan.integrate(first_part, go_on, result.transient);
    result.num_elements = std::max(result.num_elements, elements.num_elements);
    count_rays(scan);
    if (!errors_.contains(level)) error_of(level);
    result.estimated_error = std::max(result.estimated_error, errors_.at(level));
    return part;
}

ThirdBounce Integrator::run(const core::Progress& progress) {
    ThirdBounce result;
    result.transient = Transient(scan_.num_pairs(), axis_.num_bins);
    const int part = integrate(choose_level(progress), 0, progress, result);
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
