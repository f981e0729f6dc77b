// SPDX-License-Identifier: MIT
// What a page's script decodes must be what was measured and found, to the steps of its codes.
#include "apps/page/page_views.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_volume.h"

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <random>

namespace apps {
namespace {

// What the viewer's data.js does, written anew: base64, zlib, little-endian numbers.
std::string bytes_of_array(const std::string& html, std::size_t number) {
    const std::string start = "id=\"nlos-array-" + std::to_string(number) + "\">";
    const std::size_t begin = html.find(start) + start.size();
    const std::string text = html.substr(begin, html.find('<', begin) - begin);
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string packed;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        if (c == '=') break;
        bits = bits << 6U | static_cast<unsigned>(digits.find(c));
        count += 6;
        if (count < 8) continue;
        count -= 8;
        packed += static_cast<char>(bits >> static_cast<unsigned>(count) & 255U);
    }
    std::string bytes(1 << 20, '\0');
    uLongf size = bytes.size();
    EXPECT_EQ(::uncompress(reinterpret_cast<Bytef*>(bytes.data()),
                           &size,
                           reinterpret_cast<const Bytef*>(packed.data()),
                           packed.size()),
              Z_OK);
    bytes.resize(size);
    return bytes;
}

std::vector<double> codes_of(const core::Json& array, const PageArrays& arrays) {
    const std::string bytes = bytes_of_array(arrays.html(), array["array"]);
    const std::size_t width = std::stoul(array["type"].get<std::string>().substr(1)) / 8;
    std::vector<double> codes;
    for (std::size_t i = 0; i < bytes.size(); i += width) {
        double code = 0.0;
        for (std::size_t k = width; k-- > 0;) {
            code = 256.0 * code + static_cast<unsigned char>(bytes[i + k]);
        }
        codes.push_back(code);
    }
    return codes;
}

// The values of a quantity, by the formulas of the page's script.
std::vector<double> values_of(const core::Json& quantity, const PageArrays& arrays) {
    const double most = quantity["type"] == "u8" ? 255.0 : 65535.0;
    const double low = quantity["low"];
    const double high = quantity["high"];
    std::vector<double> values = codes_of(quantity, arrays);
    for (double& value : values) {
        const double fraction = (value - 1.0) / (most - 1.0);
        if (quantity["coding"] == "linear") {
            value = value == 0.0 ? NAN : low + (high - low) * fraction;
        } else {
            value = value == 0.0 ? 0.0 : high * std::pow(low / high, 1.0 - fraction);
        }
    }
    return values;
}

TEST(Page, LinearCodesAreHalfAStepOff) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-3.0, 5.0);
    std::vector<double> values{NAN};
    for (int i = 0; i < 1000; ++i) values.push_back(uniform(random));
    const LinearCoding coding = coding_of(values);
    PageArrays arrays;
    const auto coarse = values_of(coding.add<std::uint8_t>(arrays, values), arrays);
    const auto fine = values_of(coding.add<std::uint16_t>(arrays, values), arrays);
    EXPECT_TRUE(std::isnan(coarse[0]) && std::isnan(fine[0]));
    const double half_step = 0.5 * (coding.high - coding.low);
    for (std::size_t i = 1; i < values.size(); ++i) {
        EXPECT_NEAR(coarse[i], values[i], half_step / 254.0 * (1.0 + 1e-12));
        EXPECT_NEAR(fine[i], values[i], half_step / 65534.0 * (1.0 + 1e-9));
    }
}

TEST(Page, CodesOfOneValueAndOfNoneAreFinite) {
    PageArrays arrays;
    const std::vector<double> same{2.5, 2.5};
    EXPECT_EQ(values_of(coding_of(same).add<std::uint8_t>(arrays, same), arrays), same);
    const std::vector<double> none{NAN, INFINITY};
    EXPECT_EQ(coding_of(none).low, 0.0);
    EXPECT_EQ(coding_of(none).high, 0.0);
}

