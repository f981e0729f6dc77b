// SPDX-License-Identifier: MIT
#include "nlos/plots/plot.h"

#include "nlos/pictures/picture.h"
#include "tests/support/decoded_png.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace nlos {
namespace {

Plot plot_with(std::vector<PlotLine> lines) {
    return {"title", "x [m]", "y [s]", std::move(lines)};
}

/// The columns and rows of a picture of one plot in which the colour of one of its lines appears.
struct Pixels {
    std::vector<int> columns;
    std::vector<int> rows;
};
Pixels pixels_of(std::size_t line, const Plot& plot) {
    const cv::Mat picture = test_support::decoded_png(encode_panels({plot}, 1));
    const Colour colour = series_colour(line);
    Pixels pixels;
    for (int x = 0; x < picture.cols; ++x) {
        for (int y = 0; y < picture.rows; ++y) {
            if (picture.at<cv::Vec3b>(y, x) != cv::Vec3b(colour.blue, colour.green, colour.red)) {
                continue;
            }
            pixels.columns.push_back(x);
            pixels.rows.push_back(y);
        }
    }
    return pixels;
}

/// Where the middle of the only point of a line without a title is drawn.
std::array<double, 2> middle_of(std::size_t line, const Plot& plot) {
    const Pixels pixels = pixels_of(line, plot);
    EXPECT_FALSE(pixels.columns.empty());
    std::array<double, 2> sums{};
    for (std::size_t i = 0; i < pixels.columns.size(); ++i) {
        sums[0] += pixels.columns[i];
        sums[1] += pixels.rows[i];
    }
    const auto count = static_cast<double>(pixels.columns.size());
    return {sums[0] / count, sums[1] / count};
}

TEST(Plot, FactorsAreDistancesOnLogarithmicAxes) {
    Plot plot = plot_with({{"", {1.0}, {1e-6}}, {"", {10.0}, {1e-4}}, {"", {100.0}, {1e-2}}});
    const auto check_distances = [&](double along_x, double along_y) {
        const auto a = middle_of(0, plot);
        const auto b = middle_of(1, plot);
        const auto c = middle_of(2, plot);
        EXPECT_NEAR((b[0] - a[0]) / (c[0] - a[0]), along_x, 0.005);
        EXPECT_NEAR((b[1] - a[1]) / (c[1] - a[1]), along_y, 0.005);
        EXPECT_GT(c[0], a[0]) << "x runs to the right";
        EXPECT_LT(c[1], a[1]) << "y runs upwards";
    };
    check_distances(0.5, 0.5);
    plot.x_scale = AxisScale::Linear;
    check_distances(9.0 / 99.0, 0.5);
}

TEST(Plot, PointsThatAnAxisCannotShowAreLeftOut) {
    const Plot all = plot_with({{"a", {1.0, 2.0, 4.0}, {1.0, 2.0, 3.0}}});
    const Plot more = plot_with({{"a", {1.0, 2.0, -1.0, 2.0, 4.0}, {1.0, NAN, 1.0, 2.0, 3.0}}});
    EXPECT_EQ(encode_panels({all}, 1), encode_panels({more}, 1));
    EXPECT_FALSE(encode_panels({plot_with({})}, 1).empty()) << "no line at all";
    EXPECT_FALSE(encode_panels({plot_with({{"zero", {0.0}, {0.0}}})}, 1).empty());
}

TEST(Plot, TheLegendHasAnEntryForEveryTitle) {
    Plot plot = plot_with({});
    for (int i = 0; i < 5; ++i) plot.lines.push_back({"line", {1.0 + i}, {1.0 + i}});
    const int height = test_support::decoded_png(encode_panels({plot}, 1)).rows;
    for (std::size_t i = 0; i < plot.lines.size(); ++i) {
        const Pixels pixels = pixels_of(i, plot);
        EXPECT_GT(*std::ranges::max_element(pixels.rows), 800) << "below the axes";
        EXPECT_LT(*std::ranges::max_element(pixels.rows), height);
    }
    for (PlotLine& line : plot.lines)
        line.title =
            "a title so long that two have no room abreast, "
            "whatever letters they are written in, not one";
    EXPECT_GT(test_support::decoded_png(encode_panels({plot}, 1)).rows, height);
}

TEST(Plot, AnyTextMayBeATitle) {
    Plot plot = plot_with({{"\xff'<b>&\n`x`", {1.0}, {1.0}}});
    plot.title = "'; print \"";
    for (const PictureFormat format :
         {PictureFormat::Png, PictureFormat::Svg, PictureFormat::Pdf}) {
        EXPECT_FALSE(encode_panels({plot}, 1, format).empty());
    }
}

TEST(Plot, TheParetoFrontLeavesOutWhatIsBeatenInBoth) {
    const PlotLine front =
        pareto_front({{"a", {1.0, 3.0, 9.0}, {5.0, 4.0, 1.0}}, {"b", {2.0, 4.0}, {2.0, 3.0}}});
    EXPECT_EQ(front.x, (std::vector{1.0, 2.0, 9.0}));
    EXPECT_EQ(front.y, (std::vector{5.0, 2.0, 1.0}));
    EXPECT_EQ(front.style, LineStyle::Limit);
}

}  // namespace
}  // namespace nlos
