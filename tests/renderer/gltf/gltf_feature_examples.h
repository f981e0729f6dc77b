// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/gltf/gltf_features.h"
#include "tests/renderer/gltf/gltf_files.h"

#include <functional>
#include <vector>

namespace gltf_test {

/// What a scene looks like: its area, its middle, and its mean albedo by vertices.
struct Look {
    double area_m2 = 1.0;
    core::Vec3 center{0.5, 0.5, 0.0};
    double albedo = 1.0;
};

/// A feature of glTF in a file that uses it.
struct Example {
    const char* feature;
    renderer::GltfHandling handling;
    std::function<void(GltfFile&)> use;  ///< adds it to a file that shows the unit square
    Look look{};                         ///< what is seen of it
    const char* says = "";               ///< of one that is refused or named
};

/// Of features that change where surfaces are, and of those that change what they reflect.
std::vector<Example> geometry_examples();
std::vector<Example> reflectance_examples();

}  // namespace gltf_test
