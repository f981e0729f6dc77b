// SPDX-License-Identifier: MIT
#include "nlos/canvas/png_file.h"

#include "renderer/core/error.h"

#include <png.h>

#include <csetjmp>
#include <cstddef>
#include <exception>

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

}  // namespace nlos
