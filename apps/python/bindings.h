// SPDX-License-Identifier: MIT
#pragma once

#include "apps/python/arrays.h"
#include "apps/python/json_values.h"
#include "apps/python/long_call.h"
#include "calib/fit.h"
#include "nlos/pictures/picture.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/material/scene_geometry.h"
#include "renderer/scene/scene_file.h"

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

namespace python {

/// What Python calls a Scene: a description and the geometry that it is about.
struct SceneObject {
    std::string name;
    renderer::SceneDescription description;  ///< valid
    renderer::SceneGeometry geometry;        ///< with the description's objects applied
};

/// A scene and the points from which it is measured.
struct ScannedScene {
    SceneObject scene;
    core::Scan scan;
};

/// What Python calls a FitResult: a fit and what it was of.
struct FitObject {
    calib::FitInput input;
    calib::FitResult result;
};

/// What __init__ does to make an object as a function does.
template <class T, class... Arguments>
auto constructor(T (*make)(Arguments...)) {
    return [make](T* self, Arguments... arguments) { new (self) T(make(arguments...)); };
}

/// Adds picture(format), in PNG, SVG or PDF, and the picture that notebooks show.
///
/// panels_of   what is drawn, `columns` to a row
template <class T>
void bind_pictures(nanobind::class_<T>& binding,
                   std::vector<nlos::Panel> (*panels_of)(const T&),
                   int columns,
                   const char* meaning) {
    const auto picture = [=](const T& self, const std::string& format) {
        const std::string bytes = nlos::encode_panels(
            panels_of(self), columns, nlos::picture_format("picture." + format));
        return nanobind::bytes(bytes.data(), bytes.size());
    };
    binding.def("picture", picture, nanobind::arg("format") = "png", meaning)
        .def("_repr_png_", [picture](const T& self) { return picture(self, "png"); });
}

// What each file adds to the module.
void bind_scene(nanobind::module_& module);
void bind_capture(nanobind::module_& module);
void bind_reconstruction(nanobind::module_& module);
void bind_fit(nanobind::module_& module);
void bind_work(nanobind::module_& module);
void bind_operators(nanobind::module_& module);
void bind_gradients(nanobind::module_& module);

/// Changes a scene by keys of scene.json.
void change_scene(SceneObject& scene, const core::Json& changes);

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
