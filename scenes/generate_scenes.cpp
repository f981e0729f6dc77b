// SPDX-License-Identifier: MIT
// Writes the geometry of every scene: generate_scenes FOLDER, where FOLDER is this one.
#include "scenes/generated_scenes.h"

#include <cstdio>
#include <exception>

int main(int argc, char** argv) {
    if (argc != 2) {
        std::fprintf(stderr, "usage: generate_scenes FOLDER (the folder scenes/ of the project)\n");
        return 2;
    }
    try {
        for (const scenes::GeneratedScene& scene : scenes::generated_scenes()) {
            scenes::write_scene(scene, argv[1]);
            std::printf("wrote %s/%s\n", argv[1], scene.name.c_str());
        }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
    return 0;
}
