// SPDX-License-Identifier: MIT
// Which panels results and captures become, and what stands in them.
#include "nlos/pictures/pictures.h"

#include "nlos/pictures/picture.h"
#include "tests/support/decoded_png.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_volume.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace nlos {
namespace {

using test_support::kBackground;

const ImagePanel& image(const Panel& panel) {
    return std::get<ImagePanel>(panel);
}

/// The labels of a picture's axes, x before y.
std::vector<std::array<std::string, 2>> axes_of(const std::vector<Panel>& panels) {
    std::vector<std::array<std::string, 2>> labels;
    for (const Panel& panel : panels) {
        std::visit([&](const auto& p) { labels.push_back({p.x_label, p.y_label}); }, panel);
    }
    return labels;
}

TEST(Pictures, AxesSayThatTheyAreTheWalls) {
    using Labels = std::vector<std::array<std::string, 2>>;
    const Reconstruction result = test_support::column_volume({1.0F, 1.0F}, {0.701, 0.7});
    EXPECT_EQ(axes_of(volume_panels(result)),
              (Labels{{"wall x [m]", "wall y [m]"},
                      {"depth from the wall [m]", "wall y [m]"},
                      {"wall x [m]", "depth from the wall [m]"},
                      {"wall x [m]", "wall y [m]"}}));
    const core::DepthMap truth = test_support::truth_of(result, {0.7, 0.7});
    EXPECT_EQ(axes_of(comparison_panels(result, truth)), Labels(3, {"wall x [m]", "wall y [m]"}));
    EXPECT_EQ(image(truth_panels(truth)[0]).value_label, "depth from the wall [m]");
    const core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    EXPECT_EQ(axes_of(capture_panels(capture)),
              (Labels{{"wall x [m]", "path length [m]"},
                      {"wall x [m]", "wall y [m]"},
                      {"path length [m]", "radiance per bin"}}));
}

TEST(Pictures, ErrorMapsOfASceneShareOneScale) {
    const Reconstruction good = test_support::column_volume({1.0F, 1.0F}, {0.701, 0.7});
    const Reconstruction poor = test_support::column_volume({1.0F, 1.0F}, {0.9, 0.5});
    const core::DepthMap truth = test_support::truth_of(good, {0.7, 0.7});
    const auto range = [&](const Reconstruction& result) {
        return std::get<ImagePanel>(comparison_panels(result, truth)[2]).value_range.value();
    };
    EXPECT_NEAR(range(good)[1], 14.0, 1e-9);  // mm: 2 % of the true depth
    EXPECT_EQ(range(good), range(poor));
}

TEST(Pictures, StreaksRunAsTheWallBesideThem) {
    const auto panels = capture_panels(test_support::example_capture(core::ScanPattern::Confocal));
    EXPECT_EQ(std::get<ImagePanel>(panels[0]).x_direction,
              std::get<ImagePanel>(panels[1]).x_direction);
    EXPECT_EQ(std::get<ImagePanel>(panels[0]).x_direction, AxisDirection::Reversed);
}

TEST(Pictures, FaintLightIsDrawnOnAScaleThatShowsIt) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    const auto scale = [&] { return std::get<ImagePanel>(capture_panels(capture)[0]).value_scale; };
    for (float& value : capture.transient.values()) value = 1.0F;
    EXPECT_EQ(scale(), ValueScale::Linear);
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        capture.transient.histogram(pair)[2] = 1000.0F;
    }
    EXPECT_EQ(scale(), ValueScale::Gamma);
}

TEST(Pictures, ViewsOfDeepVolumesShareTheScaleOfTheWall) {
    Reconstruction deep = test_support::column_volume({1.0F, 0.5F, 0.2F}, {});
    for (double& z : deep.volume.axes.z_m) z *= 10.0;
    const std::vector<Panel> panels = volume_panels(deep);
    const auto& front = std::get<ImagePanel>(panels[0]);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& view = std::get<ImagePanel>(panels[i]);
        EXPECT_EQ(view.aspect, AspectRatio::Equal);
        EXPECT_EQ(view.full_length, front.full_length);
    }
    EXPECT_EQ(std::get<ImagePanel>(panels[2]).x_range, front.x_range);
}

