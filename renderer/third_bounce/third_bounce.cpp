// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/third_bounce.h"

#include "renderer/core/statistics.h"
#include "renderer/core/stopwatch.h"
#include "renderer/third_bounce/pilot_runs.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Transient;

constexpr double kDefaultTargetError = 0.01;

// The first level tried: it usually meets the target.
constexpr int kFirst = 1;
constexpr int kCoarsest = PilotRuns::kCoarsest;
constexpr int kFinest = PilotRuns::kFinest;
constexpr int kReferenceSteps = PilotRuns::kReferenceSteps;

// A cut with at most this many times the fewest elements cannot become much coarser: facets are
// not merged beyond that.
constexpr double kNearlyFewest = 1.05;

// The target of pilot runs that take a second or so.
constexpr double kSoonKnown = 3e-4;

constexpr const char* kTrials = "trial runs for the error";

// Finds the refinement level that meets the target, and integrates with it.
class Integrator {
 public:
    Integrator(const Scene& scene,
               const core::WallScan& scan,
               const core::TimeAxis& axis,
               const RenderSettings& settings,
               const CutLimits& limits)
        : scene_(scene),
          scan_(scan),
          axis_(axis),
          settings_(settings),
          target_(settings.element_tolerance.value_or(
              settings.target_error.value_or(kDefaultTargetError))),
          limits_(limits),
          pilots_(scene, scan, axis, target_, settings.laser_spot_m2, limits) {}

    ThirdBounce run(const core::Progress& progress);

 private:
    int choose_level(const core::Progress& progress);
    int coarsest_that_meets_target(const core::Progress& progress);
    int finest_in_time(const core::Progress& progress);
    int integrate(int level, int first_part, const core::Progress& progress, ThirdBounce& result);
    ThirdBounce integrate_all(const core::Progress& progress);
    std::optional<double> error_within_reach();

    const Scene& scene_;
    const core::WallScan& scan_;
    core::TimeAxis axis_;
    const RenderSettings& settings_;
    double target_;
    CutLimits limits_;
    PilotRuns pilots_;
    bool stopped_ = false;  ///< before all pilot runs were made
    TracingCost cost_;
};

// The finest level that can be finished in time with its error known, assuming that all pairs take
// as long as those of the pilot runs, and that times keep growing from level to level as they did.
int Integrator::finest_in_time(const core::Progress& progress) {
    const double pilots_to_all =
        static_cast<double>(scan_.num_pairs()) / static_cast<double>(pilots_.num_pairs());
    const core::Stopwatch watch;
    int level = kCoarsest;
    progress.update(0.0, kTrials);
    pilots_.error_of(level);
    for (; level > kFinest && !progress.should_stop(); --level) {
        const int next = level - 1;
        const int finest = pilots_.by_level().begin()->first;
        const double finest_seconds = pilots_.run(finest).all_seconds();
        const double growth =
            std::max(1.0, finest_seconds / pilots_.run(finest + kReferenceSteps).all_seconds());
        const double reference = std::pow(growth, 1.0 / kReferenceSteps) * finest_seconds;
        if (watch.seconds() + reference > *settings_.seconds) break;
        pilots_.error_of(next);
        const Pilot& pilot = pilots_.run(next);
        const double all = pilot.seconds * pilots_to_all + pilot.cut_seconds;
        if (watch.seconds() + all > *settings_.seconds) break;
    }
    stopped_ = progress.should_stop();
    return level;
}

// Where shadows are finer than elements, finer ones help little, and more rays to each of them
// much: 16 rays to elements of a given size find what one ray finds at a sixteenth of it.
int Integrator::coarsest_that_meets_target(const core::Progress& progress) {
    int level = kFirst;
    progress.update(0.0, kTrials);
    // Fine enough as a reference for the next finer level, too. A coarser one would miss shadows
    // that both leave out.
    pilots_.run(level - 1 - kReferenceSteps);
    bool may_be_coarser = true;
    while (pilots_.error_of(level) > target_) {
        if (progress.should_stop()) {
            stopped_ = true;
            return kCoarsest;
        }
        progress.update(0.0,
                        fmt::format("{}, {} elements", kTrials, pilots_.run(level).num_elements));
        if (pilots_.run(level).misses_shadows && pilots_.look_everywhere()) {
            may_be_coarser = true;
            continue;
        }
        if (level == kFinest) return level;
        --level;
        may_be_coarser = false;
    }
    if (!may_be_coarser) return level;
    const auto fewest = static_cast<double>(pilots_.fewest_elements());
    const auto can_be_coarser = [&] {
        return static_cast<double>(pilots_.run(level).num_elements) > kNearlyFewest * fewest;
    };
    while (level < kCoarsest && can_be_coarser() && pilots_.error_of(level + 1) <= target_) {
        ++level;
    }
    return level;
}

