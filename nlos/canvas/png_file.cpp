// SPDX-License-Identifier: MIT
#include "nlos/canvas/png_file.h"

#include "renderer/core/error.h"

#include <png.h>
#include <zlib.h>

#include <cassert>
#include <csetjmp>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string_view>

namespace nlos {
namespace {

constexpr int kLevel = 3;  // of zlib: from 4 on it is slow

/// A writer of libpng, which jumps back to its caller on an error.
struct PngWriter {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png ? png_create_info_struct(png) : nullptr;

    PngWriter() = default;
    PngWriter(const PngWriter&) = delete;
    PngWriter& operator=(const PngWriter&) = delete;
    ~PngWriter() { png_destroy_write_struct(&png, &info); }
};

void append(png_structp png, png_bytep data, std::size_t size) {
    auto* const bytes = static_cast<std::string*>(png_get_io_ptr(png));
    try {
        bytes->append(reinterpret_cast<const char*>(data), size);
        return;
    } catch (const std::exception&) {
        bytes->clear();
    }
    png_error(png, "out of memory");
}

/// returns   false when libpng jumped back; nothing here needs a destructor
bool write(png_structp png,
           png_infop info,
           const unsigned char* pixels,
           int width,
           int height,
           int stride) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_IHDR(png,
                 info,
                 static_cast<png_uint_32>(width),
                 static_cast<png_uint_32>(height),
                 8,
                 PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(png, kLevel);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_write_info(png, info);
    png_set_bgr(png);
    png_set_filler(png, 0, PNG_FILLER_AFTER);
    for (int y = 0; y < height; ++y) png_write_row(png, pixels + std::ptrdiff_t{y} * stride);
    png_write_end(png, info);
    return true;
}

// Animations. The format: PNG specification, third edition, with the chunks acTL, fcTL and fdAT,
// which libpng does not write.

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

std::string encode_png(const unsigned char* pixels, int width, int height, int stride) {
    std::string bytes;
    const PngWriter writer;
    if (writer.info) png_set_write_fn(writer.png, &bytes, append, nullptr);
    if (!writer.info || !write(writer.png, writer.info, pixels, width, height, stride)) {
        throw core::Failure("picture", "cannot be stored as .png");
    }
    return bytes;
}

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
