// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/wall_frame.h"
#include "nlos/reconstruction/volume.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/error.h"
#include "renderer/core/progress.h"
#include "renderer/core/stopwatch.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <vector>

namespace nlos {

/// What histograms hold beside the light of the scene, for methods that explain it.
struct Measurement {
    bool is_counts = false;                  ///< photons, of which none were taken off
    std::vector<double> background_per_bin;  ///< per pair; empty: none
    core::ResponseFilter response;           ///< on the histograms' bins; no weights: none

    double background(std::size_t pair) const {
        return background_per_bin.empty() ? 0.0 : background_per_bin[pair];
    }
};

/// What every reconstruction method gets: measurements, where they were taken, what to fill.
struct MethodInput {
    const core::WallScan& scan;
    const core::TimeAxis& time_axis;
    const core::Transient& transient;  ///< (num_pairs, num_bins)
    const WallFrame& wall;
    const VolumeAxes& axes;
    std::array<double, 2> z_range_m;  ///< the voxels along z divide it evenly
    const core::Progress& progress;
    /// Per pair; null: all bins were observed. Histograms hold 0 in all others, which methods that
    /// work by transforms take for darkness.
    const std::vector<core::BinRange>* observed = nullptr;
    double unobserved_before_m = 0.0;  ///< path length cut off before the axis: nobody looked there
    Measurement measurement = {};      ///< what the method explains of it itself
    /// Path length from which on every bin of every pair is 0; infinite: not known.
    double dark_from_m = std::numeric_limits<double>::infinity();
};

/// Fewest bins from which frequency-domain methods make sense.
inline constexpr int kMinBins = 8;

/// Whether a method for confocal grids can serve: an even planar grid with a voxel column at each
/// of its points, and enough bins.
inline bool is_confocal_grid(const MethodInput& input) {
    return input.scan.pattern == core::ScanPattern::Confocal && input.wall.grid &&
           input.axes.x_m.size() == input.wall.grid->size[0] &&
           input.axes.y_m.size() == input.wall.grid->size[1] &&
           input.time_axis.num_bins >= kMinBins;
}

/// Where wall points are in the frame of the voxels [m].
inline std::vector<core::Vec3> in_wall_frame(const MethodInput& input,
                                             const core::WallPoints& points) {
    const core::Transform wall_from_world = input.axes.world_from_wall.inverse(Eigen::Isometry);
    std::vector<core::Vec3> positions;
    positions.reserve(points.size());
    for (const core::Vec3& position : points.positions) {
        positions.push_back(wall_from_world * position);
    }
    return positions;
}

/// The same measurement with other histograms, all of them observed.
inline MethodInput with_histograms(const MethodInput& input,
                                   const core::TimeAxis& axis,
                                   const core::Transient& transient,
                                   const core::Progress& progress) {
    return {input.scan, axis, transient, input.wall, input.axes, input.z_range_m, progress};
}

/// Ends the work with core::Failure when the caller asked for it.
inline void check_stop(const core::Progress& progress) {
    if (progress.should_stop()) throw core::Failure("reconstruct", "interrupted");
}

/// A part of a method's work in the fractions it reports.
struct ProgressSpan {
    const core::Progress& progress;
    double begin = 0.0;
    double end = 1.0;
    const char* detail = "";
};

/// Calls `body(begin, end)` for blocks of [0, count) in parallel, reporting and listening a few
/// times per second in between. The blocks depend on `count` and `block` only.
inline void parallel_blocks_with_progress(
    std::size_t count,
    std::size_t block,
    const ProgressSpan& span,
    const std::function<void(std::size_t begin, std::size_t end)>& body) {
    constexpr double kStageSeconds = 0.2;
    std::size_t stage = block * static_cast<std::size_t>(core::thread_count());
    for (std::size_t done = 0; done < count;) {
        check_stop(span.progress);
        const core::Stopwatch watch;
        const std::size_t size = std::min(stage, count - done);
        core::parallel_blocks(size, block, [&](std::size_t begin, std::size_t end) {
            body(done + begin, done + end);
        });
        if (watch.seconds() < kStageSeconds) stage *= 2;
        done += size;
        const double fraction = static_cast<double>(done) / static_cast<double>(count);
        span.progress.update(span.begin + fraction * (span.end - span.begin), span.detail);
    }
}

}  // namespace nlos
