// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"
#include "renderer/core/types.h"
#include "renderer/material/material.h"

#include <array>
#include <string>
#include <vector>

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

// The steps of Mitsuba's transforms, as 4 x 4 matrices that act on columns.
Eigen::Matrix4d translation(const std::array<double, 3>& offset);
Eigen::Matrix4d scaling(const std::array<double, 3>& factors);
/// Right-handed, in degrees; the identity about an axis of length 0.
Eigen::Matrix4d rotation(const std::array<double, 3>& axis, double degrees);
/// +z looks from the origin to the target, y leans towards `up`.
Eigen::Matrix4d look_at(const core::Vec3& origin, const core::Vec3& target, const core::Vec3& up);

/// A matrix from its 16 numbers, or the 9 of a linear map, by rows.
/// throws   core::Error naming `where` for another count
Eigen::Matrix4d matrix_of(const std::vector<double>& values, const std::string& where);

/// Matrices as lists of rows.
core::Json to_json(const Eigen::Matrix4d& matrix);

/// Reads a matrix from lists of rows or one list of 16 numbers; it has to be affine and finite.
/// throws   core::Error naming `where`
core::Transform read_transform(const core::Json& json, const std::string& where);

/// Numbers separated by commas or blanks. Throws std::invalid_argument for anything else.
std::vector<double> numbers_in(const std::string& text);

/// True for a plugin that is a BSDF, by its type.
bool is_bsdf(const core::Json& plugin);

/// True for a BSDF, and for a reference unless it names something else of the scene.
bool leads_to_bsdf(const core::Json& plugin, const core::Json& scene);

/// The material that a BSDF of Mitsuba stands for.
///
/// bsdf             an object with a known type, or a reference to one of `scene`
/// scene            the whole scene, in which references are looked up
/// where            file and key, for messages
/// not_translated   gets a line for what is left out or taken as something else
Material mitsuba_material(const core::Json& bsdf,
                          const core::Json& scene,
                          const std::string& where,
                          std::vector<std::string>& not_translated);

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
