// SPDX-License-Identifier: MIT
#include "tests/fuzz/fuzzed_file.h"
#include "tests/nlos/containers/read_everything.h"

// One fuzzer for files of arrays of every container: run.sh gives it the seeds of one at a time.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::read_fuzzed_file(data, size, "arrays.csv", nlos::read_everything);
    return 0;
}
