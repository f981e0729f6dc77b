// SPDX-License-Identifier: MIT
#include "renderer/scene_import/scene_import.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(
        data, size, "scene.yaml", [](const std::string& path) { renderer::import_scene(path); });
    return 0;
}
