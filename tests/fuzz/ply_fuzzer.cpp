// SPDX-License-Identifier: MIT
#include "nlos/formats/ply_file.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(
        data, size, "mesh.ply", [](const std::string& path) { nlos::read_ply(path); });
    return 0;
}