TEST(Page, LogCodesKeepRatios) {
    const LogCoding coding{1e-5, 1.0};
    const double half_step = std::pow(1e5, 0.5 / 254.0);
    for (double value = 1e-5; value <= 1.0; value *= 1.01) {
        const double ratio = coding.decode(coding.encode(value)) / value;
        EXPECT_LT(std::max(ratio, 1.0 / ratio), half_step * (1.0 + 1e-12)) << value;
    }
    EXPECT_EQ(coding.encode(0.0), 0);
    EXPECT_EQ(coding.encode(-1.0), 0);
    EXPECT_EQ(coding.encode(1e-9), 0);
    EXPECT_EQ(coding.encode(7.0), 255);
    const LogCoding one{2.0, 2.0};
    EXPECT_DOUBLE_EQ(one.decode(one.encode(2.0)), 2.0);
}

TEST(Page, PointsLieInTheirBoxToASixtyThousandth) {
    std::mt19937 random(2);
    std::normal_distribution<double> normal;
    std::vector<core::Vec3> points;
    for (int i = 0; i < 100; ++i) points.emplace_back(normal(random), 3.0 * normal(random), 0.5);
    PageArrays arrays;
    const core::Json json = add_points(arrays, points);
    EXPECT_EQ(json["count"], points.size());
    const std::vector<double> codes = codes_of(json, arrays);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const double low = json["low"][i % 3];
        const double size = json["high"][i % 3].get<double>() - low;
        const double value = points[i / 3][static_cast<Eigen::Index>(i % 3)];
        EXPECT_NEAR(low + size * codes[i] / 65535.0, value, size / 65535.0 * 0.5001);
    }
}

core::Capture lit_capture(core::ScanPattern pattern, int num_bins = 5) {
    core::Capture capture = test_support::example_capture(pattern);
    capture.time_axis.num_bins = num_bins;
    capture.transient = core::Transient(capture.scan.num_pairs(), num_bins);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> light(0.5F, 1.0F);
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        const auto histogram = capture.transient.histogram(pair);
        std::fill(histogram.begin(), histogram.end(), 0.0F);
        for (std::size_t bin = 1; bin + 1 < histogram.size(); ++bin) histogram[bin] = light(random);
    }
    return capture;
}

TEST(Page, AnimationsShowEachPointsLightInTheWallsOrder) {
    const core::Capture capture = lit_capture(core::ScanPattern::Confocal);
    const AnimationView animation = animation_view(capture, "a.h5");
    PageArrays arrays;
    const core::Json json = animation_json(animation, core::Transform::Identity(), 0, arrays);
    ASSERT_EQ(json["kind"], "wall");
    const std::vector<double> values = values_of(json["values"], arrays);
    const nlos::WallGrid grid = *nlos::derive_wall_frame(capture.scan.wall()).grid;
    const std::size_t num_bins = capture.transient.num_bins() - 2;  // both ends are dark
    ASSERT_EQ(json["bins"], num_bins);
    EXPECT_DOUBLE_EQ(json["start"], capture.time_axis.bin_begin_m(1.0));
    for (std::size_t ix = 0; ix < grid.size[0]; ++ix) {
        for (std::size_t iy = 0; iy < grid.size[1]; ++iy) {
            for (std::size_t bin = 0; bin < num_bins; ++bin) {
                const double stored =
                    double{capture.transient.histogram(grid.point(ix, iy))[bin + 1]};
                const double shown = values[(ix * grid.size[1] + iy) * num_bins + bin];
                EXPECT_NEAR(shown / stored, 1.0, 0.01);
            }
        }
    }
}

TEST(Page, AnimationsOfExhaustiveScansAreOfTheMiddleIlluminationPoint) {
    const core::Capture capture = lit_capture(core::ScanPattern::Exhaustive);
    const AnimationView animation = animation_view(capture, "a.h5");
    const std::size_t middle = capture.scan.wall().illumination.size() / 2;
    const nlos::WallGrid grid = *nlos::derive_wall_frame(capture.scan.wall()).grid;
    const std::size_t pair = middle * capture.scan.wall().sensing.size() + grid.point(0, 0);
    EXPECT_NEAR(
        animation.coding.decode(animation.codes[0]) / double{capture.transient.histogram(pair)[1]},
        1.0,
        0.01);
    EXPECT_NE(animation.detail.find("lit at the middle one"), std::string::npos);
}

