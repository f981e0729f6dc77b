// SPDX-License-Identifier: MIT
#include "renderer/core/capture/instrument_response.h"
#include "tests/fuzz/fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(data, size, "curve.txt", [](const std::string& path) {
        core::make_response({0.0, 0.0, path}, "response");
    });
    return 0;
}
