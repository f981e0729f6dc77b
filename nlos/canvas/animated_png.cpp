// SPDX-License-Identifier: MIT
#include "nlos/canvas/animated_png.h"

#include <zlib.h>

#include <cassert>
#include <cstdint>
#include <string_view>

// The format: PNG specification, third edition, with the chunks acTL, fcTL and fdAT.
namespace nlos {
namespace {

constexpr std::size_t kSignature = 8;  // bytes before the first chunk

std::string big_endian(std::uint32_t value, int bytes) {
    std::string text;
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
        text += static_cast<char>(value >> shift & 0xff);
    }
    return text;
}

std::uint32_t read_number(std::string_view bytes) {
    std::uint32_t value = 0;
    for (const char c : bytes.substr(0, 4)) value = value << 8 | static_cast<unsigned char>(c);
    return value;
}

std::string chunk(const std::string& type, std::string_view data) {
    const std::string body = type + std::string(data);
    const auto checksum =
        ::crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
    return big_endian(static_cast<std::uint32_t>(data.size()), 4) + body +
           big_endian(static_cast<std::uint32_t>(checksum), 4);
}

/// What the chunks of a type hold, in their order.
std::vector<std::string_view> data_of(std::string_view png, std::string_view type) {
    std::vector<std::string_view> found;
    for (std::size_t at = kSignature; at < png.size();) {
        const std::size_t size = read_number(png.substr(at));
        if (png.substr(at + 4, 4) == type) found.push_back(png.substr(at + 8, size));
        at += size + 12;
    }
    return found;
}

}  // namespace

std::string join_animated_png(const std::vector<std::string>& frames, int frames_per_second) {
    assert(!frames.empty());
    const std::string_view header = data_of(frames.front(), "IHDR").front();
    std::uint32_t number = 0;  // of the next fcTL or fdAT
    std::string film =
        frames.front().substr(0, kSignature) + chunk("IHDR", header) +
        chunk("acTL", big_endian(static_cast<std::uint32_t>(frames.size()), 4) + big_endian(0, 4));
    for (const std::string& frame : frames) {
        assert(data_of(frame, "IHDR").front() == header);
        // The whole picture, in place of the one before it.
        film += chunk("fcTL",
                      big_endian(number++, 4) + std::string(header.substr(0, 8)) +
                          big_endian(0, 4) + big_endian(0, 4) + big_endian(1, 2) +
                          big_endian(static_cast<std::uint32_t>(frames_per_second), 2) +
                          big_endian(0, 2));
        for (const std::string_view data : data_of(frame, "IDAT")) {
            film += &frame == &frames.front()
                        ? chunk("IDAT", data)
                        : chunk("fdAT", big_endian(number++, 4) + std::string(data));
        }
    }
    return film + chunk("IEND", "");
}

}  // namespace nlos