TEST(Page, AnimationsOfScansWithMoreLitThanSensingPointsAreOfTheLitOnes) {
    core::Capture capture = lit_capture(core::ScanPattern::Exhaustive);
    std::swap(capture.scan.wall().sensing, capture.scan.wall().illumination);
    const nlos::WallGrid grid = *nlos::derive_wall_frame(capture.scan.wall()).grid;
    const std::size_t num_sensing = capture.scan.wall().sensing.size();
    const std::size_t pair = grid.point(0, 0) * num_sensing + num_sensing / 2;
    const auto light = double{capture.transient.histogram(pair)[1]};
    AnimationView animation = animation_view(capture, "a.h5");
    EXPECT_NEAR(animation.coding.decode(animation.codes[0]) / light, 1.0, 0.01);
    EXPECT_NE(animation.detail.find("sensed at the middle one"), std::string::npos);
    capture.scan.wall().illumination.grid.reset();
    animation = animation_view(capture, "a.h5");
    EXPECT_EQ(animation.positions.size(), capture.scan.wall().illumination.size());
}

TEST(Page, HalvedAnimationsHoldTheSameLight) {
    const AnimationView animation =
        animation_view(lit_capture(core::ScanPattern::Confocal), "a.h5");
    const AnimationView half = halved(animation);
    EXPECT_EQ(half.num_bins, (animation.num_bins + 1) / 2);
    EXPECT_DOUBLE_EQ(half.step_m, 2.0 * animation.step_m);
    EXPECT_DOUBLE_EQ(half.start_m, animation.start_m);
    const auto light_of = [](const AnimationView& view) {
        double light = 0.0;
        for (const std::uint8_t code : view.codes) light += view.coding.decode(code);
        return light;
    };
    EXPECT_NEAR(light_of(half) / light_of(animation), 1.0, 0.005);
}

TEST(Page, DarkCapturesHaveDarkAnimations) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        for (float& value : capture.transient.histogram(pair)) value = 0.0F;
    }
    const AnimationView animation = animation_view(capture, "dark.h5");
    EXPECT_EQ(animation.num_bins, capture.transient.num_bins());
    EXPECT_TRUE(
        std::all_of(animation.codes.begin(), animation.codes.end(), [](auto c) { return c == 0; }));
    EXPECT_LT(animation.lit_bins[1], animation.num_bins);
}

TEST(Page, HalvedVolumesKeepTheirBrightestVoxels) {
    VolumeView volume;
    volume.size = {2, 3, 5};
    volume.centres_m = {{{0.0, 1.0}, {0.0, 2.0}, {1.0, 5.0}}};
    for (int i = 0; i < 30; ++i) volume.codes.push_back(static_cast<std::uint8_t>(7 * i % 31));
    const VolumeView half = halved(volume);
    EXPECT_EQ(half.size, (std::array<std::size_t, 3>{2, 3, 3}));
    EXPECT_EQ(half.merged, (std::array<std::size_t, 3>{1, 1, 2}));
    EXPECT_DOUBLE_EQ(half.centres_m[2][0], 1.5);
    EXPECT_DOUBLE_EQ(half.centres_m[2][1], 5.5);  // beyond the last voxel, which has no partner
    for (std::size_t column = 0; column < 6; ++column) {
        for (std::size_t z = 0; z < 3; ++z) {
            const std::uint8_t first = volume.codes[5 * column + 2 * z];
            const std::uint8_t second = z < 2 ? volume.codes[5 * column + 2 * z + 1] : 0;
            EXPECT_EQ(half.codes[3 * column + z], std::max(first, second));
        }
    }
}

