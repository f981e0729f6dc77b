// SPDX-License-Identifier: MIT
#include "apps/python/scanned_scene.h"

#include "apps/python/bindings.h"

namespace python {
namespace {

namespace nb = nanobind;

// The description of a scan by its points, for provenance.
void describe_scan(const core::Scan& scan, renderer::ScanSettings& settings) {
    settings.pattern = scan.pattern;
    settings.sensing_points_m = scan.sensing.positions;
    settings.sensing_normals = scan.sensing.normals;
    const bool has_own_lights = scan.pattern != core::ScanPattern::Confocal;
    settings.illumination_points_m =
        has_own_lights ? scan.illumination.positions : std::vector<core::Vec3>();
    settings.illumination_normals =
        has_own_lights ? scan.illumination.normals : std::vector<core::Vec3>();
    settings.opl_origin = scan.opl_origin;
    if (scan.opl_origin == core::OplOrigin::Device) {
        settings.laser_m = scan.laser_position;
        settings.detector_m = scan.detector_position;
    }
}

}  // namespace

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
    if (!like->scan.camera) describe_scan(like->scan, scanned.scene.description.scan);
    if (axis.is_none()) scanned.scene.description.time_axis = {like->time_axis};
    return scanned;
}

}  // namespace python
