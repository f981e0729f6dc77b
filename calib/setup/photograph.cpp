// SPDX-License-Identifier: MIT
#include "calib/setup/boards.h"
#include "renderer/core/error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/sandboxed_process.h"

#include <fmt/core.h>
#include <png.h>
#include <turbojpeg.h>

#include <memory>
#include <string_view>

namespace calib {
namespace {

using core::Json;

constexpr std::int64_t kMostPixels = 250'000'000;
constexpr const char* kAllowed = "must be a complete PNG or JPEG file of at most 250 megapixels";

bool is_png(std::string_view bytes) {
    return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

bool is_jpeg(std::string_view bytes) {
    return bytes.starts_with("\xff\xd8\xff");
}

/// The orientation in the first directory of a TIFF header, 1 (upright) where there is none.
int tiff_orientation(std::string_view tiff) {
    constexpr std::size_t kOrientationTag = 0x0112;
    constexpr std::size_t kEntryBytes = 12;
    const bool is_big_endian = tiff.starts_with("MM");
    const auto number = [&](std::size_t at, std::size_t count) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t byte = at + (is_big_endian ? i : count - 1 - i);
            value = value << 8 | (byte < tiff.size() ? static_cast<unsigned char>(tiff[byte]) : 0U);
        }
        return value;
    };
    const std::size_t directory = number(4, 4);
    const std::size_t entries = number(directory, 2);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::size_t entry = directory + 2 + i * kEntryBytes;
        if (number(entry, 2) == kOrientationTag) return static_cast<int>(number(entry + 8, 2));
    }
    return 1;
}

void require_upright(const std::string& path, std::string_view bytes) {
    using namespace std::string_view_literals;
    for (const std::string_view marker : {"Exif\0\0"sv, "eXIf"sv}) {  // in JPEG, in PNG
        const std::size_t at = bytes.find(marker);
        if (at == bytes.npos) continue;
        const int orientation = tiff_orientation(bytes.substr(at + marker.size()));
        if (orientation < 2 || orientation > 8) continue;
        throw core::Error(path,
                          fmt::format("is to be shown turned (EXIF orientation {})", orientation),
                          "must be stored as it is shown, without an orientation");
    }
}

[[noreturn]] void throw_undecodable(const std::string& path, const std::string& reason) {
    throw core::Error(path, fmt::format("cannot be decoded ({})", reason), kAllowed);
}

/// The number of pixels, which may not be too large.
std::size_t pixel_count(const std::string& path, std::int64_t width, std::int64_t height) {
    if (width * height > kMostPixels) {
        throw core::Error(path, fmt::format("has {} x {} pixels", width, height), kAllowed);
    }
    return static_cast<std::size_t>(width * height);
}

/// Red, green and blue as JPEG weighs them.
std::uint8_t grey_of(const std::uint8_t* rgb) {
    return static_cast<std::uint8_t>((299 * rgb[0] + 587 * rgb[1] + 114 * rgb[2] + 500) / 1000);
}

Photograph decode_png(const std::string& path, std::string_view bytes) {
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    const std::unique_ptr<png_image, void (*)(png_image*)> owner(&picture, png_image_free);
    if (!png_image_begin_read_from_memory(&picture, bytes.data(), bytes.size())) {
        throw_undecodable(path, picture.message);
    }
    const std::size_t pixels = pixel_count(path, picture.width, picture.height);
    picture.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    picture.format = PNG_FORMAT_RGBA;
    constexpr std::size_t kChannels = 4;
    std::vector<std::uint8_t> rgba(kChannels * pixels);
    if (!png_image_finish_read(&picture, nullptr, rgba.data(), 0, nullptr)) {
        throw_undecodable(path, picture.message);
    }
    Photograph result{
        static_cast<int>(picture.width), static_cast<int>(picture.height), std::move(rgba)};
    for (std::size_t i = 0; i < pixels; ++i) result.grey[i] = grey_of(&result.grey[kChannels * i]);
    result.grey.resize(pixels);
    return result;
}

/// Whatever the library warns of is an error here: damaged photographs calibrate nothing.
Photograph decode_jpeg(const std::string& path, std::string_view bytes) {
    const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
    const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
    const auto require_success = [&](int status) {
        if (status != 0) throw_undecodable(path, tjGetErrorStr2(decoder.get()));
    };
    Photograph result;
    int subsampling = 0;
    int colours = 0;
    require_success(tjDecompressHeader3(
        decoder.get(), data, bytes.size(), &result.width, &result.height, &subsampling, &colours));
    result.grey.resize(pixel_count(path, result.width, result.height));
    require_success(tjDecompress2(decoder.get(),
                                  data,
                                  bytes.size(),
                                  result.grey.data(),
                                  result.width,
                                  0,
                                  result.height,
                                  TJPF_GRAY,
                                  TJFLAG_ACCURATEDCT | TJFLAG_LIMITSCANS));
    return result;
}

Json to_json(const Photograph& photograph) {
    return {{"width", photograph.width},
            {"height", photograph.height},
            {"grey", Json::binary(photograph.grey)}};
}

}  // namespace

Photograph read_photograph(const std::string& path) {
    const core::MappedFile file(path, kAllowed);
    const bool png = is_png(file.bytes());
    if (!png && !is_jpeg(file.bytes())) {
        throw core::Error(path, "is neither a PNG nor a JPEG file", kAllowed);
    }
    const Json json = core::run_sandboxed(path, [&] {
        require_upright(path, file.bytes());
        return to_json((png ? decode_png : decode_jpeg)(path, file.bytes()));
    });
    return {json.at("width"), json.at("height"), json.at("grey").get_binary()};
}

}  // namespace calib
