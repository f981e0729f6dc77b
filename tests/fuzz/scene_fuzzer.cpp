// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_file.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(data, size, "scene.json", [](const std::string& path) {
        renderer::read_scene_description(path, {});
    });
    return 0;
}
