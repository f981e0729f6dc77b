// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"

#include "renderer/core/output_file.h"
#include "renderer/gltf/gltf.h"

namespace scenes {

std::vector<GeneratedScene> generated_scenes() {
    return {make_letter(),
            make_animal(),
            make_bars(),
            make_corner(),
            make_glossy(),
            make_curved(),
            make_box_room(),
            make_diffuse_room(),
            make_relief_room(),
            make_traffic()};
}

void write_scene(const GeneratedScene& scene, const std::string& folder) {
    const std::string target = folder + "/" + scene.name;
    renderer::write_gltf(target + "/scene.glb", scene.geometry);
    if (!scene.description.empty()) {
        core::write_text_file(target + "/scene.json", scene.description);
    }
}

}  // namespace scenes
