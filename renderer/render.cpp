// SPDX-License-Identifier: MIT
#include "renderer/render.h"

#include "renderer/estimators.h"
#include "renderer/recentred.h"
#include "renderer/sensor_render.h"

namespace renderer {
namespace {

RenderResult render_here(const RenderTask& task) {
    const auto* zones = task.scan.as<core::SensorScan>();
    return zones != nullptr ? render_zones(task, *zones)
                            : method_of(task.settings.method).run(task);
}

}  // namespace

RenderResult render(const Scene& scene,
                    const core::Scan& scan,
                    const core::HistogramAxes& axes,
                    const RenderSettings& settings,
                    const core::Progress& progress) {
    const RenderTask task{scene, scan, axes, settings, progress};
    require_possible(task);
    const auto way = way_to_origin(scene.rays().origin(), scene.rays().half_size_m());
    if (!way) return render_here(task);
    const core::Scan moved_scan = core::moved(scan, *way);
    RenderResult result =
        render_here({scene.moved(*way, moved_scan), moved_scan, axes, settings, progress});
    result.capture.scan = scan;
    return result;
}

}  // namespace renderer
