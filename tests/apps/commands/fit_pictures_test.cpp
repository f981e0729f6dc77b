// SPDX-License-Identifier: MIT
#include "apps/commands/fit_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace apps {
namespace {

TEST(FitPictures, ShowTheBinsWithLightOfTheScene) {
    calib::FitResult fit;
    fit.axis = {1.0, 0.01, 200};
    for (int pair = 0; pair < 3; ++pair) {
        for (int bin = 0; bin < fit.axis.num_bins; ++bin) {
            const bool is_lit = bin >= 80 && bin < 100;
            fit.model.push_back(is_lit ? 5.0 : 0.5);  // ambient everywhere
            fit.data.push_back(fit.model.back() + pair);
        }
    }
    for (const nlos::Panel& panel : fit_panels(fit)) {
        const auto& image = std::get<nlos::ImagePanel>(panel);
        EXPECT_LE(image.x_range[0], 1.80);
        EXPECT_GE(image.x_range[1], 2.00);
        EXPECT_LT(image.width, 40U);
        EXPECT_NEAR(
            image.x_range[1] - image.x_range[0], 0.01 * static_cast<double>(image.width), 1e-12);
        EXPECT_EQ(image.values.size(), image.width * image.height);
    }
    const auto data = std::get<nlos::ImagePanel>(fit_panels(fit)[0]);
    EXPECT_EQ(data.values[data.width / 2], 5.0F);  // of the first pair
}

TEST(FitPictures, OverlaysHaveCategories) {
    calib::FitErrors errors;
    errors.true_points.positions = {{0.0, 0.0, 1.0}, {0.5, 0.0, 1.0}};
    errors.fitted_points.positions = {{0.5, 0.0, 1.0}, {0.5, 0.4, 1.0}};
    const std::vector<nlos::Panel> panels = overlay_panels(errors, core::Transform::Identity());
    ASSERT_EQ(panels.size(), 3U);
    const auto& front = std::get<nlos::ImagePanel>(panels[0]);
    ASSERT_EQ(front.categories.size(), 3U);
    EXPECT_EQ(front.categories[2].first, "both");
    const std::set<float> values(front.values.begin(), front.values.end());
    EXPECT_EQ(values, (std::set<float>{0.0F, 1.0F, 2.0F, 3.0F}));
}

TEST(FitPictures, OverlaysAreSeenFromTheWallWhereverItIs) {
    const core::Transform pose = Eigen::Translation3d(1.0, -2.0, 3.0) *
                                 Eigen::AngleAxisd(0.7, core::Vec3(1.0, 2.0, 0.5).normalized());
    calib::FitErrors errors;
    errors.true_points.positions = {{0.0, 0.0, 1.0}, {0.5, 0.0, 1.0}, {0.1, 0.4, 1.2}};
    errors.fitted_points.positions = {{0.5, 0.0, 1.0}, {0.5, 0.4, 1.0}};
    const std::vector<nlos::Panel> usual = overlay_panels(errors, core::Transform::Identity());
    for (auto* points : {&errors.true_points, &errors.fitted_points}) {
        for (core::Vec3& point : points->positions) point = pose * point;
    }
    const std::vector<nlos::Panel> turned = overlay_panels(errors, pose);
    ASSERT_EQ(turned.size(), usual.size());
    for (std::size_t i = 0; i < usual.size(); ++i) {
        const auto& expected = std::get<nlos::ImagePanel>(usual[i]);
        const auto& found = std::get<nlos::ImagePanel>(turned[i]);
        EXPECT_NEAR(found.x_range[0], expected.x_range[0], 1e-9);
        EXPECT_NEAR(found.y_range[0], expected.y_range[0], 1e-9);
        const auto is_marked = [](float value) { return value > 0.0F; };
        EXPECT_EQ(std::ranges::count_if(found.values, is_marked),
                  std::ranges::count_if(expected.values, is_marked));
    }
    EXPECT_EQ(std::get<nlos::ImagePanel>(turned[1]).x_label, "depth from the wall [m]");
    EXPECT_EQ(std::get<nlos::ImagePanel>(turned[2]).x_label, "wall x [m]");
}

}  // namespace
}  // namespace apps
