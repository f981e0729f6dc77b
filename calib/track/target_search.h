// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/joint_update.h"
#include "calib/track/target_response.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace calib {

/// A box in the wall's frame in which targets are looked for.
struct SearchBox {
    core::Transform world_from_wall = core::Transform::Identity();
    std::array<std::array<double, 2>, 3> ranges_m{};  ///< along x, y and z of the wall

    bool holds(const core::Vec3& position_m) const;
};

/// Where a target may be that a frame shows, and how strong.
struct Candidate {
    core::Vec3 position_m;
    double strength = 0.0;
    double score = 0.0;  ///< logarithm of the likelihood ratio, to second order in the strength
};

/// Histograms of targets on a grid, to find those that a frame shows.
class TargetSearch {
 public:
    /// make_response   of a given sigma beside the response's own, so that no target falls between
    ///                 two cells; see TargetResponse
    TargetSearch(const TargetResponse& response, const SearchBox& box, double cell_m);

    /// The best cells that are better than the cells around them, best first.
    ///
    /// offset_m   by which sensor and box moved along the wall since the grid was made
    std::vector<Candidate> find(const FrameCounts& frame,
                                std::size_t most,
                                const core::Vec3& offset_m) const;

 private:
    struct Run {
        std::uint32_t first = 0;  ///< index of the first bin in [zone][bin]
        std::uint32_t size = 0;
        std::uint32_t at = 0;  ///< in values_
    };
    /// A histogram of one cell: the bins that are not 0.
    struct Cell {
        std::vector<Run> runs;
        std::vector<float> values;

        void add(std::span<const double> zone,
                 std::size_t first,
                 const TargetResponse::Window& window);
    };
    struct Score {
        float value = 0.0F;  ///< see Candidate; 0 where a target explains nothing
        float strength = 0.0F;
    };
    void lay_grid(const SearchBox& box, double cell_m);
    void append(const Cell& cell);
    std::vector<Score> score(const FrameCounts& frame) const;
    bool is_peak(const std::vector<Score>& scores, const std::array<int, 3>& cell) const;
    std::size_t index(const std::array<int, 3>& cell) const;

    std::array<int, 3> cells_{};
    std::vector<core::Vec3> positions_;
    std::vector<std::uint32_t> first_run_;  ///< of each cell; one more at the end
    std::vector<Run> runs_;
    std::vector<float> values_;
};

}  // namespace calib