// The coarsest level of all when the caller asks to stop.
int Integrator::choose_level(const core::Progress& progress) {
    if (settings_.element_tolerance) {
        pilots_.estimate_norm(0);
        return 0;
    }
    pilots_.stop_when([&] { return progress.should_stop(); });
    int level = kCoarsest;
    try {
        level = settings_.seconds ? finest_in_time(progress) : coarsest_that_meets_target(progress);
    } catch (const PilotRuns::Stopped&) {
        stopped_ = true;
    }
    pilots_.stop_when({});
    return level;
}

// Integrates parts from `first_part` on; returns the first part that is left. Of a cut in several
// batches, no pair is complete before the last: what an interrupted one has added is dropped.
int Integrator::integrate(int level,
                          int first_part,
                          const core::Progress& progress,
                          ThirdBounce& result) {
    std::optional<ThirdBounceScan> scan;
    std::size_t num_elements = 0;
    double fraction_before = 0.0;
    bool is_whole_cut = true;
    int part = first_part;
    pilots_.for_each_batch(level, [&](const ElementSet& batch) {
        part = first_part;
        if (scan && progress.should_stop()) return false;
        if (!scan) scan.emplace(scene_, scan_, axis_, pilots_.rules(level));
        pilots_.allow_work(static_cast<double>(batch.num_elements) / batch.fraction,
                           scan_.num_pairs());
        num_elements += batch.num_elements;
        const auto go_on = [&](double fraction) {
            progress.update(fraction_before + fraction * batch.fraction,
                            fmt::format("{} elements", num_elements));
            return !progress.should_stop();
        };
        part = scan->integrate(batch, result.transient, first_part, go_on);
        fraction_before += batch.fraction;
        is_whole_cut = batch.fraction >= 1.0;
        return part == ThirdBounceScan::kParts;
    });
    if (!is_whole_cut && part < ThirdBounceScan::kParts) {
        std::ranges::fill(result.transient.values(), 0.0F);
        part = first_part;
    }
    result.num_elements = std::max(result.num_elements, num_elements);
    cost_ += scan->cost();
    result.element_tolerance = std::max(result.element_tolerance, pilots_.tolerance(level));
    if (settings_.element_tolerance) return part;
    const auto pilot = pilots_.by_level().find(level);
    const bool is_known = pilot != pilots_.by_level().end() && pilot->second.error;
    result.estimated_error = std::max(result.estimated_error.value_or(0.0),
                                      is_known ? *pilot->second.error : pilots_.error_of(level));
    return part;
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
        const std::optional<double> met = error_within_reach();
        if (!met || *met <= target_) throw;
        // Not the target itself, of which callers may give the third bounce a part.
        throw core::Failure(failure.what(),
                            fmt::format("a target error {:.2g} times as large would do",
                                        two_digits_above(*met / target_)));
    }
}

// The smallest error known after a failure. If there is none yet, that of a coarse level, which is
// known soon whatever the target.
std::optional<double> Integrator::error_within_reach() {
    if (const auto known = pilots_.smallest_error()) return known;
    try {
        PilotRuns coarse(
            scene_, scan_, axis_, std::max(target_, kSoonKnown), settings_.laser_spot_m2, limits_);
        return coarse.error_of(kCoarsest);
    } catch (const core::Failure&) {
        return std::nullopt;
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
    cost_ += pilots_.cost();
    result.num_rays = cost_.num_rays;
    result.tracing_seconds = cost_.seconds;
    const double wall = scene_.wall_albedo() / core::kPi;
    for (float& value : result.transient.values()) value = static_cast<float>(value * wall * wall);
    const double norm = core::squared_norm(result.transient.values());
    if (norm > 0.0) result.squared_error = std::pow(result.estimated_error.value_or(0.0), 2) * norm;
    return result;
}

}  // namespace

ThirdBounce integrate_third_bounce(const Scene& scene,
                                   const core::WallScan& scan,
                                   const core::TimeAxis& axis,
                                   const RenderSettings& settings,
                                   const core::Progress& progress,
                                   const CutLimits& limits) {
    const core::Stopwatch watch;
    ThirdBounce result;
    try {
        result = Integrator(scene, scan, axis, settings, limits).run(progress);
    } catch (const PilotRuns::TooMuchWork&) {
        result.is_too_much = true;
    }
    result.seconds = watch.seconds();
    return result;
}

}  // namespace renderer
