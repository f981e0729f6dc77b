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

// Refinement level k has the tolerance target * 2^k. The first one tried usually meets the target.
constexpr int kCoarsest = 5;
constexpr int kFirst = 1;
constexpr int kFinest = -10;
constexpr int kReferenceSteps = 2;         // a reference is at least this much finer
constexpr double kSuspiciousShare = 0.05;  // of the target: a difference too small to be believed
constexpr double kFinerReference = 3.0;    // then: times as many elements
// A cut with at most this many times the fewest elements cannot become much coarser: facets are
// not merged beyond that.
constexpr double kNearlyFewest = 1.05;

// A reference has an error of its own, and the pairs of the pilot run are not all pairs.
constexpr double kCaution = 1.5;

// Rays of each set of a VisibilityCheck over all pairs of a pilot run, for a target of 1 %; smaller
// targets take more, to know smaller errors from noise.
constexpr double kCheckRays = 65'536.0;
constexpr double kMostCheckRays = 4'194'304.0;

// Where rays to random points find this many times the error that two cuts differ by, shadows are
// finer than the elements of both.
constexpr double kMissedByCuts = 1.5;

// Errors of elements whose visibility is wrong add up; each may err by this share of the tolerance.
constexpr double kNegligibleShare = 0.1;

// Share of the free memory that visibility may take.
constexpr double kShareOfMemory = 0.5;

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

// A run on a few pairs at one refinement level.
struct Pilot {
    Transient transient;
    std::size_t num_elements = 0;
    double shadow_error = 0.0;    ///< expected, absolute
    double missed_error = 0.0;    ///< as found by VisibilityCheck beyond its noise, absolute
    bool misses_shadows = false;  ///< finer than the elements, once compared with a reference
    std::optional<double> error;  ///< relative, once compared with a reference
    double cut_seconds = 0.0;     ///< for cutting the surfaces
    double seconds = 0.0;         ///< for integrating

    double all_seconds() const { return seconds + cut_seconds; }
};

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
          subdivider_(scene, scan, axis, settings.laser_spot_m2) {}

    ThirdBounce run(const core::Progress& progress);

 private:
    ThirdBounce integrate_all(const core::Progress& progress);
    double tolerance(int level) const { return target_ * std::exp2(level); }
    const ElementSet& cut(int level);
    ThirdBounceScan integrator_of(const core::Scan& scan,
                                  const core::TimeAxis& axis,
                                  const ElementSet& elements,
                                  int level) const {
        ScanRules rules;
        rules.negligible_error = kNegligibleShare * tolerance(level) * norm_per_pair_;
        rules.memory_bytes = kShareOfMemory * static_cast<double>(core::available_memory_bytes());
        rules.plan = plan_;
        if (&scan == &pilot_scan_) rules.check_rays = check_rays_per_pair();
        return {scene_, scan, axis, elements, rules};
    }
    std::size_t check_rays_per_pair() const {
        const double rays = kCheckRays * std::max(1.0, kDefaultTargetError / target_);
        return static_cast<std::size_t>(std::min(rays, kMostCheckRays) /
                                        static_cast<double>(pilot_scan_.num_pairs()));
    }
    const Pilot& run_pilot(int level);
    double error_of(int level);
    double smallest_error() const;
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
    SurfaceSubdivider subdivider_;
    std::deque<std::pair<int, ElementSet>> cuts_;  ///< the latest
    bool stopped_ = false;                         ///< before all pilot runs were made
    double norm_per_pair_ = 0.0;
    ShadowRayPlan plan_ = ShadowRayPlan::WhereNeighboursDisagree;
    std::map<int, Pilot> pilots_;  ///< by level, all with this plan
    TracingCost cost_;
};

// Valid until two others are asked for: the level chosen is often the one before the last tried,
// which missed the target.
const ElementSet& Integrator::cut(int level) {
    constexpr std::size_t kMaxCuts = 2;
    for (const auto& [cut_level, elements] : cuts_) {
        if (cut_level == level) return elements;
    }
    if (cuts_.size() == kMaxCuts) cuts_.pop_front();
    return cuts_.emplace_back(level, subdivider_.cut(tolerance(level))).second;
}

const Pilot& Integrator::run_pilot(int level) {
    const auto [it, is_new] = pilots_.try_emplace(level);
    Pilot& pilot = it->second;
    if (!is_new) return pilot;
    const core::Stopwatch cutting;
    const ElementSet& elements = cut(level);
    pilot.cut_seconds = cutting.seconds();
    pilot.num_elements = elements.num_elements;
    const core::Stopwatch watch;
    ThirdBounceScan integrator = integrator_of(pilot_scan_, pilot_axis_, elements, level);
    pilot.transient = Transient(pilot_scan_.num_pairs(), pilot_axis_.num_bins);
    integrator.integrate(
        0, [](double) { return true; }, pilot.transient);
    pilot.seconds = watch.seconds();
    pilot.shadow_error = std::sqrt(integrator.squared_shadow_error());
    const SquaredError missed = integrator.squared_visibility_error();
    pilot.missed_error = std::sqrt(std::max(0.0, missed.value - std::sqrt(missed.variance)));
    cost_ += integrator.cost();
    if (norm_per_pair_ == 0.0) {
        norm_per_pair_ =
            std::sqrt(squared_norm(pilot.transient) / static_cast<double>(pilot_scan_.num_pairs()));
    }
    return pilot;
}

