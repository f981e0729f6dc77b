// SPDX-License-Identifier: MIT
#include "nlos/canvas/png_file.h"

#include "renderer/core/error.h"

#include <cairo.h>
#include <isa-l/crc.h>
#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

// The format: PNG specification, third edition. ISA-L packs a drawing in an eighth of the time that
// zlib takes, on which libpng is built.

namespace nlos {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";

struct ReleaseReader {
    void operator()(cairo_t* context) const { cairo_destroy(context); }
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
using ReaderContext = std::unique_ptr<cairo_t, ReleaseReader>;
using ReaderSurface = std::unique_ptr<cairo_surface_t, ReleaseReader>;

/// Packs bytes into a zlib stream.
class Deflater {
 public:
    Deflater() : stream_(std::make_unique<isal_zstream>()), level_buffer_(ISAL_DEF_LVL1_DEFAULT) {
        ::isal_deflate_init(stream_.get());
        stream_->level = 1;
        stream_->level_buf = level_buffer_.data();
        stream_->level_buf_size = static_cast<std::uint32_t>(level_buffer_.size());
        stream_->gzip_flag = IGZIP_ZLIB;
    }

    void add(std::vector<std::uint8_t>& bytes, bool is_last) {
        stream_->next_in = bytes.data();
        stream_->avail_in = static_cast<std::uint32_t>(bytes.size());
        stream_->end_of_stream = is_last ? 1 : 0;
        std::vector<std::uint8_t> out(kOutBytes);
        do {
            stream_->next_out = out.data();
            stream_->avail_out = kOutBytes;
            if (::isal_deflate(stream_.get()) != COMP_OK) {
                throw core::Failure("picture", "cannot be stored as .png");
            }
            packed_.append(out.begin(), out.end() - stream_->avail_out);
        } while (stream_->avail_out == 0);
    }

    const std::string& packed() const { return packed_; }

 private:
    static constexpr std::uint32_t kOutBytes = 1U << 16;
    std::unique_ptr<isal_zstream> stream_;
    std::vector<std::uint8_t> level_buffer_;
    std::string packed_;
};

/// Red, green and blue of a row, less those of the row above unless that is null.
void append_row(const unsigned char* pixels,
                const unsigned char* above,
                int width,
                std::vector<std::uint8_t>& bytes) {
    constexpr std::uint8_t kNone = 0;  // filters
    constexpr std::uint8_t kUp = 2;
    bytes.push_back(above == nullptr ? kNone : kUp);
    std::size_t at = bytes.size();
    bytes.resize(at + 3 * static_cast<std::size_t>(width));
    for (std::ptrdiff_t i = 0; i < 4 * std::ptrdiff_t{width}; i += 4) {
        for (const std::ptrdiff_t channel : {i + 2, i + 1, i}) {
            const int difference = pixels[channel] - (above == nullptr ? 0 : above[channel]);
            bytes[at++] = static_cast<std::uint8_t>(difference);
        }
    }
}

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
    const std::uint32_t checksum =
        ::crc32_gzip_refl(0, reinterpret_cast<const unsigned char*>(body.data()), body.size());
    return big_endian(static_cast<std::uint32_t>(data.size()), 4) + body + big_endian(checksum, 4);
}

/// What the chunks of a type hold, in their order.
std::vector<std::string_view> data_of(std::string_view png, std::string_view type) {
    std::vector<std::string_view> found;
    for (std::size_t at = kSignature.size(); at < png.size();) {
        const std::size_t size = read_number(png.substr(at));
        if (png.substr(at + 4, 4) == type) found.push_back(png.substr(at + 8, size));
        at += size + 12;
    }
    return found;
}

}  // namespace

std::string encode_png(const unsigned char* pixels, int width, int height, int stride) {
    constexpr int kRowsAtOnce = 32;
    constexpr char kRgbOfEightBits[] = {8, 2, 0, 0, 0};
    Deflater deflater;
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < height; ++y) {
        const unsigned char* const row = pixels + std::ptrdiff_t{y} * stride;
        append_row(row, y > 0 ? row - stride : nullptr, width, bytes);
        const bool is_last = y + 1 == height;
        if (!is_last && (y + 1) % kRowsAtOnce != 0) continue;
        deflater.add(bytes, is_last);
        bytes.clear();
    }
    const std::string header = big_endian(static_cast<std::uint32_t>(width), 4) +
                               big_endian(static_cast<std::uint32_t>(height), 4) +
                               std::string(kRgbOfEightBits, sizeof(kRgbOfEightBits));
    return std::string(kSignature) + chunk("IHDR", header) + chunk("IDAT", deflater.packed()) +
           chunk("IEND", "");
}

std::optional<Raster> decode_png(std::string_view bytes) {
    const auto read = [](void* rest, unsigned char* target, unsigned int size) {
        auto& left = *static_cast<std::string_view*>(rest);
        if (left.size() < size) return CAIRO_STATUS_READ_ERROR;
        std::copy_n(left.begin(), size, target);
        left.remove_prefix(size);
        return CAIRO_STATUS_SUCCESS;
    };
    const ReaderSurface file(cairo_image_surface_create_from_png_stream(read, &bytes));
    if (cairo_surface_status(file.get()) != CAIRO_STATUS_SUCCESS) return std::nullopt;
    Raster raster{
        cairo_image_surface_get_width(file.get()), cairo_image_surface_get_height(file.get()), {}};
    const ReaderSurface paper(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, raster.columns, raster.rows));
    const ReaderContext context(cairo_create(paper.get()));
    cairo_set_source_rgb(context.get(), 1.0, 1.0, 1.0);
    cairo_paint(context.get());
    cairo_set_source_surface(context.get(), file.get(), 0.0, 0.0);
    cairo_paint(context.get());
    cairo_surface_flush(paper.get());
    if (cairo_status(context.get()) != CAIRO_STATUS_SUCCESS) return std::nullopt;
    const unsigned char* row = cairo_image_surface_get_data(paper.get());
    for (int y = 0; y < raster.rows; ++y, row += cairo_image_surface_get_stride(paper.get())) {
        for (int x = 0; x < raster.columns; ++x) {
            const unsigned char* const pixel = row + std::ptrdiff_t{4} * x;
            raster.colours.push_back({pixel[2], pixel[1], pixel[0]});
        }
    }
    return raster;
}

std::string join_animated_png(const std::vector<std::string>& frames, int frames_per_second) {
    assert(!frames.empty());
    const std::string_view header = data_of(frames.front(), "IHDR").front();
    std::uint32_t number = 0;  // of the next fcTL or fdAT
    std::string film =
        std::string(kSignature) + chunk("IHDR", header) +
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
