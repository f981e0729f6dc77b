// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <string>

namespace renderer {

struct ImportedScene;

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

/// Translates Mitsuba's dictionary of a scene that mitransient renders: a rectangle with the sensor
/// nlos_capture_meter, a laser, shapes and the integrator transient_nlos_path.
///
/// scene    the dictionary, its `type` is scene
/// path     of its file, from which meshes are found
/// throws   core::Error naming file and key
/// source   [Royo2022], [Jakob2022]
ImportedScene import_mitsuba(const core::Json& scene, const std::string& path);

/// Translates a scene of y-tal, as `tal render new` writes it: keys that are left out have the
/// values that y-tal gives them.
///
/// config   the YAML's content
/// path     of its file, from which meshes are found
/// throws   core::Error naming file and key
/// source   [Royo2022]
ImportedScene import_ytal(const core::Json& config, const std::string& path);

}  // namespace renderer
