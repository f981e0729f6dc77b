// SPDX-License-Identifier: MIT
#include "nlos/pictures/canvas.h"

#include "renderer/core/error.h"

#include <opencv2/imgproc.hpp>
#include <png.h>

#include <cassert>
#include <cmath>

namespace nlos {
namespace {

// Text is drawn this many times larger into a mask and averaged down: OpenCV's own smoothing is
// too coarse for letters of this size.
constexpr int kOversampling = 4;
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontCapHeight = 21.0;  // of kFont at scale 1 [px]
constexpr int kSubpixelBits = 4;         // of polygon coordinates

cv::Scalar bgr(Colour colour) {
    return {double(colour.blue), double(colour.green), double(colour.red)};
}

double font_scale(const TextStyle& style) {
    return kOversampling * style.cap_height_px / kFontCapHeight;
}

int font_thickness(const TextStyle& style) {
    return static_cast<int>(std::lround(kOversampling * style.stroke_px));
}

/// How much of each pixel the text covers, 0 to 255; capitals are centred across the line.
cv::Mat text_mask(const std::string& text, const TextStyle& style) {
    const int cap = static_cast<int>(std::lround(style.cap_height_px * kOversampling));
    const int width = Canvas::text_length(text, style) * kOversampling;
    const int margin = cap;  // above and below the capitals, for brackets and descenders
    cv::Mat large(cap + 2 * margin, width, CV_8UC1, cv::Scalar(0));
    cv::putText(large,
                text,
                {font_thickness(style) / 2, margin + cap},
                kFont,
                font_scale(style),
                cv::Scalar(255),
                font_thickness(style),
                cv::LINE_AA);
    cv::Mat mask;
    cv::resize(
        large, mask, {width / kOversampling, large.rows / kOversampling}, 0, 0, cv::INTER_AREA);
    if (style.direction == TextDirection::Upwards) {
        cv::rotate(mask, mask, cv::ROTATE_90_COUNTERCLOCKWISE);
    }
    return mask;
}

/// Blends `colour` into the image where the mask, laid at (left, top), covers it.
void blend(cv::Mat& image, const cv::Mat& mask, cv::Point corner, Colour colour) {
    const cv::Rect covered = cv::Rect(corner, mask.size()) & cv::Rect({0, 0}, image.size());
    for (int y = covered.y; y < covered.y + covered.height; ++y) {
        for (int x = covered.x; x < covered.x + covered.width; ++x) {
            const int alpha = mask.at<std::uint8_t>(y - corner.y, x - corner.x);
            auto& pixel = image.at<cv::Vec3b>(y, x);
            const int ink[3] = {colour.blue, colour.green, colour.red};
            for (int c = 0; c < 3; ++c) {
                pixel[c] = static_cast<std::uint8_t>(
                    (pixel[c] * (255 - alpha) + ink[c] * alpha + 127) / 255);
            }
        }
    }
}

int offset_to(TextAnchor anchor, int length) {
    if (anchor == TextAnchor::Centre) return length / 2;
    return anchor == TextAnchor::End ? length : 0;
}

std::vector<cv::Point> subpixel_points(const std::vector<std::array<double, 2>>& points) {
    std::vector<cv::Point> result;
    for (const auto& [x, y] : points) {
        result.emplace_back(static_cast<int>(std::lround(std::ldexp(x, kSubpixelBits))),
                            static_cast<int>(std::lround(std::ldexp(y, kSubpixelBits))));
    }
    return result;
}

}  // namespace

struct Canvas::Pixels {
    cv::Mat image;
};

Canvas::Canvas(int width, int height, Colour background)
    : pixels_(std::make_unique<Pixels>(Pixels{cv::Mat(height, width, CV_8UC3, bgr(background))})) {}

Canvas::~Canvas() = default;

void Canvas::fill(const PixelBox& box, Colour colour) {
    cv::rectangle(
        pixels_->image, cv::Rect(box.x, box.y, box.width, box.height), bgr(colour), cv::FILLED);
}

void Canvas::frame(const PixelBox& box, Colour colour, int thickness) {
    const int outer_width = box.width + 2 * thickness;
    fill({box.x - thickness, box.y - thickness, outer_width, thickness}, colour);
    fill({box.x - thickness, box.bottom(), outer_width, thickness}, colour);
    fill({box.x - thickness, box.y, thickness, box.height}, colour);
    fill({box.right(), box.y, thickness, box.height}, colour);
}

void Canvas::fill_polygon(const std::vector<std::array<double, 2>>& points,
                          Colour colour,
                          double opacity) {
    cv::Mat mask(pixels_->image.size(), CV_8UC1, cv::Scalar(0));
    const std::vector<std::vector<cv::Point>> polygons{subpixel_points(points)};
    cv::fillPoly(mask, polygons, cv::Scalar(255.0 * opacity), cv::LINE_AA, kSubpixelBits);
    blend(pixels_->image, mask, {0, 0}, colour);
}

void Canvas::polyline(const std::vector<std::array<double, 2>>& points,
                      Colour colour,
                      int thickness) {
    cv::polylines(pixels_->image,
                  subpixel_points(points),
                  false,
                  bgr(colour),
                  thickness,
                  cv::LINE_AA,
                  kSubpixelBits);
}

int Canvas::text_length(const std::string& text, const TextStyle& style) {
    int baseline = 0;
    const cv::Size size =
        cv::getTextSize(text, kFont, font_scale(style), font_thickness(style), &baseline);
    return (size.width + font_thickness(style) + kOversampling) / kOversampling;
}

void Canvas::text(int x, int y, const std::string& text, const TextStyle& style) {
    if (text.empty()) return;
    const cv::Mat mask = text_mask(text, style);
    if (style.direction == TextDirection::Horizontal) {
        const int left = x - offset_to(style.anchor, mask.cols);
        blend(pixels_->image, mask, {left, y - mask.rows / 2}, style.colour);
    } else {
        const int top = y - mask.rows + offset_to(style.anchor, mask.rows);
        blend(pixels_->image, mask, {x - mask.cols / 2, top}, style.colour);
    }
}

void Canvas::image(const PixelBox& box, int columns, int rows, const std::vector<Colour>& colours) {
    assert(colours.size() == static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    cv::Mat source(rows, columns, CV_8UC3);
    for (int y = 0; y < rows; ++y) {
        for (int x = 0; x < columns; ++x) {
            const Colour& c =
                colours[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(x)];
            source.at<cv::Vec3b>(y, x) = cv::Vec3b(c.blue, c.green, c.red);
        }
    }
    // First shrink the axes that have too many pixels, then enlarge those that have too few.
    const cv::Size shrunk(std::min(columns, box.width), std::min(rows, box.height));
    cv::resize(source, source, shrunk, 0, 0, cv::INTER_AREA);
    cv::resize(source, source, {box.width, box.height}, 0, 0, cv::INTER_NEAREST);
    source.copyTo(pixels_->image(cv::Rect(box.x, box.y, box.width, box.height)));
}

std::string Canvas::encode_png() const {
    const cv::Mat& pixels = pixels_->image;
    png_image picture{};
    picture.version = PNG_IMAGE_VERSION;
    picture.width = static_cast<png_uint_32>(pixels.cols);
    picture.height = static_cast<png_uint_32>(pixels.rows);
    picture.format = PNG_FORMAT_BGR;
    png_alloc_size_t count = PNG_IMAGE_PNG_SIZE_MAX(picture);
    std::string bytes(count, '\0');
    const auto row_bytes = static_cast<png_int_32>(pixels.step[0]);
    if (!png_image_write_to_memory(
            &picture, bytes.data(), &count, 0, pixels.data, row_bytes, nullptr)) {
        throw core::Failure("picture", std::string("cannot be encoded as PNG: ") + picture.message);
    }
    bytes.resize(count);
    return bytes;
}

}  // namespace nlos
