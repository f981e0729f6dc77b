// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <string>

namespace renderer {

/// Reads a Mitsuba scene in XML as the nested dictionary that it stands for: plugins become objects
/// with their `type`, and perhaps `id`; transforms become 4 x 4 matrices by rows, colours objects
/// of type rgb or spectrum, references objects of type ref. Defaults ($name) are put in.
///
/// throws   core::Error for damaged files and values, and for document types (entities)
core::Json read_mitsuba_xml(const std::string& path);

/// The same from a text, the part `where` of a file.
core::Json parse_mitsuba_xml(const std::string& text,
                             const std::string& path,
                             const std::string& where);

/// Reads the first document of a YAML file, with plain scalars as YAML 1.1 has them.
/// throws   core::Error for damaged files, and for what expands or nests beyond any scene
core::Json read_yaml(const std::string& path);

}  // namespace renderer
