// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(
        data, size, "scene.gltf", [](const std::string& path) { renderer::load_gltf(path); });
    return 0;
}
