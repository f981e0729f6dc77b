// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"

#include "renderer/core/system/output_file.h"
#include "renderer/gltf/gltf.h"

#include "scenes/shapes.h"

namespace scenes {

renderer::Object& GeneratedScene::add(const std::string& object_name,
                                      core::TriangleMesh mesh,
                                      const core::Vec3& origin,
                                      const renderer::Material& material) {
    geometry.objects.push_back(place(object_name, std::move(mesh), origin, material));
    return geometry.objects.back();
}

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
            make_traffic(),
            make_visitor()};
}

void write_scene(const GeneratedScene& scene, const std::string& folder) {
    const std::string target = folder + "/" + scene.name;
    renderer::write_gltf(target + "/scene.glb", scene.geometry);
    if (!scene.description.empty()) {
        core::write_text_file(target + "/scene.json", scene.description);
    }
}

}  // namespace scenes
