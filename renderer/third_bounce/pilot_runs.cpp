// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/pilot_runs.h"

#include "renderer/core/error.h"
#include "renderer/core/statistics.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/process.h"
#include "renderer/scene/coinciding_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Transient;

constexpr double kSuspiciousFraction =
    0.05;                                // of the target: a difference too small to be believed
constexpr double kFinerReference = 3.0;  // then: times as many elements

// A reference has an error of its own, and the pairs of the pilot run are not all pairs.
constexpr double kCaution = 1.5;

// What a difference from the next finer level is short of one from kReferenceSteps finer, where
// errors fall with the square root of the tolerance; those of shadow edges fall with its power of
// about 0.75 [measured on `bars`].
const double kNextLevelFactor =
    (1.0 - std::exp2(-0.5 * PilotRuns::kReferenceSteps)) / (1.0 - std::exp2(-0.5));

// Rays of each of both sets of a VisibilityCheck over all pairs of a pilot run, down to this
// target. The noise of what they find falls with their square root, as targets do with theirs.
constexpr double kCheckRays = 65'536.0;
constexpr double kCheckTarget = 0.01;
constexpr double kMostCheckRays = 4'194'304.0;

// Where rays to random points find this many times the error that two cuts differ by, shadows are
// finer than the elements of both.
constexpr double kMissedByCuts = 1.5;

// Errors of elements whose visibility is wrong add up; each may err by this fraction of the
// tolerance.
constexpr double kNegligibleFraction = 0.1;

// Fraction of the free memory that visibility may take.
constexpr double kFractionOfMemory = 0.5;

double relative_difference(const Transient& a, const Transient& b) {
    double sum = 0.0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        const double difference = double{a.values()[i]} - double{b.values()[i]};
        sum += difference * difference;
    }
    const double norm = core::squared_norm(b.values());
    if (sum == 0.0) return 0.0;
    return norm > 0.0 ? std::sqrt(sum / norm) : std::numeric_limits<double>::infinity();
}

constexpr std::size_t kPilotPoints = 32;         // confocal and single
constexpr std::size_t kPilotPointsPerSide = 12;  // exhaustive
// With few bins there is less to compare per pair.
constexpr int kPilotFewBins = 16;
constexpr std::size_t kPilotPointsForFewBins = 128;
constexpr std::size_t kPilotPointsPerSideForFewBins = 16;

// `count` indices below `size`, spread evenly but not in step with the rows of a grid; all of them
// where these are few, since a single point whose shadow goes unseen then weighs much in the error.
std::vector<std::size_t> spread_indices(std::size_t size, std::size_t count) {
    constexpr double kGolden = 0.6180339887498949;
    if (size <= 2 * count) count = size;
    std::vector<std::size_t> indices;
    for (std::size_t i = 0; i < std::min(size, count); ++i) {
        const double fraction = (static_cast<double>(i) + 0.5) * kGolden;
        indices.push_back(count >= size
                              ? i
                              : static_cast<std::size_t>(static_cast<double>(size) *
                                                         (fraction - std::floor(fraction))));
    }
    std::sort(indices.begin(), indices.end());
    indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
    return indices;
}

void append(const core::WallPoints& points, std::size_t index, core::WallPoints& chosen) {
    chosen.positions.push_back(points.positions[index]);
    chosen.normals.push_back(points.normals[index]);
}

core::WallPoints subset(const core::WallPoints& points, std::size_t count) {
    core::WallPoints chosen;
    for (const std::size_t i : spread_indices(points.size(), count)) append(points, i, chosen);
    return chosen;
}

// Adds a pair whose ends coincide, if the scan has one and the pilot run has none.
void add_confocal_pair(const core::WallScan& scan, core::WallScan& pilot) {
    const CoincidingPoints coinciding(scan);
    if (!coinciding.any() || CoincidingPoints(pilot).any()) return;
    const auto found = std::ranges::find(coinciding.sensing, true);
    const auto sensor = static_cast<std::size_t>(found - coinciding.sensing.begin());
    append(scan.sensing, sensor, pilot.sensing);
    if (scan.pattern == core::ScanPattern::Single) return;
    for (std::size_t light = 0; light < scan.illumination.size(); ++light) {
        if (scan.illumination.positions[light] != scan.sensing.positions[sensor] ||
            scan.illumination.normals[light] != scan.sensing.normals[sensor]) {
            continue;
        }
        append(scan.illumination, light, pilot.illumination);
        return;
    }
}

}  // namespace

