// SPDX-License-Identifier: MIT
#include "nlos/canvas/canvas.h"

#include "nlos/canvas/png_file.h"
#include "nlos/canvas/raster.h"
#include "renderer/core/error.h"
#include "tests/support/decoded_png.h"

#include <gtest/gtest.h>
#include <pugixml.hpp>
#include <zlib.h>

#include <cmath>
#include <random>

namespace nlos {
namespace {

using test_support::decoded_png;

constexpr Colour kWhite{255, 255, 255};
constexpr Colour kRed{200, 10, 20};

/// A text, a line, and an image of 2 x 1 cells.
std::string small_drawing(PictureFormat format, const std::string& text) {
    Canvas canvas(400, 200, kWhite, format);
    canvas.text(20, 50, text, {.cap_height_px = 30.0, .colour = kRed});
    canvas.polyline({{20.0, 100.0}, {380.0, 120.5}}, kRed, 3);
    canvas.image({100, 140, 40, 20}, 2, 1, {kRed, {0, 0, 255}});
    return canvas.finish();
}

/// What the compressed streams of a PDF file hold, and the text between them.
std::string unpacked_pdf(const std::string& pdf) {
    std::string text = pdf;
    for (std::size_t at = 0; (at = pdf.find("stream\n", at)) != std::string::npos; at += 7) {
        std::string unpacked(1 << 20, '\0');
        uLongf size = unpacked.size();
        const auto* packed = reinterpret_cast<const Bytef*>(pdf.data() + at + 7);
        if (::uncompress(reinterpret_cast<Bytef*>(unpacked.data()),
                         &size,
                         packed,
                         static_cast<uLong>(pdf.size() - at - 7)) == Z_OK) {
            text += unpacked.substr(0, size);
        }
    }
    return text;
}

TEST(Canvas, LettersHaveTheHeightAskedFor) {
    Canvas canvas(200, 100, kWhite);
    canvas.text(100, 50, "H", {.cap_height_px = 40.0, .anchor = TextAnchor::Centre});
    const cv::Mat picture = decoded_png(canvas.finish());
    int top = picture.rows;
    int bottom = 0;
    int left = picture.cols;
    int right = 0;
    for (int y = 0; y < picture.rows; ++y) {
        for (int x = 0; x < picture.cols; ++x) {
            if (picture.at<cv::Vec3b>(y, x)[0] > 128) continue;
            top = std::min(top, y);
            bottom = std::max(bottom, y + 1);
            left = std::min(left, x);
            right = std::max(right, x + 1);
        }
    }
    EXPECT_NEAR(top, 30, 1);
    EXPECT_NEAR(bottom, 70, 1);
    EXPECT_NEAR(0.5 * (left + right), 100.0, 1.0);
    EXPECT_LT(right - left, Canvas::text_length("H", {.cap_height_px = 40.0}));
}

TEST(Canvas, TextsGrowWithTheirLetters) {
    const TextStyle style{.cap_height_px = 10.0};
    const double length = Canvas::text_length("σ = 10⁻⁶ m²", style);
    EXPECT_NEAR(
        Canvas::text_length("σ = 10⁻⁶ m²", {.cap_height_px = 20.0}), 2.0 * length, 1e-6 * length);
    EXPECT_NEAR(Canvas::text_length("HH", style), 2.0 * Canvas::text_length("H", style), 1e-9);
    EXPECT_EQ(Canvas::text_length("", style), 0.0);
}

TEST(Canvas, TextsThatAreNoUtf8CanBeDrawn) {
    EXPECT_FALSE(decoded_png(small_drawing(PictureFormat::Png, "\xff\xfe\n")).empty());
}

TEST(Canvas, SvgHoldsLettersLinesAndImages) {
    const std::string svg = small_drawing(PictureFormat::Svg, "W/(m² sr)");
    pugi::xml_document document;
    ASSERT_TRUE(document.load_string(svg.c_str()));
    const pugi::xml_node root = document.child("svg");
    // Four pixels are three points of 1/72 inch, at the two per pixel of a screen.
    EXPECT_EQ(root.attribute("viewBox").as_string(), std::string("0 0 150 75"));
    EXPECT_EQ(root.select_nodes("//*[local-name()='image']").size(), 1U);
    EXPECT_GE(root.select_nodes("//*[local-name()='use']").size(), 8U) << "letters";
    // Cairo 1.16 writes the line's width in its style, 1.18 in an attribute.
    const auto lines = root.select_nodes(
        "//*[local-name()='path'][@stroke-width or contains(@style, 'stroke-width')]");
    ASSERT_EQ(lines.size(), 1U);
    const std::string line = lines.first().node().attribute("d").as_string();
    EXPECT_TRUE(line.starts_with("M 20 100 L 380 120.5")) << line;
}

TEST(Canvas, PdfBringsItsFontAndKeepsTheText) {
    const std::string pdf = small_drawing(PictureFormat::Pdf, "W/(m² sr)");
    EXPECT_TRUE(pdf.starts_with("%PDF"));
    const std::string text = unpacked_pdf(pdf);
    EXPECT_NE(text.find("DejaVuSans"), std::string::npos);
    EXPECT_NE(text.find("/FontFile"), std::string::npos);
    EXPECT_NE(text.find("/ToUnicode"), std::string::npos);
    EXPECT_NE(text.find("/Subtype /Image"), std::string::npos);
    EXPECT_EQ(text.find("/Interpolate true"), std::string::npos) << "sharp cells";
}

TEST(Canvas, SameDrawingsAreTheSameBytes) {
    // But for .svg, in which the images of a process are numbered.
    for (const auto format : {PictureFormat::Png, PictureFormat::Pdf}) {
        EXPECT_EQ(small_drawing(format, "text"), small_drawing(format, "text"));
    }
    EXPECT_EQ(unpacked_pdf(small_drawing(PictureFormat::Pdf, "text")).find("CreationDate"),
              std::string::npos);
}

TEST(Canvas, CellsOfImagesKeepTheirColoursAndEdges) {
    const cv::Mat picture = decoded_png(small_drawing(PictureFormat::Png, ""));
    const cv::Vec3b red(kRed.blue, kRed.green, kRed.red);
    EXPECT_EQ(picture.at<cv::Vec3b>(140, 100), red);
    EXPECT_EQ(picture.at<cv::Vec3b>(159, 119), red);
    EXPECT_EQ(picture.at<cv::Vec3b>(159, 120), cv::Vec3b(255, 0, 0));
    EXPECT_EQ(picture.at<cv::Vec3b>(160, 120), cv::Vec3b(255, 255, 255));
}

TEST(Canvas, TooLargePicturesAreAFailure) {
    EXPECT_THROW(Canvas(100'000, 100'000, kWhite).finish(), core::Failure);
}

TEST(Raster, ShrinksByAveragingAndGrowsInBlocks) {
    const Raster raster{4, 1, {{0, 0, 0}, {100, 0, 0}, {0, 200, 0}, {0, 0, 40}}};
    const Raster shrunk = resized(raster, 2, 3);
    ASSERT_EQ(shrunk.colours.size(), 6U);
    EXPECT_EQ(shrunk.at(0, 2).red, 50);
    EXPECT_EQ(shrunk.at(1, 0).green, 100);
    EXPECT_EQ(shrunk.at(1, 1).blue, 20);
    // Cells that lie in two new ones count in both.
    EXPECT_EQ(resized(raster, 3, 1).at(1, 0).red, 50);
    const Raster grown = resized(raster, 8, 1);
    for (int x = 0; x < 8; ++x) EXPECT_EQ(grown.at(x, 0).green, raster.at(x / 2, 0).green) << x;
}

// ---- Animations --------------------------------------------------------------------------------

struct Chunk {
    std::string type;
    std::string data;
};

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        value = value << 8 | static_cast<unsigned char>(bytes.at(at + i));
    }
    return value;
}

