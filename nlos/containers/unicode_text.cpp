// SPDX-License-Identifier: MIT
#include "nlos/containers/unicode_text.h"

#include "nlos/containers/stored_number.h"

#include <cstdint>

namespace nlos {
namespace {

constexpr std::uint32_t kNoCharacter = 0xfffd;

void append(std::uint32_t character, std::string& text) {
    const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
    const auto continue_from = [&](int shift) { add(0x80 | (character >> shift & 0x3f)); };
    if (character < 0x80) {
        add(character);
    } else if (character < 0x800) {
        add(0xc0 | character >> 6);
        continue_from(0);
    } else if (character < 0x10000) {
        add(0xe0 | character >> 12);
        continue_from(6);
        continue_from(0);
    } else {
        add(0xf0 | character >> 18);
        continue_from(12);
        continue_from(6);
        continue_from(0);
    }
}

std::uint32_t unit_at(const char* unit, std::size_t unit_bytes, std::endian order) {
    const StoredNumber number = unit_bytes == 2 ? StoredNumber::UInt16 : StoredNumber::UInt32;
    return static_cast<std::uint32_t>(number_at(unit, number, order));
}

bool is_between(std::uint32_t value, std::uint32_t low, std::uint32_t high) {
    return low <= value && value <= high;
}

}  // namespace

std::string utf8_text(const char* units,
                      std::size_t count,
                      std::size_t unit_bytes,
                      std::endian order) {
    if (unit_bytes == 1) return {units, count};
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
        std::uint32_t character = unit_at(units + i * unit_bytes, unit_bytes, order);
        if (is_between(character, 0xd800, 0xdbff) && i + 1 < count) {
            const std::uint32_t low = unit_at(units + (i + 1) * unit_bytes, unit_bytes, order);
            if (is_between(low, 0xdc00, 0xdfff)) {
                character = 0x10000 + ((character - 0xd800) << 10 | (low - 0xdc00));
                ++i;
            }
        }
        if (is_between(character, 0xd800, 0xdfff) || character > 0x10ffff) character = kNoCharacter;
        append(character, text);
    }
    return text;
}

}  // namespace nlos
