// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "tests/fuzz/fuzzed_file.h"

// One file that holds all three variables stands for the three files of a folder.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    for (const char* name : {"C_i.mat", "C_d.mat", "sub_Sig.mat"}) {
        const bool is_last = std::string(name) == "sub_Sig.mat";
        fuzz::read_fuzzed_file(data, size, name, [&](const std::string& path) {
            nlos::CaptureReadSettings settings;
            settings.pitch_m = 0.01;
            settings.bin_width_m = 0.0048;
            if (is_last) nlos::read_capture(path, settings);
        });
    }
    return 0;
}