/// The chunks of a file whose checksums are right.
std::vector<Chunk> chunks_of(const std::string& png) {
    std::vector<Chunk> chunks;
    for (std::size_t at = 8; at < png.size();) {
        const std::size_t size = number_at(png, at);
        chunks.push_back({png.substr(at + 4, 4), png.substr(at + 8, size)});
        const auto* body = reinterpret_cast<const Bytef*>(png.data() + at + 4);
        EXPECT_EQ(number_at(png, at + 8 + size), ::crc32(0, body, static_cast<uInt>(size + 4)));
        at += size + 12;
    }
    return chunks;
}

TEST(PngFile, KeepsEveryPixelOfNoise) {
    constexpr int kWidth = 301;
    constexpr int kHeight = 203;
    constexpr int kStride = 4 * kWidth + 12;
    std::mt19937 generator(1);
    std::vector<unsigned char> pixels(std::size_t{kStride} * kHeight);
    for (unsigned char& byte : pixels) byte = static_cast<unsigned char>(generator());
    const std::string png = encode_png(pixels.data(), kWidth, kHeight, kStride);
    chunks_of(png);
    const cv::Mat picture = decoded_png(png);
    ASSERT_EQ(picture.size(), cv::Size(kWidth, kHeight));
    const cv::Mat with_filler(kHeight, kWidth, CV_8UC4, pixels.data(), kStride);
    cv::Mat channels[4];
    cv::split(with_filler, channels);
    cv::Mat expected;
    cv::merge(channels, 3, expected);
    EXPECT_EQ(cv::norm(picture, expected, cv::NORM_INF), 0.0);
}

