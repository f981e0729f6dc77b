// SPDX-License-Identifier: MIT
#include "renderer/render.h"

#include "renderer/estimators.h"
#include "renderer/sensor_render.h"

namespace renderer {

RenderResult render(const Scene& scene,
                    const core::Scan& scan,
                    const core::HistogramAxes& axes,
                    const RenderSettings& settings,
                    const core::Progress& progress) {
    const RenderTask task{scene, scan, axes, settings, progress};
    require_possible(task);
    const auto* zones = scan.as<core::SensorScan>();
    return zones != nullptr ? render_zones(task, *zones) : method_of(settings.method).run(task);
}

}  // namespace renderer
