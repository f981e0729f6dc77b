// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(
        data, size, "capture", [](const std::string& path) { nlos::read_capture(path); });
    return 0;
}
