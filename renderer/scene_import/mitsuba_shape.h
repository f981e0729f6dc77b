// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene_import/imported_shapes.h"
#include "renderer/scene_import/key_reader.h"

#include <string>

namespace renderer {

/// True for a plugin that is a shape, by its type.
bool is_mitsuba_shape(const core::Json& plugin);

/// Takes type, file and place of a shape out of its keys; its material stays to be read.
///
/// key      names it when it has no id
/// throws   core::Error for values that make no sense
ForeignShape mitsuba_shape(KeyReader& keys, const std::string& key);

}  // namespace renderer
