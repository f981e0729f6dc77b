// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/scene_geometry.h"

#include <string>
#include <vector>

namespace scenes {

/// A scene of this folder. Adding one: a function here, a .cpp, a line in generated_scenes().
struct GeneratedScene {
    std::string name;  ///< of its folder
    renderer::SceneGeometry geometry;
    std::string description;  ///< text of scene.json; empty when that is written by hand

    /// Adds what place() makes of these (shapes.h).
    renderer::Object& add(const std::string& object_name,
                          core::TriangleMesh mesh,
                          const core::Vec3& origin,
                          const renderer::Material& material);
};

GeneratedScene make_letter();        ///< a flat F
GeneratedScene make_animal();        ///< a smooth closed surface
GeneratedScene make_bars();          ///< a smooth closed surface behind bars
GeneratedScene make_corner();        ///< the corner of a room with two objects
GeneratedScene make_glossy();        ///< two GGX surfaces and a retroreflective plate
GeneratedScene make_curved();        ///< a torus in front of a curved relay wall
GeneratedScene make_box_room();      ///< a room with a mirror-like ball and a glossy block
GeneratedScene make_diffuse_room();  ///< the same room, all diffuse, with a wavy ball
GeneratedScene make_relief_room();   ///< a room, one half of it in fine wavy meshes
GeneratedScene make_traffic();       ///< a road with three things that move
GeneratedScene make_visitor();       ///< somebody in a reflective vest who walks by

std::vector<GeneratedScene> generated_scenes();

/// Writes scene.glb, and scene.json where it is generated, to `folder`/name, which must exist.
void write_scene(const GeneratedScene& scene, const std::string& folder);

}  // namespace scenes
