// SPDX-License-Identifier: MIT
#include "nlos/containers/file_memory.h"

#include "renderer/core/error.h"
#include "renderer/core/process.h"

#include <fmt/core.h>

namespace nlos {

void require_memory(std::uint64_t bytes, const std::string& where) {
    constexpr double kGibibyte = 1024.0 * 1024.0 * 1024.0;
    const std::uint64_t available = core::available_memory_bytes();
    if (bytes > available) {
        throw core::Failure(where,
                            fmt::format("needs {:.1f} GiB of memory, {:.1f} GiB are free",
                                        static_cast<double>(bytes) / kGibibyte,
                                        static_cast<double>(available) / kGibibyte));
    }
}

}  // namespace nlos
