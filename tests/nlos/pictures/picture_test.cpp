// SPDX-License-Identifier: MIT
// How one panel, and several in one file, are drawn.
#include "nlos/pictures/picture.h"

#include "nlos/pictures/panel_drawing.h"
#include "tests/support/decoded_png.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace nlos {
namespace {

using test_support::decoded_png;

ImagePanel small_panel() {
    ImagePanel panel;
    panel.title = "Title";
    panel.width = 4;
    panel.height = 4;
    panel.values.assign(16, 0.0F);
    panel.x_label = "x [m]";
    panel.value_range = {0.0, 1.0};
    panel.colour_map = ColourMap::Diverging;
    return panel;
}

/// Where the panel's red pixels (its largest values) lie, as fractions of its white picture; the
/// colour bar, which holds the same red in a narrow strip at the right, is left out.
std::array<double, 2> centre_of_red(const ImagePanel& panel) {
    const cv::Mat picture = decoded_png(encode_panels({panel}, 1));
    const Colour red = colour_at(ColourMap::Diverging, 1.0);
    const int plot_end = picture.cols * 4 / 5;
    double count = 0.0;
    std::array<double, 2> sum{};
    for (int y = 0; y < picture.rows; ++y) {
        for (int x = 0; x < plot_end; ++x) {
            if (picture.at<cv::Vec3b>(y, x) != cv::Vec3b(red.blue, red.green, red.red)) continue;
            sum[0] += x;
            sum[1] += y;
            count += 1.0;
        }
    }
    EXPECT_GT(count, 1000.0);
    return {sum[0] / count / picture.cols, sum[1] / count / picture.rows};
}

TEST(Picture, UsualAxesRunRightAndUp) {
    ImagePanel panel = small_panel();
    panel.values[0] = 1.0F;  // smallest x, smallest y
    const auto [x, y] = centre_of_red(panel);
    EXPECT_LT(x, 0.35);
    EXPECT_GT(y, 0.6);
}

TEST(Picture, ReversedAxesRunLeftAndDown) {
    ImagePanel panel = small_panel();
    panel.values[0] = 1.0F;
    panel.x_direction = AxisDirection::Reversed;
    panel.y_direction = AxisDirection::Reversed;
    const auto [x, y] = centre_of_red(panel);
    EXPECT_GT(x, 0.55);
    EXPECT_LT(y, 0.35);
}

TEST(Picture, ValuesWithoutMeaningAreDrawnNeutral) {
    ImagePanel panel = small_panel();
    panel.values.assign(16, NAN);
    panel.value_range.reset();
    const cv::Mat picture = decoded_png(encode_panels({panel}, 1));
    const cv::Vec3b middle = picture.at<cv::Vec3b>(picture.rows / 2, picture.cols / 2);
    EXPECT_LT(std::abs(middle[0] - middle[2]), 12);  // grey
    EXPECT_NE(middle, cv::Vec3b(255, 255, 255));
}

TEST(Picture, CategoriesHaveColoursOfTheirOwn) {
    ImagePanel panel = small_panel();
    panel.categories = {{"first", {200, 30, 30}}, {"second", {30, 30, 200}}};
    for (const auto& [value, blue, red] :
         {std::tuple{1.0F, 30, 200}, std::tuple{2.0F, 200, 30}, std::tuple{0.0F, 255, 255}}) {
        panel.values.assign(16, value);
        const cv::Mat picture = decoded_png(encode_panels({panel}, 1));
        const cv::Vec3b middle = picture.at<cv::Vec3b>(picture.rows / 2, picture.cols / 2);
        EXPECT_EQ(middle[0], blue) << value;
        EXPECT_EQ(middle[2], red) << value;
    }
}

TEST(Picture, PanelsFillRowsFirst) {
    const std::vector<Panel> panels{small_panel(), small_panel(), small_panel()};
    const cv::Mat one = decoded_png(encode_panels({small_panel()}, 1));
    const cv::Mat row = decoded_png(encode_panels(panels, 3));
    const cv::Mat table = decoded_png(encode_panels(panels, 2));
    EXPECT_EQ(row.rows, one.rows);
    EXPECT_GT(row.cols, 2.5 * one.cols);
    EXPECT_GT(table.rows, 1.5 * one.rows);
    EXPECT_LT(table.cols, row.cols);
}

TEST(Picture, PanelsFillTheRoomBesideTallOnes) {
    ImagePanel tall = small_panel();
    tall.x_range = {0.0, 1.0};
    tall.y_range = {0.0, 3.0};
    tall.full_length = 1.0;
    ImagePanel flat = tall;
    flat.y_range = {0.0, 1.0};
    const auto rows = [](const std::vector<Panel>& panels, int columns) {
        return decoded_png(encode_panels(panels, columns)).rows;
    };
    EXPECT_EQ(rows({tall, flat, flat}, 2), rows({tall}, 1)) << "two beside a tall one";
    EXPECT_EQ(rows({flat, tall, flat, flat}, 2), rows({flat, flat, flat}, 1));
}

TEST(Picture, SuffixChoosesTheFormat) {
    const test_support::TemporaryFolder folder;
    const auto written = [&](const std::string& name) {
        write_panels(folder.file(name), {small_panel()}, 1);
        return test_support::file_bytes(folder.file(name));
    };
    EXPECT_EQ(written("a.png"), encode_panels({small_panel()}, 1));
    EXPECT_NE(written("a.svg").find("<svg"), std::string::npos);
    EXPECT_TRUE(written("a.pdf").starts_with("%PDF"));
    EXPECT_ERROR_WITH(written("a.jpg"), "has the suffix '.jpg'; must be one of .png, .svg, .pdf");
    EXPECT_ERROR_WITH(check_picture_suffix("a"), "must be one of .png, .svg, .pdf");
    check_picture_suffix("");
}

/// The width and height of a panel's coloured plot, without what stands around it [pixels].
std::array<int, 2> plot_size(const ImagePanel& panel) {
    ImagePanel large = panel;
    large.x_range = {0.0, 1.0};
    large.y_range = {0.0, 1.0};
    large.full_length = 0.0;
    const PixelSize usual = panel_size(large);
    const PixelSize size = panel_size(panel);
    return {640 + size.width - usual.width, 640 + size.height - usual.height};
}

TEST(Picture, MetresAreAsLongAlongBothAxes) {
    ImagePanel panel = small_panel();
    panel.x_range = {-1.0, 1.0};
    panel.y_range = {0.0, 1.5};
    EXPECT_EQ(plot_size(panel), (std::array{640, 480}));
    panel.full_length = 1.0;
    EXPECT_EQ(plot_size(panel), (std::array{1280, 960}));
    panel.aspect = AspectRatio::Free;
    EXPECT_EQ(plot_size(panel), (std::array{640, 640}));
}

TEST(Picture, ThinPlotsStayTrueToTheMetre) {
    ImagePanel panel = small_panel();
    panel.values.assign(16, 1.0F);
    panel.y_range = {0.0, 0.1};
    const cv::Mat picture = decoded_png(encode_panels({panel}, 1));
    const Colour red = colour_at(ColourMap::Diverging, 1.0);
    int rows = 0;
    for (int y = 0; y < picture.rows; ++y) {
        rows +=
            picture.at<cv::Vec3b>(y, picture.cols / 2) == cv::Vec3b(red.blue, red.green, red.red);
    }
    EXPECT_EQ(rows, 64) << "a tenth of its width";
}

TEST(Picture, PanelsWithoutMatchingValuesAreRefused) {
    ImagePanel panel = small_panel();
    panel.values.pop_back();
    EXPECT_ERROR_WITH(encode_panels({panel}, 1), "found 15 values for 4 x 4");
    EXPECT_ERROR_WITH(encode_panels({}, 1), "found no panel");
    EXPECT_ERROR_WITH(encode_panels({Plot{"c", "", "", {{"", {1.0}, {}}}}}, 1), "1 x and 0 y");
}

TEST(Picture, OddCurvesCanBeDrawn) {
    for (const auto& y :
         {std::vector<double>{0.0, 0.0}, {5.0, 5.0}, {-1.0, -2.0}, {1e-12, 2e-12}}) {
        Plot curve = area_plot("curve", "x", "y");
        curve.lines.front().x = {0.0, 1.0};
        curve.lines.front().y = y;
        EXPECT_FALSE(decoded_png(encode_panels({curve}, 1)).empty());
    }
    Plot point = area_plot("point", "x", "y");
    point.lines.front().add(1.0, 1.0);
    EXPECT_FALSE(decoded_png(encode_panels({point}, 1)).empty());
}

}  // namespace
}  // namespace nlos