TEST(Page, MapsOfAResultAreItsDepthsAndTheirErrors) {
    ResultView result = result_view(test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71}), "v.h5");
    result.truth = result.depth;
    for (double& depth : result.truth->depth_m) depth -= 0.002;
    PageArrays arrays;
    const core::Json json = result_json(
        result, map_scales({result}, result.truth), core::Transform::Identity(), 0, arrays);
    ASSERT_GE(json["maps"].size(), 3U);
    EXPECT_EQ(json["maps"][1]["name"], "Depth error");
    const std::vector<double> depths = values_of(json["maps"][0]["values"], arrays);
    const std::vector<double> errors = values_of(json["maps"][1]["values"], arrays);
    ASSERT_EQ(depths.size(), result.depth.depth_m.size());
    for (std::size_t i = 0; i < depths.size(); ++i) {
        if (std::isnan(result.depth.depth_m[i])) continue;
        EXPECT_NEAR(depths[i], result.depth.depth_m[i], 1e-6);
        EXPECT_NEAR(errors[i], 2.0, 1e-9);  // mm
    }
}

TEST(Page, LargeDataAreHalvedUntilTheyFitAndSaySo) {
    PageViews views;
    views.animations.push_back(
        animation_view(lit_capture(core::ScanPattern::Confocal, 500), "a.h5"));
    const FittedViews whole = fit_views(views, 1e9);
    EXPECT_EQ(whole.data.find("to keep the page small"), std::string::npos);
    EXPECT_EQ(whole.detail.halvings, 0);
    EXPECT_EQ(whole.whole_bytes, static_cast<double>(whole.data.size()));
    const double limit = 0.9 * whole.whole_bytes;
    const FittedViews small = fit_views(views, limit);
    EXPECT_NE(small.data.find("to keep the page small"), std::string::npos);
    EXPECT_LE(static_cast<double>(small.data.size()), limit);
    EXPECT_EQ(small.detail.most, 1U);
    EXPECT_EQ(small.whole_bytes, whole.whole_bytes);
}

TEST(Page, OfVeryManyResultsSomeAreShownAndTheBestAmongThem) {
    PageViews views;
    const auto volume = test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71});
    for (int i = 0; i < 40; ++i) {
        views.results.push_back(result_view(volume, "v" + std::to_string(i) + ".h5"));
    }
    views.best = 33;
    const double whole = fit_views(views, 1e9).whole_bytes;
    double last = whole;
    for (const double share : {0.5, 0.3}) {
        const FittedViews fitted = fit_views(views, share * whole);
        EXPECT_LE(static_cast<double>(fitted.data.size()), share * whole);
        EXPECT_LT(static_cast<double>(fitted.data.size()), last);
        last = static_cast<double>(fitted.data.size());
        EXPECT_LT(fitted.detail.most, 40U);
        EXPECT_GE(fitted.detail.most, 2U);
        std::size_t shown = 0;
        for (std::size_t i = 0; i < 40; ++i) shown += fitted.detail.shows_result(views, i) ? 1 : 0;
        EXPECT_EQ(shown, fitted.detail.most);
        EXPECT_NE(fitted.data.find("v33.h5"), std::string::npos);
        EXPECT_EQ(fitted.data.find("v39.h5"), std::string::npos);
        EXPECT_NE(fitted.data.find(fmt::format("\"best\":{}", fitted.detail.most - 1)),
                  std::string::npos);
    }
    const FittedViews none = fit_views(views, 10.0);
    EXPECT_FALSE(none.detail.has_views);
    EXPECT_EQ(none.html(), "");
}

TEST(Page, NamesCannotEndTheirScript) {
    PageViews views;
    views.animations.push_back(
        animation_view(lit_capture(core::ScanPattern::Confocal), "</script><script>alert(1)"));
    const std::string html = fit_views(views, 1e9).html();
    EXPECT_EQ(html.find("</script><script>alert"), std::string::npos);
    EXPECT_NE(html.find("\\u003c/script>\\u003cscript>alert(1)"), std::string::npos);
}

TEST(Page, NothingToSeeNeedsNoScript) {
    EXPECT_EQ(fit_views({}, 1e9).html(), "");
}

}  // namespace
}  // namespace apps
