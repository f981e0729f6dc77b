// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <array>
#include <cstdint>

namespace core {
namespace {

struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 0;  ///< 0 when the text starts with no character of UTF-8
};

/// The character that `text` starts with.
Character first_character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) return {byte(0), 1};
    const std::size_t count = byte(0) >> 5 == 0x6 ? 2 : byte(0) >> 4 == 0xe ? 3 : 4;
    if ((count == 4 && byte(0) >> 3 != 0x1e) || text.size() < count) return {};
    std::uint32_t code = byte(0) & (0x7fU >> count);
    for (std::size_t i = 1; i < count; ++i) {
        if (byte(i) >> 6 != 0x2) return {};
        code = code << 6 | (byte(i) & 0x3fU);
    }
    constexpr std::array<std::uint32_t, 3> kSmallest{0x80, 0x800, 0x10000};
    const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
    if (code < kSmallest[count - 2] || code > 0x10ffff || is_surrogate) return {};
    return {code, count};
}

/// Control characters of ASCII and Latin-1, which terminals obey, and those of Unicode that end
/// lines or turn the order of what follows.
bool is_control(std::uint32_t code) {
    return code < ' ' || (code >= 0x7f && code < 0xa0) || (code >= 0x2028 && code <= 0x202e) ||
           (code >= 0x2066 && code <= 0x2069);
}

std::string escaped_byte(char byte) {
    return fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
}

std::string escaped(std::uint32_t code) {
    if (code == '\n') return "\\n";
    if (code == '\r') return "\\r";
    if (code == '\t') return "\\t";
    return code < 0x80 ? escaped_byte(static_cast<char>(code)) : fmt::format("\\u{:04x}", code);
}

}  // namespace

std::string printable(std::string_view text) {
    std::string shown;
    shown.reserve(text.size());
    while (!text.empty()) {
        const auto [code, bytes] = first_character(text);
        if (bytes == 0) {
            shown += escaped_byte(text[0]);
        } else if (is_control(code)) {
            shown += escaped(code);
        } else {
            shown += text.substr(0, bytes);
        }
        text.remove_prefix(bytes == 0 ? 1 : bytes);
    }
    return shown;
}

}  // namespace core