core::WallScan pilot_scan_for(const Scene& scene, const core::WallScan& scan, int num_bins) {
    const bool few_bins = num_bins < kPilotFewBins;
    if (scan.pattern == core::ScanPattern::Exhaustive) {
        return pilot_scan(
            scene, scan, few_bins ? kPilotPointsPerSideForFewBins : kPilotPointsPerSide);
    }
    return pilot_scan(scene, scan, few_bins ? kPilotPointsForFewBins : kPilotPoints);
}

core::WallScan pilot_scan(const Scene& scene, const core::WallScan& scan, std::size_t num_points) {
    core::WallScan pilot = scan;
    pilot.sensing = subset(scan.sensing, num_points);
    if (scan.pattern == core::ScanPattern::Exhaustive) {
        pilot.illumination = subset(scan.illumination, num_points);
    }
    if (scan.pattern == core::ScanPattern::Confocal) pilot.illumination = pilot.sensing;
    const bool has_retroreflectors = std::ranges::any_of(scene.objects(), [](const Object& object) {
        return traits_of(object.material.model).returns_to_source;
    });
    if (has_retroreflectors) add_confocal_pair(scan, pilot);
    return pilot;
}

core::TimeAxis pilot_axis(const core::TimeAxis& axis) {
    if (axis.num_bins < kPilotFewBins) return axis;
    const double first_bin = std::floor(axis.opl_start_m / axis.bin_width_m);
    return {first_bin * axis.bin_width_m, axis.bin_width_m, axis.num_bins + 1};
}

PilotRuns::PilotRuns(const Scene& scene,
                     const core::WallScan& scan,
                     const core::TimeAxis& axis,
                     double target,
                     double laser_spot_m2,
                     const CutLimits& limits)
    : scene_(scene),
      pilot_scan_(pilot_scan_for(scene, scan, axis.num_bins)),
      pilot_axis_(pilot_axis(axis)),
      target_(target),
      most_work_s_(limits.work_s),
      subdivider_(scene, scan, axis, laser_spot_m2, limits) {}

double PilotRuns::tolerance(int level) const {
    return target_ * std::exp2(level);
}

// CPU times as measured on the scenes of scenes/, cutting included.
void PilotRuns::allow_work(double num_elements, std::size_t num_pairs) const {
    constexpr double kPerElement_s = 3e-8;  // and pair
    constexpr double kPerRay_s = 5e-8;
    const double elements = integrated_ + num_elements * static_cast<double>(num_pairs);
    const double work_s =
        kPerElement_s * elements + kPerRay_s * static_cast<double>(cost_.num_rays);
    if (work_s > most_work_s_) throw TooMuchWork{};
}

// The level chosen is often the one before the last tried, which missed the target.
void PilotRuns::for_each_batch(int level,
                               const std::function<bool(const ElementSet& batch)>& work) {
    constexpr std::size_t kMaxCuts = 2;
    for (const auto& [cut_level, elements] : cuts_) {
        if (cut_level != level) continue;
        work(elements);
        return;
    }
    if (cuts_.size() == kMaxCuts) cuts_.pop_front();
    subdivider_.cut(tolerance(level), [&](ElementSet&& batch) {
        if (batch.fraction < 1.0) return work(batch);
        return work(cuts_.emplace_back(level, std::move(batch)).second);
    });
}

ScanRules PilotRuns::rules(int level) const {
    ScanRules rules;
    rules.negligible_error = kNegligibleFraction * tolerance(level) * norm_per_pair_;
    rules.memory_bytes = kFractionOfMemory * static_cast<double>(core::available_memory_bytes());
    rules.plan = plan_;
    return rules;
}

std::size_t PilotRuns::check_rays_per_pair() const {
    const double rays = kCheckRays * std::max(1.0, kCheckTarget / target_);
    return static_cast<std::size_t>(std::min(rays, kMostCheckRays) /
                                    static_cast<double>(pilot_scan_.num_pairs()));
}

void PilotRuns::estimate_norm(int level) {
    constexpr std::size_t kPoints = 4;
    const core::WallScan few = pilot_scan(scene_, pilot_scan_, kPoints);
    Transient transient(few.num_pairs(), pilot_axis_.num_bins);
    for_each_batch(level, [&](const ElementSet& batch) {
        ThirdBounceScan integrator(scene_, few, pilot_axis_, rules(level));
        integrator.integrate(batch, transient);
        cost_ += integrator.cost();
        return true;
    });
    norm_per_pair_ =
        std::sqrt(core::squared_norm(transient.values()) / static_cast<double>(few.num_pairs()));
}

