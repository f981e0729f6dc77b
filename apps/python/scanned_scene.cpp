// SPDX-License-Identifier: MIT
#include "apps/python/scanned_scene.h"

#include "apps/python/bindings.h"

namespace python {

namespace nb = nanobind;

ScannedScene scan_scene(const SceneObject& scene,
                        const nb::object& scan,
                        const nb::object& axis,
                        core::Json changes) {
    const core::Capture* like = nullptr;
    if (nb::isinstance<core::Capture>(scan)) {
        like = &nb::cast<core::Capture&>(scan);
    } else if (!scan.is_none()) {
        changes["scan"] = json_from_python(scan, "scan");
    }
    if (!axis.is_none()) changes["time_axis"] = json_from_python(axis, "axis");
    ScannedScene scanned{scene, {}};
    change_scene(scanned.scene, changes);
    if (like == nullptr) {
        scanned.scan = renderer::make_scan(scanned.scene.description);
        return scanned;
    }
    scanned.scan = like->scan;
    if (!like->scan.camera) renderer::describe_scan(like->scan, scanned.scene.description.scan);
    if (axis.is_none()) scanned.scene.description.time_axis = {like->time_axis};
    return scanned;
}

}  // namespace python
