// SPDX-License-Identifier: MIT
// Photographs against OpenCV's own decoders, and files that are none.
#include "calib/setup/boards.h"
#include "renderer/core/error.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <png.h>
#include <sys/stat.h>
#include <zlib.h>

#include <filesystem>
#include <random>

namespace {

using calib::Photograph;
using calib::read_photograph;
using test_support::file_bytes;
using test_support::TemporaryFolder;
using test_support::write_file_bytes;

constexpr std::size_t kPngHeaderEnd = 33;  // signature and IHDR, which begins at 8

/// Waves with a little noise; its sides are no multiples of the blocks of JPEG.
cv::Mat waves(int type) {
    const int channels = CV_MAT_CN(type);
    cv::Mat picture(61, 97, CV_64FC(channels));
    cv::RNG noise(7);
    for (int y = 0; y < picture.rows; ++y) {
        auto* value = picture.ptr<double>(y);
        for (int x = 0; x < picture.cols; ++x) {
            for (int c = 0; c < channels; ++c) {
                const double wave = std::sin(0.05 * x * (c + 1) + 0.07 * y);
                *value++ = 0.49 + 0.49 * wave + noise.uniform(0.0, 0.02);
            }
        }
    }
    cv::Mat result;
    picture.convertTo(result, type, CV_MAT_DEPTH(type) == CV_16U ? 65535.0 : 255.0);
    return result;
}

std::string encoded(const std::string& suffix, int type, const std::vector<int>& options = {}) {
    std::vector<unsigned char> bytes;
    cv::imencode(suffix, waves(type), bytes, options);
    return {bytes.begin(), bytes.end()};
}

std::string palette_png() {
    constexpr int kColours = 200;
    std::vector<png_byte> colours;
    for (int i = 0; i < kColours; ++i) {
        for (const int step : {1, 3, 7}) colours.push_back(static_cast<png_byte>(i * step));
    }
    std::vector<png_byte> pixels;
    for (int i = 0; i < 40 * 30; ++i) pixels.push_back(static_cast<png_byte>(i % kColours));
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    picture.width = 40;
    picture.height = 30;
    picture.format = PNG_FORMAT_RGB_COLORMAP;
    picture.colormap_entries = kColours;
    const TemporaryFolder folder;
    const std::string path = folder.file("palette.png");
    png_image_write_to_file(&picture, path.c_str(), 0, pixels.data(), 0, colours.data());
    return file_bytes(path);
}

Photograph photograph_of(const std::string& bytes) {
    const TemporaryFolder folder;
    write_file_bytes(folder.file("picture"), bytes);
    return read_photograph(folder.file("picture"));
}

/// The largest difference from what OpenCV makes of the same bytes, in grey levels. Its decoder of
/// PNG would convert colours to grey as light where a file gives its gamma.
double largest_difference(const std::string& bytes) {
    cv::Mat expected = cv::imdecode(std::vector<unsigned char>(bytes.begin(), bytes.end()),
                                    cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
    if (expected.channels() == 3) cv::cvtColor(expected, expected, cv::COLOR_BGR2GRAY);
    Photograph found = photograph_of(bytes);
    EXPECT_EQ(cv::Size(found.width, found.height), expected.size());
    const cv::Mat grey(found.height, found.width, CV_8UC1, found.grey.data());
    return cv::norm(grey, expected, cv::NORM_INF);
}

TEST(Photograph, GreyValuesAreThoseOfOpenCv) {
    EXPECT_EQ(largest_difference(encoded(".png", CV_8UC1)), 0.0);
    EXPECT_EQ(largest_difference(encoded(".png", CV_8UC1, {cv::IMWRITE_PNG_BILEVEL, 1})), 0.0);
    for (const int type : {CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3, CV_16UC4}) {
        EXPECT_LE(largest_difference(encoded(".png", type)), 1.0) << type;
    }
    EXPECT_LE(largest_difference(palette_png()), 1.0);
    for (const int type : {CV_8UC1, CV_8UC3}) {
        for (const int progressive : {0, 1}) {
            const std::vector<int> options{
                cv::IMWRITE_JPEG_QUALITY, 90, cv::IMWRITE_JPEG_PROGRESSIVE, progressive};
            EXPECT_LE(largest_difference(encoded(".jpg", type, options)), 1.0) << type;
        }
    }
}

TEST(Photograph, OtherFormatsAndFilesAreRefused) {
    for (const std::string suffix : {".tif", ".bmp", ".ppm", ".webp"}) {
        EXPECT_ERROR_WITH(photograph_of(encoded(suffix, CV_8UC3)),
                          "is neither a PNG nor a JPEG file; must be a complete PNG or JPEG file");
    }
    EXPECT_ERROR_WITH(photograph_of(""), "is neither");
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(read_photograph(folder.path()), "is a folder; must be a complete PNG");
    EXPECT_ERROR_WITH(read_photograph(folder.file("none")), "cannot be opened");
    ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
    EXPECT_ERROR_WITH(read_photograph(folder.file("pipe")), "is no regular file");
}

std::string png_that_claims(std::uint32_t width, std::uint32_t height) {
    std::string bytes = encoded(".png", CV_8UC1);
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[16 + i] = static_cast<char>(width >> (24 - 8 * i));
        bytes[20 + i] = static_cast<char>(height >> (24 - 8 * i));
    }
    const auto* header = reinterpret_cast<const unsigned char*>(bytes.data() + 12);
    const auto checksum = static_cast<std::uint32_t>(::crc32(0, header, 17));
    for (std::size_t i = 0; i < 4; ++i) {
        bytes[29 + i] = static_cast<char>(checksum >> (24 - 8 * i));
    }
    return bytes;
}

TEST(Photograph, ClaimsOfSizeAreNotBelieved) {
    EXPECT_ERROR_WITH(photograph_of(png_that_claims(100'000, 100'000)),
                      "has 100000 x 100000 pixels");
    EXPECT_ERROR_WITH(photograph_of(png_that_claims(20'000, 20'000)), "has 20000 x 20000 pixels");
    EXPECT_ERROR_WITH(photograph_of(png_that_claims(5'000, 5'000)), "cannot be decoded");
}

TEST(Photograph, CutFilesAreRefused) {
    for (const std::string& bytes : {encoded(".png", CV_8UC3), encoded(".jpg", CV_8UC3)}) {
        for (const std::size_t parts : {1U, 2U, 3U, 7U}) {
            EXPECT_ERROR_WITH(photograph_of(bytes.substr(0, bytes.size() * parts / 8)),
                              "cannot be decoded");
        }
    }
}

TEST(Photograph, DamagedFilesAreReadOrRefused) {
    std::mt19937_64 engine(5);
    for (const std::string& bytes : {encoded(".png", CV_8UC3), encoded(".jpg", CV_8UC3)}) {
        for (int i = 0; i < 100; ++i) {
            std::string damaged = bytes;
            for (int n = 0; n < 3; ++n) {
                damaged[engine() % bytes.size()] ^= static_cast<char>(engine() % 255 + 1);
            }
            try {
                const Photograph found = photograph_of(damaged);
                EXPECT_EQ(found.grey.size(), std::size_t(found.width) * std::size_t(found.height));
            } catch (const core::Error& error) {
                EXPECT_NE(std::string(error.what()).find("complete"), std::string::npos)
                    << error.what();
            }
        }
    }
}

/// A TIFF directory that holds another entry and an orientation.
std::string tiff_with_orientation(bool is_big_endian, unsigned orientation) {
    const auto number = [&](std::size_t count, std::uint32_t value) {
        std::string bytes;
        for (std::size_t i = 0; i < count; ++i) {
            bytes += static_cast<char>(value >> (8 * (is_big_endian ? count - 1 - i : i)));
        }
        return bytes;
    };
    const auto entry = [&](std::uint32_t tag, std::uint32_t value) {
        return number(2, tag) + number(2, 3) + number(4, 1) + number(2, value) + number(2, 0);
    };
    return (is_big_endian ? "MM" : "II") + number(2, 42) + number(4, 8) + number(2, 2) +
           entry(0x0106, 2) + entry(0x0112, orientation) + number(4, 0);
}

std::string jpeg_with_orientation(bool is_big_endian, unsigned orientation) {
    const std::string exif =
        std::string("Exif\0\0", 6) + tiff_with_orientation(is_big_endian, orientation);
    const std::string segment{'\xff', '\xe1', '\0', static_cast<char>(exif.size() + 2)};
    return encoded(".jpg", CV_8UC3).insert(2, segment + exif);
}

std::string png_with_orientation(bool is_big_endian, unsigned orientation) {
    const std::string tiff = tiff_with_orientation(is_big_endian, orientation);
    const std::string chunk{'\0', '\0', '\0', static_cast<char>(tiff.size()), 'e', 'X', 'I', 'f'};
    const std::string checksum(4, '\0');  // wrong, and nobody looks
    return encoded(".png", CV_8UC3).insert(kPngHeaderEnd, chunk + tiff + checksum);
}

TEST(Photograph, TurnedPicturesAreRefused) {
    for (const auto& make : {jpeg_with_orientation, png_with_orientation}) {
        for (const bool is_big_endian : {false, true}) {
            EXPECT_EQ(photograph_of(make(is_big_endian, 1)).width, 97);
            for (const unsigned orientation : {3U, 6U}) {
                EXPECT_ERROR_WITH(photograph_of(make(is_big_endian, orientation)),
                                  "EXIF orientation " + std::to_string(orientation));
            }
        }
    }
    // The independent reader sees the same tag and turns by it.
    const std::string turned = jpeg_with_orientation(true, 6);
    const cv::Mat shown = cv::imdecode(std::vector<unsigned char>(turned.begin(), turned.end()),
                                       cv::IMREAD_GRAYSCALE);
    EXPECT_EQ(shown.size(), cv::Size(61, 97));
}

}  // namespace
