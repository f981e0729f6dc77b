// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene_import/scene_import.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace scene_import_test {

/// Imports a scene from a text; a triangle stands beside it as shape.obj.
inline renderer::ImportedScene import_text(const std::string& name, const std::string& text) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("shape.obj"),
                                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    test_support::write_file_bytes(folder.file(name), text);
    return renderer::import_scene(folder.file(name));
}

/// True when a line of what is not translated contains `part`.
inline bool lists(const renderer::ImportedScene& scene, const std::string& part) {
    return std::any_of(
        scene.not_translated.begin(), scene.not_translated.end(), [&](const std::string& line) {
            return line.find(part) != std::string::npos;
        });
}

using Values = std::vector<std::pair<std::string, std::string>>;

/// A scene of mitransient in XML. `values` replace its parts @@target, where the laser aims, @@type
/// and @@place of the hidden shape, and add to @@root, @@integrator, @@shape, @@wall, @@sensor and
/// @@film.
inline std::string example_xml(Values values = {}) {
    std::string text = R"(<scene version="3.5.0">
  @@root
  <integrator type="transient_nlos_path">@@integrator</integrator>
  <emitter type="projector" id="laser">
    <transform name="to_world"><lookat origin="-0.5, 0, 0.25" target="@@target" up="0,1,0"/></transform>
    <rgb name="irradiance" value="1"/>
  </emitter>
  <shape type="@@type" id="hidden">
    @@shape
    <transform name="to_world">@@place</transform>
  </shape>
  <shape type="rectangle" id="wall">
    @@wall
    <sensor type="nlos_capture_meter">
      @@sensor
      <point name="sensor_origin" x="0.1" y="0.2" z="0.3"/>
      <film type="transient_hdr_film">
        <integer name="width" value="12"/><integer name="height" value="8"/>
        <integer name="temporal_bins" value="300"/>
        <float name="bin_width_opl" value="0.01"/><float name="start_opl" value="1.5"/>
        @@film
      </film>
    </sensor>
  </shape>
</scene>)";
    for (const auto& [name, usual] : {std::pair{"@@target", "0.25, -0.125, 0"},
                                      {"@@type", "rectangle"},
                                      {"@@place", "<translate z=\"1\"/>"},
                                      {"@@root", ""},
                                      {"@@integrator", ""},
                                      {"@@shape", ""},
                                      {"@@wall", ""},
                                      {"@@sensor", ""},
                                      {"@@film", ""}}) {
        values.emplace_back(name, usual);
    }
    for (const auto& [name, value] : values) {
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at)) {
            text.replace(at, name.size(), value);
            at += value.size();
        }
    }
    return text;
}

/// A scene of mitransient as its Python dictionary in JSON.
inline std::string example_json() {
    return R"({
      "type": "scene",
      "integrator": {"type": "transient_nlos_path", "capture_type": "Confocal", "max_depth": 4},
      "laser": {"type": "projector", "to_world": [[1,0,0,0.5],[0,1,0,0],[0,0,1,1],[0,0,0,1]]},
      "ball": {"type": "sphere", "center": [0, 0, 1], "radius": 0.25,
               "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.3, 0.3, 0.3]}}},
      "wall": {"type": "rectangle",
               "sensor": {"type": "nlos_capture_meter", "sensor_origin": [0, 0, 1],
                          "film": {"type": "transient_hdr_film", "width": 4, "height": 2,
                                   "temporal_bins": 10, "bin_width_opl": 0.1, "start_opl": 2}}}})";
}

/// A scene of y-tal as `tal render new` writes it, where most keys are comments.
inline std::string example_yaml() {
    return R"(
geometry:
- name: Z
  description: >
    Hidden geometry of the scene
  mesh:
    type: obj
    filename: ./shape.obj
  displacement_x: 0.5
  displacement_z: 1.0
  rot_degrees_z: 90.0
  scale_x: 2
  material:
    id: white
- name: relay_wall
  mesh:
    type: rectangle
  displacement_x: 0.0
  displacement_y: 0.1
  scale_x: 1
  scale_y: 0.5
  scale_z: 1
  material:
    id: white
relay_wall: relay_wall
)";
}

}  // namespace scene_import_test
