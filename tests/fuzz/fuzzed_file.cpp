// SPDX-License-Identifier: MIT
#include "tests/fuzz/fuzzed_file.h"

#include "renderer/core/error.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

// Counters of the coverage of all code built for fuzzing.
extern "C" char __start___sancov_cntrs;
extern "C" char __stop___sancov_cntrs;

namespace fuzz {
namespace {

/// Readers run libraries in a child process, whose coverage would be lost with it: from now on the
/// counters, but for the parts of pages at both ends, are memory that both share.
void share_coverage_with_children() {
    const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    const auto begin =
        (reinterpret_cast<std::uintptr_t>(&__start___sancov_cntrs) + page - 1) / page * page;
    const auto end = reinterpret_cast<std::uintptr_t>(&__stop___sancov_cntrs) / page * page;
    if (end <= begin) return;
    auto* counters = reinterpret_cast<char*>(begin);
    const std::vector<char> values(counters, counters + (end - begin));
    if (::mmap(counters,
               end - begin,
               PROT_READ | PROT_WRITE,
               MAP_SHARED | MAP_ANONYMOUS | MAP_FIXED,
               -1,
               0) == MAP_FAILED) {
        std::abort();
    }
    std::memcpy(counters, values.data(), values.size());
}

std::string make_folder() {
    share_coverage_with_children();
    const std::filesystem::path memory =
        std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp";
    const std::filesystem::path folder = memory / ("nlos_fuzz_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    return folder.string();
}

}  // namespace

void read_fuzzed_file(const std::uint8_t* data,
                      std::size_t size,
                      const std::string& name,
                      const std::function<void(const std::string& path)>& read) {
    static const std::string folder = make_folder();
    const std::string path = folder + "/" + name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    try {
        read(path);
    } catch (const core::Error& error) {
        const std::string line = error.what();
        if (std::count(line.begin(), line.end(), '\n') > 0) std::abort();
    } catch (const core::Failure&) {
    }
}

}  // namespace fuzz
