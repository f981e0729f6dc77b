// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"

#include <array>
#include <cstdint>

namespace core {
namespace {

/// Bytes of the character that `text` starts with; 0 when it is no character of UTF-8.
std::size_t character_bytes(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) return 1;
    const std::size_t count = byte(0) >> 5 == 0x6 ? 2 : byte(0) >> 4 == 0xe ? 3 : 4;
    if ((count == 4 && byte(0) >> 3 != 0x1e) || text.size() < count) return 0;
    std::uint32_t character = byte(0) & (0x7fU >> count);
    for (std::size_t i = 1; i < count; ++i) {
        if (byte(i) >> 6 != 0x2) return 0;
        character = character << 6 | (byte(i) & 0x3fU);
    }
    constexpr std::array<std::uint32_t, 3> kSmallest{0x80, 0x800, 0x10000};
    const bool is_surrogate = character >= 0xd800 && character <= 0xdfff;
    const bool is_character =
        character >= kSmallest[count - 2] && character <= 0x10ffff && !is_surrogate;
    return is_character ? count : 0;
}

/// ASCII's control characters, and those of the Latin-1 block, which end lines in some terminals.
bool is_control(std::string_view character) {
    const auto first = static_cast<unsigned char>(character[0]);
    if (character.size() == 1) return first < ' ' || first == 0x7f;
    return first == 0xc2 && static_cast<unsigned char>(character[1]) < 0xa0;
}

}  // namespace

std::string printable(std::string_view text) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const std::size_t count = character_bytes(text);
        if (count == 0 || is_control(text.substr(0, count))) {
            shown += '?';
        } else {
            shown += text.substr(0, count);
        }
        text.remove_prefix(count == 0 ? 1 : count);
    }
    return shown;
}

}  // namespace core
