// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/scene/scene.h"
#include "renderer/third_bounce/surface_subdivider.h"
#include "renderer/third_bounce/third_bounce_scan.h"

#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <utility>

namespace renderer {

/// The pairs on which the deterministic integrator finds the refinement level it needs: some points
/// of each side, spread evenly but not in step with the rows of a grid, or all where these are at
/// most twice as many; more of them for few bins, where there is less to compare per pair. Where
/// there are retroreflectors and the scan has confocal pairs, one of these is among them, since its
/// light outshines everything else.
core::WallScan pilot_scan_for(const Scene& scene, const core::WallScan& scan, int num_bins);
/// The same with a number of points on each side.
core::WallScan pilot_scan(const Scene& scene, const core::WallScan& scan, std::size_t num_points);

/// The axis of pilot runs: bins begin at multiples of their width, so that shifting the axis by
/// part of a bin changes neither the level chosen nor the energy. Axes with few bins are kept as
/// they are.
core::TimeAxis pilot_axis(const core::TimeAxis& axis);

/// A run on a few pairs at one refinement level.
struct Pilot {
    core::Transient transient;
    std::size_t num_elements = 0;
    double shadow_error = 0.0;    ///< expected, absolute
    double missed_error = 0.0;    ///< as found by VisibilityCheck beyond its noise, absolute
    std::optional<double> error;  ///< relative, once compared with a reference
    bool misses_shadows = false;  ///< finer than the elements, once compared with a reference
    double cut_seconds = 0.0;     ///< for cutting the surfaces
    double seconds = 0.0;         ///< for integrating

    double all_seconds() const { return seconds + cut_seconds; }
};

/// Tells how wrong third bounces are at refinement levels; level k has the tolerance target * 2^k.
///
/// The error of a level is the larger one of two estimates, with some caution. One is the
/// difference from a much finer cut, and what shadow edges leave uncertain in both. The other comes
/// from rays to random points (VisibilityCheck): it holds for shadows that both cuts miss, such as
/// those of combs and dots finer than the elements, but knows nothing of errors that are not of
/// visibility. Its price are 130,000 rays per pilot run at a target of 1 % or above, and more in
/// proportion below.
/// Where it finds clearly more than the cuts do, every element gets 16 rays from then on, instead
/// of those that neighbours ask for.
class PilotRuns {
 public:
    static constexpr int kCoarsest = 5;
    static constexpr int kFinest = -10;
    static constexpr int kReferenceSteps = 2;  ///< by how much a reference is finer, if it can be

    /// scene, scan   must outlive the runs
    /// target        relative L2 error over all of H
    PilotRuns(const Scene& scene,
              const core::WallScan& scan,
              const core::TimeAxis& axis,
              double target,
              double laser_spot_m2,
              const CutLimits& limits = {});

    /// Calls work(batch) for all batches of a cut while it returns true.
    void for_each_batch(int level, const std::function<bool(const ElementSet& batch)>& work);
    /// cut() makes at least this many elements at any level.
    std::size_t fewest_elements() const { return subdivider_.min_elements(tolerance(kCoarsest)); }
    /// How all of the scan is integrated at a level.
    ScanRules rules(int level) const;

    /// From now on, runs in several batches ask this between two of them whether to throw Stopped;
    /// what other runs found stays.
    struct Stopped {};
    void stop_when(std::function<bool()> should_stop) { should_stop_ = std::move(should_stop); }

    /// Beyond the limit of work that all runs together may cost, this is thrown.
    struct TooMuchWork {};
    /// Throws it unless so many elements may still be integrated for each of so many pairs.
    void allow_work(double num_elements, std::size_t num_pairs) const;

    /// Estimates how much light a pair has, at a level, for rules(); cheaper than run().
    void estimate_norm(int level);

    const Pilot& run(int level);
    /// Estimates the error of a level against the finest run so far. Where one kReferenceSteps
    /// finer would have too many elements, the next finer level serves, with more caution.
    double error_of(int level);
    /// All runs so far are forgotten, and the next ones send rays to all parts of all elements.
    /// Returns false when they did so already.
    bool look_everywhere();

    double tolerance(int level) const;
    const std::map<int, Pilot>& by_level() const { return pilots_; }
    std::size_t num_pairs() const { return pilot_scan_.num_pairs(); }
    /// Of the levels whose error is known, nothing where none is.
    std::optional<double> smallest_error() const;
    const TracingCost& cost() const { return cost_; }

 private:
    std::size_t check_rays_per_pair() const;
    int run_reference(int level);

    const Scene& scene_;
    core::WallScan pilot_scan_;
    core::TimeAxis pilot_axis_;
    double target_;
    double most_work_s_;
    double integrated_ = 0.0;  ///< elements times pairs
    SurfaceSubdivider subdivider_;
    std::deque<std::pair<int, ElementSet>> cuts_;  ///< the latest that are one batch
    double norm_per_pair_ = 0.0;
    ShadowRayPlan plan_ = ShadowRayPlan::WhereNeighboursDisagree;
    std::map<int, Pilot> pilots_;  ///< by level, all with this plan
    std::optional<int> too_fine_;  ///< a level that has too many elements
    std::function<bool()> should_stop_;
    TracingCost cost_;
};

}  // namespace renderer
