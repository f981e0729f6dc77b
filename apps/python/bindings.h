// SPDX-License-Identifier: MIT
#pragma once

#include "apps/python/arrays.h"
#include "apps/python/json_values.h"
#include "apps/python/long_call.h"
#include "apps/python/scene_object.h"

#include <nanobind/nanobind.h>

namespace python {

// What each file adds to the module.
void bind_scene(nanobind::module_& module);
void bind_capture(nanobind::module_& module);
void bind_reconstruction(nanobind::module_& module);
void bind_fit(nanobind::module_& module);
void bind_work(nanobind::module_& module);
void bind_dataset(nanobind::module_& module);
void bind_operators(nanobind::module_& module);
void bind_gradients(nanobind::module_& module);

/// Changes a scene by keys of scene.json.
void change_scene(SceneObject& scene, const core::Json& changes);

}  // namespace python
