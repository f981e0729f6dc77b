// SPDX-License-Identifier: MIT
#pragma once

#include "apps/python/scene_object.h"
#include "renderer/core/capture.h"

#include <nanobind/nanobind.h>

namespace python {

/// A scene and the points from which it is measured.
struct ScannedScene {
    SceneObject scene;
    core::Scan scan;
};

/// A scene with changes, and the scan and bins that arguments ask for.
///
/// scan      keys of scene.json's `scan`; a Capture: its points and bins; None: the scene's
/// axis      keys of scene.json's `time_axis`, or auto; None: the scan's, or the scene's
/// changes   keys of scene.json
/// throws    core::Error naming the argument
ScannedScene scan_scene(const SceneObject& scene,
                        const nanobind::object& scan,
                        const nanobind::object& axis,
                        core::Json changes);

}  // namespace python