TEST(AnimatedPng, HoldsEveryFrame) {
    std::vector<std::string> frames;
    for (const char* text : {"one", "two", "three"}) {
        frames.push_back(small_drawing(PictureFormat::Png, text));
    }
    const std::string film = join_animated_png(frames, 5);
    EXPECT_EQ(cv::norm(decoded_png(film), decoded_png(frames[0])), 0.0)
        << "what other viewers show";

    std::vector<std::string> pixels;  // of the frames, compressed
    std::uint32_t next = 0;
    for (const Chunk& chunk : chunks_of(film)) {
        if (chunk.type == "acTL") {
            EXPECT_EQ(number_at(chunk.data, 0), 3U);
            EXPECT_EQ(number_at(chunk.data, 4), 0U) << "for ever";
        } else if (chunk.type == "fcTL") {
            EXPECT_EQ(number_at(chunk.data, 0), next++);
            EXPECT_EQ(number_at(chunk.data, 4), 400U);
            EXPECT_EQ(number_at(chunk.data, 8), 200U);
            EXPECT_EQ(number_at(chunk.data, 20), 0x00010005U) << "a fifth of a second";
            pixels.emplace_back();
        } else if (chunk.type == "IDAT") {
            pixels.back() += chunk.data;
        } else if (chunk.type == "fdAT") {
            EXPECT_EQ(number_at(chunk.data, 0), next++);
            pixels.back() += chunk.data.substr(4);
        }
    }
    ASSERT_EQ(pixels.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        std::string expected;
        for (const Chunk& chunk : chunks_of(frames[i])) {
            if (chunk.type == "IDAT") expected += chunk.data;
        }
        EXPECT_EQ(pixels[i], expected) << i;
    }
}

TEST(PngFile, IsReadAsItWasWritten) {
    const std::string png = small_drawing(PictureFormat::Png, "abc");
    const cv::Mat expected = decoded_png(png);
    const std::optional<Raster> found = decode_png(png);
    ASSERT_TRUE(found);
    ASSERT_EQ(cv::Size(found->columns, found->rows), expected.size());
    for (int y = 0; y < found->rows; ++y) {
        for (int x = 0; x < found->columns; ++x) {
            const auto& [red, green, blue] = found->at(x, y);
            ASSERT_EQ(cv::Vec3b(blue, green, red), expected.at<cv::Vec3b>(y, x)) << x << ", " << y;
        }
    }
    EXPECT_FALSE(decode_png(png.substr(0, png.size() / 2)));
    EXPECT_FALSE(decode_png("no picture"));
}

}  // namespace
}  // namespace nlos
