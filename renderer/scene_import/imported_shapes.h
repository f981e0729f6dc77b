// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene_import/scene_import.h"

#include <string>

namespace renderer {

/// A shape of a foreign scene and where it stands.
struct ForeignShape {
    std::string name;
    std::string type;      ///< rectangle, cube, disk, sphere, cylinder, obj, ply or stl
    std::string filename;  ///< of those, relative to the scene's file
    core::Transform to_world = core::Transform::Identity();
    Material material;
};

/// Adds a hidden object to the scene's geometry, or a line to what is not translated when the type
/// is not known.
///
/// path     of the scene's file
/// where    `file: key` of the shape, for messages
/// throws   core::Error when its mesh cannot be read or nothing of it has an area
void add_shape(const ForeignShape& shape,
               const std::string& path,
               const std::string& where,
               ImportedScene& scene);

/// Throws core::Error naming `where` when a relay wall is no rectangle.
void require_rectangle(const ForeignShape& shape, const std::string& where);

/// Makes a rectangle (x, y from -1 to 1) the relay wall, which is Lambertian here. Says in the list
/// when its material is not, and when columns of its points run against those of the foreign scene.
///
/// throws   core::Error naming `where` when it is no rectangle in the world
void set_relay_wall(const ForeignShape& shape, const std::string& where, ImportedScene& scene);

/// Says in the list that a laser has its own power there.
void note_laser_power(const std::string& key, ImportedScene& scene);

/// How a scene of mitransient limits bounces.
struct ForeignBounces {
    int filter = -1;     ///< the one number of bounces that it keeps; 0 or less: all
    int max_depth = -1;  ///< of its paths; negative: unlimited
    bool laser_sampling =
        false;  ///< then the lit spot does not count in max_depth, else the laser does
};

/// Sets how many bounces are rendered.
void set_bounces(const ForeignBounces& bounces, ImportedScene& scene);

}  // namespace renderer
