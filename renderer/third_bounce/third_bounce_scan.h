// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/film/pair_tiles.h"
#include "renderer/third_bounce/third_bounce_visibility.h"
#include "renderer/third_bounce/visibility_check.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace renderer {

/// How one cut of the surfaces is integrated.
struct ScanRules {
    double negligible_error = 0.0;  ///< as in VisibilityRules
    /// That masks of a single or exhaustive scan may take; where those of all points do not fit,
    /// visibility from some points is traced more than once.
    double memory_bytes = 0.0;
    ShadowRayPlan plan = ShadowRayPlan::WhereNeighboursDisagree;
    std::size_t check_rays = 0;  ///< per pair and cut, see VisibilityCheck; 0: none
};

/// Integrates one cut of the surfaces, in one or several batches, for all pairs of a scan.
class ThirdBounceScan {
 public:
    /// All references must outlive this.
    ThirdBounceScan(const Scene& scene,
                    const core::WallScan& scan,
                    const core::TimeAxis& axis,
                    const ScanRules& rules);

    /// The pairs are integrated in this many parts, the last of which may be empty.
    static constexpr int kParts = 16;

    /// Adds H by way of the elements of the next batch, for wall albedos of pi, to the pairs of
    /// parts [first_part, kParts) of `result`.
    ///
    /// batch     must outlive this or the next call
    /// go_on     called from the calling thread with the fraction done after every part; false
    ///           stops
    /// returns   the number of the first part not integrated; kParts: none is left
    /// throws    core::Failure when masks of PairTiles::kMinPoints points take too much memory
    int integrate(
        const ElementSet& batch,
        core::Transient& result,
        int first_part = 0,
        const std::function<bool(double fraction)>& go_on = [](double) { return true; });

    TracingCost cost() const { return {num_rays_, tracing_seconds_}; }
    /// Expected squared error of all of H from shadow edges that elements are too coarse for.
    double squared_shadow_error() const;
    /// Squared error of all of H from what is taken for visible, as checks have found.
    SquaredError squared_visibility_error() const;

 private:
    /// The illumination or the sensing points of the scan.
    struct Side {
        const core::WallPoints& points;
        std::vector<bool> is_confocal;       ///< see CoincidingPoints
        std::vector<double> squared_errors;  ///< of all pairs of each point
        PointRange range{};                  ///< of the points in `seen`
        std::vector<VisibleElements> seen{};

        WallPoint wall_point(std::size_t index, const core::Vec3& origin) const;
        std::vector<WallPoint> wall_points(const PointRange& of, const core::Vec3& origin) const;
    };

    core::TimeAxis axis_of_pair(std::size_t pair) const;
    void integrate_confocal(std::size_t begin, std::size_t end);
    int integrate_pairs(int first_part, const std::function<bool(double fraction)>& go_on);
    VisibilityRules rules_towards(const Side& others, std::size_t num_points) const;
    void look_from(Side& side, const PointRange& range, const VisibilityRules& rules);
    void integrate_tile(const PairTiles::Tile& tile);
    void check(VisibilityCheck& check,
               std::size_t pair,
               const VisibilityCheck::End& light,
               const VisibilityCheck::End& sensor);
    void add_costs(const VisibilityTracer& tracer);
    void store(std::size_t pair, std::span<const double> histogram);

    const Scene& scene_;
    const core::WallScan& scan_;
    const core::TimeAxis& axis_;
    ScanRules rules_;
    const ElementSet* elements_ = nullptr;  ///< the batch
    core::Transient* result_ = nullptr;     ///< while integrate() runs
    Side lights_;
    Side sensors_;
    double squared_shadow_error_of_others_ = 0.0;       ///< of the batches before
    std::vector<VisibilityDifferences> differences_{};  ///< per pair, where checks are asked for
    std::atomic<std::uint64_t> num_rays_{0};
    std::atomic<double> tracing_seconds_{0.0};
};

}  // namespace renderer