TEST(Pictures, UnitOfRadianceIsGivenOfRenderedCapturesAlone) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    const auto label = [&] { return std::get<ImagePanel>(capture_panels(capture)[0]).value_label; };
    EXPECT_EQ(label(), "radiance per bin") << "of a file that says no more";
    capture.scene_info["estimator"] = "path";
    EXPECT_EQ(label(), "radiance per bin at 1 W [W/(m² sr)]");
    EXPECT_EQ(std::get<ImagePanel>(capture_panels(capture)[1]).value_label,
              "radiance at 1 W [W/(m² sr)]");
    capture.unit = core::TransientUnit::Counts;
    EXPECT_EQ(label(), "counts per bin");
}

TEST(Pictures, FrontViewShowsWhatAnEyeAtTheWallSees) {
    const Reconstruction result = test_support::column_volume({0.5F, 0.0F, 2.0F}, {});
    const std::vector<Panel> panels = volume_panels(result);
    ASSERT_EQ(panels.size(), 4U);
    const ImagePanel& front = image(panels[0]);
    EXPECT_EQ(front.values, (std::vector<float>{0.25F, 0.0F, 1.0F}));  // fractions of the maximum
    EXPECT_EQ(front.x_direction, AxisDirection::Reversed);
    EXPECT_EQ(front.y_direction, AxisDirection::Usual);
    EXPECT_NEAR(front.x_range[0], -0.05, 1e-12);
    EXPECT_NEAR(front.x_range[1], 0.25, 1e-12);
    EXPECT_EQ(image(panels[1]).values, (std::vector<float>{0.0F, 1.0F, 0.0F}));  // along x: z
    EXPECT_EQ(image(panels[2]).values,
              (std::vector<float>{0.0F, 0.0F, 0.0F, 0.25F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F}));
    EXPECT_FALSE(encode_panels(panels, 2).empty());
}

TEST(Pictures, ProbabilityAndDeviationOfDepthStandBesideIt) {
    Reconstruction result = test_support::column_volume({1.0F, 0.5F}, {0.7, kBackground});
    result.surface_probability = {0.9, 0.25};
    EXPECT_EQ(volume_panels(result).size(), 5U);
    result.depth_sigma_m = {0.002, kBackground};
    const std::vector<Panel> panels = volume_panels(result);
    ASSERT_EQ(panels.size(), 6U);
    EXPECT_EQ(image(panels[4]).values, (std::vector<float>{0.9F, 0.25F}));
    EXPECT_FLOAT_EQ(image(panels[5]).values[0], 2.0F);  // mm
    EXPECT_TRUE(std::isnan(image(panels[5]).values[1]));
    EXPECT_FALSE(encode_panels(panels, 2).empty());
}

TEST(Pictures, DarkVolumesAndEmptyMapsCanBeDrawn) {
    const Reconstruction dark = test_support::column_volume({0.0F, 0.0F}, {});
    EXPECT_FALSE(encode_panels(volume_panels(dark), 2).empty());
    const core::DepthMap nothing = test_support::truth_of(dark, {kBackground, kBackground});
    EXPECT_FALSE(encode_panels(comparison_panels(dark, nothing), 3).empty());
    EXPECT_FALSE(encode_panels(truth_panels(nothing), 3).empty());
}

TEST(Pictures, ErrorMapIsSignedInMillimetres) {
    const Reconstruction result =
        test_support::column_volume({1.0F, 1.0F, 1.0F}, {0.702, 0.698, kBackground});
    const core::DepthMap truth = test_support::truth_of(result, {0.7, 0.7, 0.7});
    const std::vector<Panel> panels = comparison_panels(result, truth);
    ASSERT_EQ(panels.size(), 3U);
    const ImagePanel& error = image(panels[2]);
    EXPECT_NEAR(error.values[0], 2.0, 1e-5);
    EXPECT_NEAR(error.values[1], -2.0, 1e-5);
    EXPECT_TRUE(std::isnan(error.values[2]));
    EXPECT_EQ(error.value_range->at(0), -error.value_range->at(1));
    EXPECT_EQ(image(panels[0]).value_range, image(panels[1]).value_range);
    EXPECT_ERROR_WITH(comparison_panels(result, core::DepthMap({0.0}, {0.0})), "same columns");
}