const Pilot& PilotRuns::run(int level) {
    const auto found = pilots_.find(level);
    if (found != pilots_.end()) return found->second;
    Pilot pilot;
    pilot.transient = Transient(pilot_scan_.num_pairs(), pilot_axis_.num_bins);
    ScanRules checked = rules(level);
    checked.check_rays = check_rays_per_pair();
    ThirdBounceScan integrator(scene_, pilot_scan_, pilot_axis_, checked);
    const core::Stopwatch watch;
    for_each_batch(level, [&](const ElementSet& batch) {
        if (pilot.num_elements > 0 && should_stop_ && should_stop_()) throw Stopped{};
        const auto num_elements = static_cast<double>(batch.num_elements);
        allow_work(num_elements, num_pairs());
        integrated_ += num_elements * static_cast<double>(num_pairs());
        const core::Stopwatch integrating;
        integrator.integrate(batch, pilot.transient);
        pilot.num_elements += batch.num_elements;
        pilot.seconds += integrating.seconds();
        return true;
    });
    pilot.cut_seconds = watch.seconds() - pilot.seconds;
    pilot.shadow_error = std::sqrt(integrator.squared_shadow_error());
    const SquaredError missed = integrator.squared_visibility_error();
    pilot.missed_error = std::sqrt(std::max(0.0, missed.value - std::sqrt(missed.variance)));
    cost_ += integrator.cost();
    if (norm_per_pair_ == 0.0) {
        norm_per_pair_ = std::sqrt(core::squared_norm(pilot.transient.values()) /
                                   static_cast<double>(pilot_scan_.num_pairs()));
    }
    return pilots_.emplace(level, std::move(pilot)).first->second;
}

/// Runs a reference for a level unless there is one; returns the finest level run.
int PilotRuns::run_reference(int level) {
    const auto is_run = [&](int wanted) {
        return !pilots_.empty() && pilots_.begin()->first <= wanted;
    };
    const int wanted = level - kReferenceSteps;
    if (!is_run(wanted) && wanted > too_fine_.value_or(wanted - 1)) {
        try {
            run(wanted);
        } catch (const core::Failure&) {
            too_fine_ = wanted;
        }
    }
    if (!is_run(level - 1)) run(level - 1);
    return pilots_.begin()->first;
}

// Where facets are few and large, levels hardly differ: what both leave out must not count as no
// error, and the reference becomes finer until it has many more elements.
double PilotRuns::error_of(int level) {
    int finest = run_reference(level);
    const auto elements = static_cast<double>(run(level).num_elements);
    Pilot& pilot = pilots_.at(level);
    double difference = relative_difference(pilot.transient, pilots_.at(finest).transient);
    while (difference < kSuspiciousFraction * target_ && finest > kFinest - kReferenceSteps &&
           finest - 1 > too_fine_.value_or(finest - 2) &&
           static_cast<double>(pilots_.at(finest).num_elements) < kFinerReference * elements) {
        difference = relative_difference(pilot.transient, run(--finest).transient);
    }
    if (level - finest < kReferenceSteps) difference *= kNextLevelFactor;
    const double norm = std::sqrt(core::squared_norm(pilots_.at(finest).transient.values()));
    // Shadow edges that both pilot runs leave uncertain do not show in their difference.
    const double shadows = norm > 0.0 ? pilot.shadow_error / norm : 0.0;
    const double missed = norm > 0.0 ? pilot.missed_error / norm : 0.0;
    const double seen_by_cuts = std::hypot(difference, shadows);
    pilot.misses_shadows = missed > kMissedByCuts * seen_by_cuts;
    pilot.error = kCaution * std::max(seen_by_cuts, missed);
    return *pilot.error;
}

bool PilotRuns::look_everywhere() {
    if (plan_ == ShadowRayPlan::Everywhere) return false;
    plan_ = ShadowRayPlan::Everywhere;
    pilots_.clear();
    return true;
}

std::optional<double> PilotRuns::smallest_error() const {
    std::optional<double> smallest;
    for (const auto& [level, pilot] : pilots_) {
        if (pilot.error && (!smallest || *pilot.error < *smallest)) smallest = pilot.error;
    }
    return smallest;
}

}  // namespace renderer
