// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace renderer {

/// Where the light of a scene lies on the axis of optical path length.
struct LightRange {
    /// Shortest and longest path [m]: of scans the third bounces that geometry allows, shadows and
    /// orientation neglected; of images what the pilot run found.
    std::array<double, 2> possible_m{0.0, 0.0};

    /// Light of all orders that are rendered, by path length: a pilot run of path tracing on some
    /// pairs. Its axis begins before the shortest path.
    core::TimeAxis axis;
    std::vector<double> light;

    bool is_dark() const;
    /// Path lengths between which all but `tail` of the light lies on either side [m].
    std::array<double, 2> without_tails(double tail) const;
    /// The fraction of the light between two path lengths [m]; 0 in the dark.
    double fraction_between(double begin_m, double end_m) const;
};

/// The number of a pair of a scan, the i-th of `count` that are spread over all of it, out of step
/// with the rows of a grid; all of them where there are no more.
std::size_t spread_pair(std::size_t i, std::size_t count, std::size_t all);

/// Finds the range in a few hundredths of a second.
///
/// returns   nothing when no order is rendered that has a vertex to sample
/// throws    core::Error as the method `path` does
std::optional<LightRange> find_light_range(const Scene& scene,
                                           const core::Scan& scan,
                                           const RenderSettings& settings);

/// Whether so little of a scan's light, less than 15 %, lies within an axis without velocities that
/// paths had better be made to fit it: walks waste what is outside, connections take several times
/// as long (renderer/RESULTS.md, gates).
bool is_narrow(const Scene& scene,
               const core::Scan& scan,
               const core::HistogramAxes& axes,
               const RenderSettings& settings);

/// The axis that `"time_axis": "auto"` asks for: all path lengths that are possible, in bins half
/// as fine as lets the farthest points of the scan tell apart what is a pitch away from each other
/// along the wall (source [OToole2018], resolution limits), but about 64 to 4096 of them. Were it
/// more, the last bins go, down to 99.9 % of the light, before bins grow wider.
///
/// What the description gives of an automatic axis stays as it is, and bins are fine enough for its
/// detector.
///
/// range    of this scene, scan and description, before anything moves
/// throws   core::Error when no light reaches the scan
core::TimeAxis choose_time_axis(const std::optional<LightRange>& range,
                                const Scene& scene,
                                const core::Scan& scan,
                                const SceneDescription& description);

/// What to tell about an axis that misses all light, or most of it; for sequences, the axes of all
/// frames together. Empty when there is nothing to tell.
std::vector<std::string> axis_warnings(const LightRange& range,
                                       const core::TimeAxis& axis,
                                       const std::optional<FrameSettings>& frames);

}  // namespace renderer