TEST(Pictures, TruthShowsWhatIsKnown) {
    core::DepthMap truth({0.0, 0.1}, {0.0});
    EXPECT_EQ(truth_panels(truth).size(), 1U);
    truth.depth_m = {0.7, kBackground};
    truth.albedo = {0.6, 0.0};
    truth.normals = {core::Vec3(0.0, 0.6, -0.8), core::Vec3::Zero()};
    const std::vector<Panel> panels = truth_panels(truth);
    ASSERT_EQ(panels.size(), 3U);
    EXPECT_FLOAT_EQ(image(panels[1]).values[0], 0.6F);
    EXPECT_FLOAT_EQ(image(panels[2]).values[0], 0.8F);
    EXPECT_TRUE(std::isnan(image(panels[2]).values[1]));
}

TEST(Pictures, StreakHoldsTheMiddleRowOfTheWall) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    const std::vector<Panel> panels = capture_panels(capture);
    ASSERT_EQ(panels.size(), 3U);
    const ImagePanel& streak = image(panels[0]);
    ASSERT_EQ(streak.width, 3U);
    ASSERT_EQ(streak.height, 5U);
    // Points are numbered x first: those of the row iy = 1 are 1, 3, 5.
    for (std::size_t bin = 0; bin < 5; ++bin) {
        for (std::size_t ix = 0; ix < 3; ++ix) {
            EXPECT_EQ(streak.values[bin * 3 + ix], capture.transient.histogram(2 * ix + 1)[bin]);
        }
    }
    EXPECT_NEAR(streak.y_range[0], 0.25, 1e-12);
    EXPECT_NEAR(streak.y_range[1], 0.25 + 5 * 0.008, 1e-12);
    EXPECT_EQ(image(panels[1]).values.size(), 6U);
    EXPECT_EQ(std::get<Plot>(panels[2]).lines.front().y.size(), 5U);
}

TEST(Pictures, EveryKindOfCaptureCanBeDrawn) {
    for (const auto pattern : {core::ScanPattern::Single, core::ScanPattern::Exhaustive}) {
        const core::Capture capture = test_support::example_capture(pattern);
        EXPECT_FALSE(encode_panels(capture_panels(capture), 3).empty());
    }
    core::Capture list = test_support::example_capture(core::ScanPattern::Confocal);
    list.scan.wall().sensing.grid.reset();
    list.scan.wall().illumination.grid.reset();
    EXPECT_EQ(capture_panels(list).size(), 2U);  // no picture of the wall

    core::Capture gate = test_support::example_capture(core::ScanPattern::Confocal);
    gate.time_axis.num_bins = 1;
    gate.transient = core::Transient(gate.scan.num_pairs(), 1);
    EXPECT_EQ(capture_panels(gate).size(), 1U);  // only the wall
    EXPECT_FALSE(encode_panels(capture_panels(gate), 3).empty());
}

TEST(Pictures, ScansWithMoreLitThanSensingPointsShowTheLightOfLitPoints) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Exhaustive);
    std::swap(capture.scan.wall().sensing, capture.scan.wall().illumination);
    const std::vector<Panel> panels = capture_panels(capture);
    const std::vector<float>& shown = image(panels[1]).values;
    ASSERT_EQ(shown.size(), 6U);
    const auto all = capture.transient.values();
    EXPECT_NEAR(std::accumulate(shown.begin(), shown.end(), 0.0),
                std::accumulate(all.begin(), all.end(), 0.0),
                1e-4);
}

