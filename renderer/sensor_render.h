// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/render_task.h"

namespace renderer {

/// Renders what a sensor's zones record: sums of what pairs of points record, one lit and one seen.
///
/// Points that flood light lights are paired with all that any zone sees, those of zones that light
/// their own spots with their own. What comes back to a lit point itself, from retroreflectors and
/// as the direct return, is weighed by the irradiance there, so that no size of a spot matters.
///
/// task      possible; `samples` counts per pair of points, and `direct_return` adds that of the
///           wall, in closed form
/// scan      that of the task, as core::scan_of_zones() gives it
/// returns   a histogram per zone: mean radiance that leaves what the zone sees, for 1 W of the
///           laser [W/(m^2 sr)] per bin, relative to a zone of mean solid angle; zones that see
///           nothing of the wall are given as not observed. The error is the largest of the parts
///           that are rendered, relative to them
/// throws    core::Error for walls that are meshes; what the estimator throws
RenderResult render_zones(const RenderTask& task, const core::SensorScan& scan);

}  // namespace renderer
