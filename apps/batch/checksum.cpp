// SPDX-License-Identifier: MIT
#include "apps/batch/checksum.h"

#include <fmt/core.h>
#include <xxhash.h>

#include <algorithm>
#include <fstream>
#include <memory>

namespace apps {
namespace {

std::string hexadecimal(const XXH128_hash_t& hash) {
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::optional<std::string> file_checksum(const std::string& path, std::uint64_t most_bytes) {
    constexpr std::uint64_t kBytesAtOnce = std::uint64_t{1} << 20;
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                                XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::string bytes(kBytesAtOnce, '\0');
    while (most_bytes > 0) {
        const std::uint64_t wanted = std::min(kBytesAtOnce, most_bytes);
        file.read(bytes.data(), static_cast<std::streamsize>(wanted));
        const auto count = static_cast<std::uint64_t>(file.gcount());
        XXH3_128bits_update(state.get(), bytes.data(), count);
        most_bytes -= count;
        if (count < wanted) break;
    }
    if (file.bad()) return std::nullopt;
    return hexadecimal(XXH3_128bits_digest(state.get()));
}

std::string text_checksum(std::string_view text) {
    return hexadecimal(XXH3_128bits(text.data(), text.size()));
}

}  // namespace apps