TEST(Pictures, VelocitiesHaveAnImageOfTheirMeanAndASpectrum) {
    core::Capture capture = test_support::example_image();
    const core::VelocityAxis axis{-1.0, 0.5, 4};
    capture.velocity = {axis, core::Transient(6, 4), std::nullopt};
    // Pixel x = 1, y = 0 is pair 2: centres -0.75 and 0.75 m/s.
    capture.velocity->values.histogram(2)[0] = 1.0F;
    capture.velocity->values.histogram(2)[3] = 3.0F;
    const std::vector<Panel> panels = velocity_panels(capture);
    ASSERT_EQ(panels.size(), 2U);
    EXPECT_FLOAT_EQ(image(panels[0]).values[1], 0.375F);
    EXPECT_TRUE(std::isnan(image(panels[0]).values[0]));
    const auto& spectrum = std::get<Plot>(panels[1]).lines.front();
    // Steps from edge to edge, in decibels over a millionth of all light.
    EXPECT_EQ(spectrum.x, (std::vector<double>{-1.0, -0.5, -0.5, 0.0, 0.0, 0.5, 0.5, 1.0}));
    EXPECT_NEAR(spectrum.y.front(), 10.0 * std::log10(0.25e6), 1e-9);
    EXPECT_EQ(spectrum.y[2], 0.0);
    EXPECT_NEAR(spectrum.y.back(), 10.0 * std::log10(0.75e6), 1e-9);
    EXPECT_EQ(capture_panels(capture).size(), 8U);
    EXPECT_FALSE(encode_panels(capture_panels(capture), 3).empty());

    capture.velocity->axis.with_time = true;
    capture.velocity->values = core::Transient(6, 20);
    capture.velocity->values.histogram(2)[3 * 5 + 1] = 1.0F;
    const std::vector<Panel> joint = velocity_panels(capture);
    ASSERT_EQ(joint.size(), 3U);
    EXPECT_FLOAT_EQ(image(joint[0]).values[1], 0.75F);
    EXPECT_FLOAT_EQ(image(joint[2]).values[1 * 4 + 3], 60.0F);
}

TEST(Pictures, ImagesAreDrawnFromTheTop) {
    const core::Capture capture = test_support::example_image();
    const std::vector<Panel> panels = capture_panels(capture);
    ASSERT_EQ(panels.size(), 6U);
    const ImagePanel& all = image(panels[0]);
    ASSERT_EQ(all.width, 3U);
    ASSERT_EQ(all.height, 2U);
    EXPECT_EQ(all.y_direction, AxisDirection::Reversed);
    const auto light_of = [&](std::size_t pixel) {
        const auto histogram = capture.transient.histogram(pixel);
        return std::accumulate(histogram.begin(), histogram.end(), 0.0F);
    };
    // Pixel x * height + y stands at [y][x].
    EXPECT_EQ(all.values[1], light_of(2));
    EXPECT_EQ(all.values[3], light_of(1));
    float gated = 0.0F;
    for (std::size_t i = 2; i < panels.size(); ++i) gated += image(panels[i]).values[4];
    EXPECT_FLOAT_EQ(gated, light_of(3)) << "gates share the bins";
    EXPECT_FALSE(encode_panels(panels, 3).empty());
}

TEST(Pictures, PreviewShowsTheImageUpright) {
    core::Capture capture = test_support::example_image();
    for (float& value : capture.transient.values()) value = 0.0F;
    capture.transient.histogram(1)[2] = 2.0F;  // x 0, y 1: bottom left
    const std::string png = encode_preview_png(capture, capture.scan.as<core::ImageScan>()->camera);
    const cv::Mat picture = test_support::decoded_png(png);
    ASSERT_EQ(picture.cols, 639);
    ASSERT_EQ(picture.rows, 426);
    EXPECT_EQ(picture.at<cv::Vec3b>(320, 100), cv::Vec3b(255, 255, 255));
    EXPECT_EQ(picture.at<cv::Vec3b>(100, 100), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(picture.at<cv::Vec3b>(320, 320), cv::Vec3b(0, 0, 0));
}

TEST(Pictures, FilmStripShowsFramesOnOneScale) {
    for (core::Capture capture : {test_support::example_image(),
                                  test_support::example_capture(core::ScanPattern::Confocal)}) {
        core::FrameSequence sequence;
        sequence.frames.assign(30, capture.transient);
        sequence.gate_step_m = 0.005;
        for (float& value : sequence.frames[0].values()) value = 0.0F;
        capture.sequence = sequence;
        const std::vector<Panel> panels = capture_panels(capture);
        ASSERT_EQ(panels.size(), 12U);
        EXPECT_EQ(image(panels[0]).value_range, image(panels[11]).value_range);
        EXPECT_EQ(image(panels[0]).values[0], 0.0F);
        EXPECT_GT(image(panels[11]).values[0], 0.0F);
        // The axis of the example starts at 0.25 m and stands for the last frame.
        EXPECT_EQ(image(panels[0]).title, "Frame 0: 0.105 to 0.145 m");
        EXPECT_EQ(image(panels[11]).title, "Frame 29: 0.25 to 0.29 m");
    }
}

}  // namespace
}  // namespace nlos