// Against the finest pilot run so far, which is at least kReferenceSteps finer. Where facets are
// few and large, levels hardly differ: what both leave out must not count as no error, and the
// reference becomes finer until it has many more elements.
double Integrator::error_of(int level) {
    int finest = pilots_.empty() ? level : pilots_.begin()->first;
    finest = std::min(finest, level - kReferenceSteps);
    run_pilot(finest);
    const auto elements = static_cast<double>(run_pilot(level).num_elements);
    Pilot& pilot = pilots_.at(level);
    double difference = relative_difference(pilot.transient, pilots_.at(finest).transient);
    while (difference < kSuspiciousShare * target_ && finest > kFinest - kReferenceSteps &&
           static_cast<double>(pilots_.at(finest).num_elements) < kFinerReference * elements) {
        difference = relative_difference(pilot.transient, run_pilot(--finest).transient);
    }
    const double norm = std::sqrt(squared_norm(pilots_.at(finest).transient));
    // Shadow edges that both pilot runs leave uncertain do not show in their difference.
    const double shadows = norm > 0.0 ? pilot.shadow_error / norm : 0.0;
    const double missed = norm > 0.0 ? pilot.missed_error / norm : 0.0;
    const double seen_by_cuts = std::hypot(difference, shadows);
    pilot.misses_shadows = missed > kMissedByCuts * seen_by_cuts;
    pilot.error = kCaution * std::max(seen_by_cuts, missed);
    return *pilot.error;
}

// The finest level that can be finished in time with its error known, assuming that all pairs take
// as long as those of the pilot runs, and that times keep growing from level to level as they did.
int Integrator::finest_in_time(const core::Progress& progress) {
    const double pilots_to_all =
        static_cast<double>(scan_.num_pairs()) / static_cast<double>(pilot_scan_.num_pairs());
    const core::Stopwatch watch;
    int level = kCoarsest;
    error_of(level);
    for (; level > kFinest && !progress.should_stop(); --level) {
        const int next = level - 1;
        const int finest = pilots_.begin()->first;
        const double finest_seconds = pilots_.begin()->second.all_seconds();
        const double growth =
            std::max(1.0, finest_seconds / pilots_.at(finest + kReferenceSteps).all_seconds());
        const double reference = std::pow(growth, 1.0 / kReferenceSteps) * finest_seconds;
        if (watch.seconds() + reference > *seconds_) break;
        error_of(next);
        const Pilot& pilot = pilots_.at(next);
        const double all = pilot.seconds * pilots_to_all + pilot.cut_seconds;
        if (watch.seconds() + all > *seconds_) break;
    }
    stopped_ = progress.should_stop();
    return level;
}

// The coarsest refinement level that meets the target, or simply the coarsest when the caller asks
// to stop.
int Integrator::choose_level(const core::Progress& progress) {
    if (seconds_) return finest_in_time(progress);
    int level = kFirst;
    // Fine enough as a reference for the next finer level, too. A coarser one would miss shadows
    // that both leave out.
    run_pilot(level - 1 - kReferenceSteps);
    bool may_be_coarser = true;
    while (error_of(level) > target_) {
        if (progress.should_stop()) {
            stopped_ = true;
            return kCoarsest;
        }
        if (pilots_.at(level).misses_shadows && plan_ != ShadowRayPlan::Everywhere) {
            plan_ = ShadowRayPlan::Everywhere;
            pilots_.clear();
            may_be_coarser = true;
            continue;
        }
        if (level == kFinest) return level;
        --level;
        may_be_coarser = false;
    }
    if (!may_be_coarser) return level;
    const auto fewest = static_cast<double>(subdivider_.min_elements(tolerance(kCoarsest)));
    const auto can_be_coarser = [&] {
        return static_cast<double>(pilots_.at(level).num_elements) > kNearlyFewest * fewest;
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
    ThirdBounceScan scan = integrator_of(scan_, axis_, elements, level);
    const auto go_on = [&](double share) {
        progress.update(share, fmt::format("{} elements", elements.num_elements));
        return !progress.should_stop();
    };
    const int part = scan.integrate(first_part, go_on, result.transient);
    result.num_elements = std::max(result.num_elements, elements.num_elements);
    cost_ += scan.cost();
    const auto pilot = pilots_.find(level);
    const bool is_known = pilot != pilots_.end() && pilot->second.error;
    result.estimated_error =
        std::max(result.estimated_error, is_known ? *pilot->second.error : error_of(level));
    return part;
}

// Of the levels tried; infinite: none is known.
double Integrator::smallest_error() const {
    double smallest = std::numeric_limits<double>::infinity();
    for (const auto& [level, pilot] : pilots_) {
        if (pilot.error) smallest = std::min(smallest, *pilot.error);
    }
    return smallest;
}

// Rounded up, so that a run that aims at it has some room.
double two_digits_above(double value) {
    const double digit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
    return (std::floor(1.05 * value / digit) + 1.0) * digit;
}

ThirdBounce Integrator::run(const core::Progress& progress) {
    try {
        return integrate_all(progress);
    } catch (const core::Failure& failure) {
        const double error = smallest_error();
        if (!std::isfinite(error) || error <= target_) throw;
        throw core::Failure(
            failure.what(),
            fmt::format("a target error of {:.2g} would do", two_digits_above(error)));
    }
}

ThirdBounce Integrator::integrate_all(const core::Progress& progress) {
    ThirdBounce result;
    result.transient = Transient(scan_.num_pairs(), axis_.num_bins);
    const int part = integrate(choose_level(progress), 0, progress, result);
    result.interrupted = stopped_ || part < ThirdBounceScan::kParts;
    if (part < ThirdBounceScan::kParts) {
        core::Progress to_the_end;
        to_the_end.report = progress.report;
        integrate(kCoarsest, part, to_the_end, result);
    }
    result.num_rays = cost_.num_rays;
    result.tracing_seconds = cost_.seconds;
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
