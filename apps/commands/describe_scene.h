// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace apps {

/// Prints what the objects of a glTF or mesh file are to the renderer. Throws core::Error as
/// renderer::load_geometry().
void describe_geometry(const std::string& path);

/// Prints a scene's objects, its scan, where its light lies on the time axis, and the settings that
/// differ from the defaults. Throws core::Error when the scene cannot be rendered.
void describe_scene(const std::string& path);

}  // namespace apps
