// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/film/pair_tiles.h"
#include "renderer/third_bounce/third_bounce_visibility.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace renderer {

/// Integrates one cut of the surfaces for all pairs of a scan.
class ThirdBounceScan {
 public:
    /// All references must outlive this.
    ///
    /// negligible_error   as in VisibilityRules
    /// memory_bytes       that masks of a single or exhaustive scan may take; where those of all
    ///                    points do not fit, visibility from some points is traced more than once
    /// throws             core::Failure when those of PairTiles::kMinPoints points do not fit
    ThirdBounceScan(const Scene& scene,
                    const core::Scan& scan,
                    const core::TimeAxis& axis,
                    const ElementSet& elements,
                    double negligible_error,
                    double memory_bytes);

    /// The pairs are integrated in this many parts, the last of which may be empty.
    static constexpr int kParts = 16;

    /// Fills the pairs of parts [first_part, kParts) of `result` with H for wall albedos of pi.
    ///
    /// go_on     called from the calling thread with the share done after every part; false stops
    /// returns   the number of the first part not integrated; kParts: none is left
    int integrate(int first_part,
                  const std::function<bool(double share)>& go_on,
                  core::Transient& result);

    TracingCost cost() const { return {num_rays_, tracing_seconds_}; }
    /// Expected squared error of all of H from shadow edges that elements are too coarse for.
    double squared_shadow_error() const;

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
    int integrate_pairs(int first_part, const std::function<bool(double share)>& go_on);
    VisibilityRules rules_towards(const Side& others, std::size_t num_points) const;
    void look_from(Side& side, const PointRange& range, const VisibilityRules& rules);
    void integrate_tile(const PairTiles::Tile& tile);
    void add_costs(const VisibilityTracer& tracer);
    void store(std::size_t pair, std::span<const double> histogram);

    const Scene& scene_;
    const core::Scan& scan_;
    const core::TimeAxis& axis_;
    const ElementSet& elements_;
    double negligible_error_;
    double memory_bytes_;
    core::Transient* result_ = nullptr;  ///< while integrate() runs
    Side lights_;
    Side sensors_;
    std::atomic<std::uint64_t> num_rays_{0};
    std::atomic<double> tracing_seconds_{0.0};
};

}  // namespace renderer
