// SPDX-License-Identifier: MIT
#include "renderer/mesh_file/mesh_file.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(data, size, "mesh.ply", [](const std::string& path) {
        renderer::load_mesh_file(path, {});
    });
    return 0;
}
