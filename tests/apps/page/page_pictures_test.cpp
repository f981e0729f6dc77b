// SPDX-License-Identifier: MIT
#include "apps/page/page_pictures.h"

#include "nlos/canvas/canvas.h"
#include "nlos/pictures/picture.h"
#include "tests/apps/page/page_text.h"

#include <gtest/gtest.h>

#include <random>

namespace apps {
namespace {

using page_test::contains;
using page_test::count_of;

std::string curve_png() {
    return nlos::encode_panels({nlos::Plot{"curve", "x", "y", {{"", {1.0, 2.0}, {1.0, 2.0}}}}}, 1);
}

/// A picture that no format can pack.
std::string noise_png(int width, int height) {
    std::mt19937 random(4);
    std::vector<nlos::Colour> colours(static_cast<std::size_t>(width * height));
    for (nlos::Colour& colour : colours) {
        colour.red = colour.green = colour.blue = static_cast<std::uint8_t>(random());
    }
    nlos::Canvas canvas(width, height, {255, 255, 255});
    canvas.image({0, 0, width, height}, width, height, colours);
    return canvas.finish();
}

/// The page of pictures, made twice as pages are.
std::string page_of(const std::vector<std::string>& files, PagePictures& pictures, double limit) {
    for (const std::string& file : files) pictures.image(file, "picture");
    pictures.fit(limit);
    std::string html;
    for (const std::string& file : files) html += pictures.image(file, "picture") + "\n";
    return html;
}

TEST(PagePictures, CarryTheirBytesAndWidth) {
    const std::string png = curve_png();
    const std::string svg = "<svg/>";
    PagePictures pictures;
    EXPECT_TRUE(contains(pictures.image(png, "a \"curve\""), "base64,\""));
    pictures.image(svg, "plot");
    pictures.fit(1e6);
    const std::string image = pictures.image(png, "a \"curve\"");
    EXPECT_TRUE(contains(image, "src=\"data:image/png;base64,iVBOR"));
    EXPECT_TRUE(contains(image, " width=\""));
    EXPECT_TRUE(contains(image, "alt=\"a &quot;curve&quot;\""));
    EXPECT_TRUE(contains(pictures.image(svg, "plot"), "src=\"data:image/svg+xml;base64,"));
    EXPECT_FALSE(contains(pictures.image(svg, "plot"), "width"));
    EXPECT_EQ(pictures.num_reduced() + pictures.num_left_out(), 0U);
}

TEST(PagePictures, TheLargestBecomeThumbnailsUntilAllFit) {
    std::vector<std::string> files{curve_png()};
    for (int i = 0; i < 5; ++i) files.push_back(noise_png(400, 300));
    PagePictures pictures;
    const double limit = 200e3;
    const std::string html = page_of(files, pictures, limit);
    EXPECT_GT(pictures.whole_bytes(), 5.0 * limit);
    EXPECT_LE(static_cast<double>(html.size()), limit + 100.0 * 6);
    EXPECT_GE(static_cast<double>(html.size()), 0.5 * limit) << "most of the room is used";
    EXPECT_EQ(count_of(html, "data:image/png"), 1U) << "the curve is small";
    EXPECT_EQ(count_of(html, "data:image/jpeg"), 5U);
    EXPECT_EQ(pictures.num_reduced(), 5U);
    EXPECT_EQ(pictures.num_left_out(), 0U);
}

TEST(PagePictures, OfVeryManyTheLastAreLeftOutAndNamed) {
    const std::vector<std::string> files(50, noise_png(400, 300));
    PagePictures pictures;
    const std::string html = page_of(files, pictures, 20e3);
    EXPECT_EQ(pictures.num_reduced() + pictures.num_left_out(), 50U);
    EXPECT_GE(pictures.num_reduced(), 5U);
    EXPECT_EQ(count_of(html, "data:image/jpeg"), pictures.num_reduced());
    EXPECT_EQ(count_of(html, "picture (left out)"), pictures.num_left_out());
    EXPECT_LE(static_cast<double>(html.size()), 20e3 + 100.0 * 50);
}

TEST(PagePictures, WhatCannotBeMadeSmallerIsLeftOut) {
    const std::vector<std::string> files{"<svg>" + std::string(30'000, ' ') + "</svg>",
                                         "\x89PNG of " + std::string(30'000, 'n'),
                                         curve_png()};
    PagePictures pictures;
    const std::string html = page_of(files, pictures, 30e3);
    EXPECT_EQ(pictures.num_left_out(), 2U);
    EXPECT_EQ(count_of(html, "data:image"), 1U);
}

}  // namespace
}  // namespace apps
