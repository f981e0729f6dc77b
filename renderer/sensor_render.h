// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/progress.h"
#include "renderer/render_result.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/render_settings.h"

#include <functional>

namespace renderer {

/// Renders wall points as render() does.
using PointRenderer = std::function<RenderResult(
    const Scene&, const core::Scan&, const RenderSettings&, const core::Progress&)>;

/// Renders what a sensor's zones record: sums of what pairs of points record, one lit and one seen.
///
/// Points that flood light lights are paired with all that any zone sees, those of zones that light
/// their own spots with their own. What comes back to a lit point itself, from retroreflectors and
/// as the direct return, is weighed by the irradiance there, so that no size of a spot matters.
///
/// scan            as core::scan_of_zones() gives it
/// settings        `samples` counts per pair of points; the error that is stated is the largest of
///                 the parts that are rendered, relative to them; `direct_return` adds that of the
///                 wall, in closed form
/// render_points   renders scans of points
/// returns         a histogram per zone: mean radiance that leaves what the zone sees, for 1 W of
///                 the laser [W/(m^2 sr)] per bin, relative to a zone of mean solid angle; zones
///                 that see nothing of the wall are stated as not observed. scene_info holds the
///                 set-up, key `sensor`
/// throws          core::Error for restir, velocities and walls that are meshes; what
///                 `render_points` throws
RenderResult render_zones(const Scene& scene,
                          const core::SensorScan& scan,
                          const core::HistogramAxes& axes,
                          const RenderSettings& settings,
                          const PointRenderer& render_points,
                          const core::Progress& progress);

}  // namespace renderer
