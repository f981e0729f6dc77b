// SPDX-License-Identifier: MIT
// Calibration of simulated set-ups: peaks far below a bin, wall, galvo, boards, refusals.
#include "calib/calibrate.h"

#include "calib/fit.h"
#include "renderer/core/output_file.h"
#include "tests/support/error_message.h"
#include "tests/support/fit_examples.h"
#include "tests/support/statistics.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <random>

namespace {

using core::Vec2;
using core::Vec3;

constexpr double kBin_m = 0.0096;
constexpr double kSigma_m = 0.012;
constexpr double kZero_m = 0.0371;

struct Device {
    double distance_m = 1.0;
    double tilt_x = 0.0;
    double tilt_y = 0.0;
    double gain = 1.0;
};

// Commands on a grid that covers about 1 m of a wall 1 m away.
std::vector<std::array<double, 2>> command_grid(int n, double half) {
    std::vector<std::array<double, 2>> commands;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            commands.push_back(
                {half * (2.0 * i / (n - 1) - 1.0), half * (2.0 * j / (n - 1) - 1.0)});
        }
    }
    return commands;
}

Vec3 turned(const Device& device, const Vec3& d) {
    return Eigen::AngleAxisd(device.tilt_y, Vec3::UnitY()) *
           (Eigen::AngleAxisd(device.tilt_x, Vec3::UnitX()) * d);
}

Vec3 position_of(const Device& device) {
    return -device.distance_m * turned(device, Vec3(0.0, 0.0, -1.0));
}

Vec3 spot_of(const Device& device, const std::array<double, 2>& command) {
    const Vec3 beam = turned(
        device, Vec3(std::tan(device.gain * command[0]), std::tan(device.gain * command[1]), -1.0));
    const Vec3 from = position_of(device);
    return from - from.z() / beam.z() * beam;
}

// Counts of direct returns: photons per point, Gaussian response, a little ambient light.
core::Capture direct_returns(const std::vector<double>& opl_m,
                             double photons,
                             double tail_m,
                             const char* seed) {
    core::Capture capture;
    capture.time_axis = {1.0, kBin_m, 400};
    std::vector<Vec3> points(opl_m.size(), Vec3::Zero());
    capture.scan = test_support::confocal_scan(points);
    capture.transient = core::Transient(opl_m.size(), capture.time_axis.num_bins);
    capture.unit = core::TransientUnit::Counts;
    std::mt19937_64 engine(test_support::seed_of(seed));
    const auto share_below = [&](double delay) {
        return tail_m > 0.0 ? core::exponential_gaussian_cdf(delay, kSigma_m, tail_m)
                            : core::gaussian_cdf(delay, kSigma_m);
    };
    for (std::size_t p = 0; p < opl_m.size(); ++p) {
        for (int b = 0; b < capture.time_axis.num_bins; ++b) {
            const double mean =
                0.05 + photons * (share_below(capture.time_axis.bin_begin_m(b + 1) - opl_m[p]) -
                                  share_below(capture.time_axis.bin_begin_m(b) - opl_m[p]));
            capture.transient.histogram(p)[static_cast<std::size_t>(b)] =
                static_cast<float>(std::poisson_distribution<int>(mean)(engine));
        }
    }
    return capture;
}

std::vector<double> ranges_of(const Device& device,
                              const std::vector<std::array<double, 2>>& commands) {
    std::vector<double> opl;
    for (const auto& command : commands) {
        opl.push_back(kZero_m + 2.0 * (spot_of(device, command) - position_of(device)).norm());
    }
    return opl;
}

calib::SetupSettings setup_of(const std::vector<std::array<double, 2>>& commands) {
    calib::SetupSettings settings;
    settings.direct_returns = "test";
    settings.commands = commands;
    return settings;
}

TEST(DirectReturns, PeaksAreFoundFarBelowABinWithHonestErrors) {
    std::vector<double> opl;
    for (int i = 0; i < 60; ++i) opl.push_back(2.0 + 0.01337 * i);
    const auto capture = direct_returns(opl, 1000.0, 0.0, "PeaksAreFound");
    const auto result = calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian);
    double squared = 0.0;
    for (std::size_t i = 0; i < opl.size(); ++i) {
        EXPECT_LT(result.points[i].sigma_m, 0.06 * kBin_m);
        squared += std::pow((result.points[i].opl_m - opl[i]) / result.points[i].sigma_m, 2.0);
    }
    EXPECT_GT(test_support::chi_square_tail(squared, 60.0), 1e-4);
    EXPECT_LT(test_support::chi_square_tail(squared, 60.0), 1.0 - 1e-4);
    EXPECT_NEAR(result.sigma_m, kSigma_m, 4.0 * result.sigma_error_m);
    EXPECT_NEAR(result.ambient, 0.05, 4.0 * result.ambient_error + 1e-3);
}

TEST(DirectReturns, TailIsSeparatedFromTheCore) {
    const std::vector<double> opl(40, 2.2345);
    const auto capture = direct_returns(opl, 3000.0, 0.03, "TailIsSeparated");
    const auto result =
        calib::fit_direct_returns(capture, calib::ResponseShape::GaussianExponential);
    EXPECT_NEAR(result.tail_m, 0.03, 5.0 * result.tail_error_m);
    EXPECT_LT(result.tail_error_m, 1e-3);
    EXPECT_NEAR(result.points[7].opl_m, 2.2345, 5.0 * result.points[7].sigma_m);
    EXPECT_NEAR(result.deviance, result.expected_deviance, 0.15 * result.expected_deviance);
}

TEST(DirectReturns, ATailThatIsNotThereCostsNothing) {
    const std::vector<double> opl(30, 2.0);
    const core::Capture capture = direct_returns(opl, 1000.0, 0.0, "no tail");
    const auto gaussian = calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian);
    const auto tailed =
        calib::fit_direct_returns(capture, calib::ResponseShape::GaussianExponential);
    for (std::size_t p = 0; p < opl.size(); ++p) {
        EXPECT_LT(tailed.points[p].sigma_m, 6.0 * gaussian.points[p].sigma_m) << p;
        EXPECT_NEAR(tailed.points[p].opl_m, opl[p], 5.0 * tailed.points[p].sigma_m) << p;
    }
}

TEST(DirectReturns, AnEmptyHistogramIsNamed) {
    auto capture = direct_returns({2.0, 2.1}, 100.0, 0.0, "Empty");
    for (float& value : capture.transient.histogram(1)) value = 0.0F;
    EXPECT_ERROR_WITH(calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian),
                      "point 1");
}

TEST(Calibrate, TiltedWallMeetsTheTargets) {
    Device device;
    device.tilt_x = 0.5;
    const auto commands = command_grid(16, 0.46);
    const auto capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "TiltedWall");
    const calib::Calibration result = calib::calibrate(setup_of(commands), capture);
    EXPECT_NEAR(result.setup.values[0], 1.0, 0.0012);
    EXPECT_NEAR(result.setup.values[1], 0.5, 0.0006);
    EXPECT_NEAR(result.setup.values[2], 0.0, 0.0006);
    EXPECT_NEAR(result.setup.values[6], kZero_m, 0.0024);
    for (const std::size_t i : {0U, 1U, 2U, 6U}) {
        const double truth = i == 0 ? 1.0 : i == 1 ? 0.5 : i == 6 ? kZero_m : 0.0;
        EXPECT_NEAR(result.setup.values[i], truth, 4.5 * result.setup.sigma[i]);
    }
    for (std::size_t i = 0; i < commands.size(); ++i) {
        EXPECT_LT((result.setup.points_m[i] - spot_of(device, commands[i])).norm(), 0.003);
    }
}

TEST(Calibrate, FrontalWallWithOpenGainAndTimeZeroIsRefusedWithTheReason) {
    Device device;
    device.distance_m = 2.0;
    device.gain = 0.1;
    const auto commands = command_grid(12, 2.4);
    const auto capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "Frontal");
    calib::SetupSettings settings = setup_of(commands);
    settings.command_unit = calib::CommandUnit::Volt;
    std::string message;
    try {
        calib::calibrate(settings, capture);
    } catch (const core::Failure& failure) {
        message = failure.what();
    }
    EXPECT_NE(message.find("singular"), std::string::npos) << message;
    EXPECT_NE(message.find("known.galvo_gain"), std::string::npos) << message;

    settings.known.galvo_gain = calib::KnownValue{0.1, 1e-4};
    settings.known.time_zero_m = calib::KnownValue{kZero_m, 1e-3};
    const calib::Calibration result = calib::calibrate(settings, capture);
    EXPECT_NEAR(result.setup.values[0], 2.0, 4.0 * result.setup.sigma[0]);
    EXPECT_LT(result.setup.sigma[0], 0.01);
}

// A camera that looks at the wall from the device's side.
struct DrawnCamera {
    cv::Mat intrinsics = (cv::Mat_<double>(3, 3) << 1000, 0, 490, 0, 1010, 350, 0, 0, 1);
    cv::Size size{960, 720};
};

// A chessboard of 9 x 6 inner corners seen under a rotation and translation, with sensor noise.
void draw_board(const DrawnCamera& camera,
                const cv::Vec3d& rotation,
                const cv::Vec3d& translation,
                double square_m,
                const std::string& path,
                unsigned seed) {
    constexpr int kCell = 60;
    cv::Mat flat(9 * kCell, 12 * kCell, CV_8U, cv::Scalar(255));
    for (int j = 0; j < 7; ++j) {
        for (int i = 0; i < 10; ++i) {
            if ((i + j) % 2 != 0) continue;
            cv::rectangle(flat,
                          cv::Rect((i + 1) * kCell, (j + 1) * kCell, kCell, kCell),
                          cv::Scalar(0),
                          cv::FILLED);
        }
    }
    // Pixel centres are whole numbers: the first inner corner lies between pixels.
    cv::Mat board_from_flat = (cv::Mat_<double>(3, 3) << square_m / kCell,
                               0,
                               -square_m * (2.0 - 0.5 / kCell),
                               0,
                               square_m / kCell,
                               -square_m * (2.0 - 0.5 / kCell),
                               0,
                               0,
                               1);
    cv::Mat turn;
    cv::Rodrigues(rotation, turn);
    cv::Mat pose(3, 3, CV_64F);
    turn.col(0).copyTo(pose.col(0));
    turn.col(1).copyTo(pose.col(1));
    cv::Mat(translation).copyTo(pose.col(2));
    const cv::Mat map = camera.intrinsics * pose * board_from_flat;
    constexpr int kFiner = 3;  // drawn finer and averaged, so that edges are smooth
    const double offset = (kFiner - 1) / 2.0;
    const cv::Mat finer = (cv::Mat_<double>(3, 3) << kFiner, 0, offset, 0, kFiner, offset, 0, 0, 1);
    cv::Mat large;
    cv::warpPerspective(flat,
                        large,
                        finer * map,
                        camera.size * kFiner,
                        cv::INTER_LINEAR,
                        cv::BORDER_CONSTANT,
                        cv::Scalar(180));
    cv::Mat image;
    cv::resize(large, image, camera.size, 0, 0, cv::INTER_AREA);
    cv::Mat noise(image.size(), CV_16S);
    cv::RNG generator(seed);
    generator.fill(noise, cv::RNG::NORMAL, 0, 4);
    image.convertTo(image, CV_16S);
    image += noise;
    image.convertTo(image, CV_8U);
    cv::imwrite(path, image);
}

struct DrawnBoards {
    test_support::TemporaryFolder folder;
    calib::BoardSettings settings;
    DrawnCamera camera;
    cv::Vec3d wall_rotation{0.25, -0.2, 0.05};
    cv::Vec3d wall_translation{-0.35, -0.2, 1.6};

    DrawnBoards() {
        settings.square_m = 0.08;
        std::mt19937_64 engine(test_support::seed_of("DrawnBoards"));
        std::uniform_real_distribution<double> any(-1.0, 1.0);
        for (int i = 0; i < 9; ++i) {
            cv::Vec3d rotation{0.5 * any(engine), 0.5 * any(engine), 0.3 * any(engine)};
            cv::Vec3d translation{
                -0.35 + 0.15 * any(engine), -0.2 + 0.1 * any(engine), 1.5 + 0.2 * any(engine)};
            if (i == 0) {
                rotation = wall_rotation;
                translation = wall_translation;
            }
            settings.images.push_back(folder.file("board" + std::to_string(i) + ".png"));
            draw_board(camera,
                       rotation,
                       translation,
                       settings.square_m,
                       settings.images.back(),
                       static_cast<unsigned>(i + 1));
        }
    }

    // Wall's frame: x along the rows, y against the columns.
    Vec2 pixel_of(const Vec3& wall) const {
        std::vector<cv::Point2d> pixels;
        cv::projectPoints(std::vector<cv::Point3d>{{wall.x(), -wall.y(), -wall.z()}},
                          wall_rotation,
                          wall_translation,
                          camera.intrinsics,
                          cv::noArray(),
                          pixels);
        return {pixels[0].x, pixels[0].y};
    }
};

TEST(Boards, FocalLengthAndHomographyComeBack) {
    const DrawnBoards drawn;
    const calib::CameraCalibration camera = calib::calibrate_camera(drawn.settings);
    EXPECT_NEAR(camera.focal_x_px, 1000.0, 0.005 * 1000.0);
    EXPECT_NEAR(camera.focal_y_px, 1010.0, 0.005 * 1010.0);
    for (const double x : {0.0, 0.3, 0.6}) {
        for (const double y : {0.0, -0.2, -0.4}) {
            const Vec3 wall(x, y, 0.0);
            const Vec2 pixel = drawn.pixel_of(wall);
            EXPECT_LT((camera.project(wall) - pixel).norm(), 0.3);
            const Vec2 back = camera.wall_point(pixel);
            EXPECT_LT((camera.project(Vec3(back.x(), back.y(), 0.0)) - pixel).norm(), 0.01);
            EXPECT_LT((back - wall.head<2>()).norm(), 4e-4);
        }
    }
}

TEST(Boards, CameraResolvesWhatDirectReturnsCannot) {
    const DrawnBoards drawn;
    Device device;
    device.distance_m = 2.0;
    device.gain = 0.1;
    const auto commands = command_grid(8, 1.5);
    const auto capture = direct_returns(ranges_of(device, commands), 1000.0, 0.0, "Camera");
    calib::SetupSettings settings = setup_of(commands);
    settings.command_unit = calib::CommandUnit::Volt;
    settings.boards = drawn.settings;
    std::mt19937_64 engine(test_support::seed_of("CameraSpots"));
    std::normal_distribution<double> noise(0.0, 0.1);
    const Vec3 foot(0.32, -0.2, 0.0);
    for (const auto& command : commands) {
        const Vec2 pixel = drawn.pixel_of(spot_of(device, command) + foot);
        settings.spots_px.push_back({pixel.x() + noise(engine), pixel.y() + noise(engine)});
    }
    const calib::Calibration result = calib::calibrate(settings, capture);
    EXPECT_NEAR(result.setup.values[7], 0.1, 0.005 * 0.1);
    EXPECT_NEAR(result.setup.values[0], 2.0, 0.02);
    double squared = 0.0;
    for (std::size_t i = 0; i < commands.size(); ++i) {
        squared += (result.setup.points_m[i] - foot - spot_of(device, commands[i])).squaredNorm();
    }
    EXPECT_LT(std::sqrt(squared / static_cast<double>(commands.size())), 0.001);
}

calib::AppliedCalibration read_back(const calib::Calibration& calibration) {
    const test_support::TemporaryFolder folder;
    core::write_text_file(folder.file("c.json"), calib::calibration_json(calibration).dump());
    return calib::read_calibration(folder.file("c.json"));
}

TEST(Calibrate, ResultServesRenderReconstructAndFit) {
    Device device;
    device.tilt_x = 0.5;
    const auto commands = command_grid(6, 0.4);
    const auto capture = direct_returns(ranges_of(device, commands), 5000.0, 0.0, "Serves");
    const calib::Calibration result = calib::calibrate(setup_of(commands), capture);
    const calib::AppliedCalibration applied = read_back(result);

    // Recording and undoing it leaves the light where it was, up to the response.
    core::Capture rendered;
    rendered.scan = test_support::confocal_grid(6);
    calib::replace_points(applied, rendered.scan);
    const core::TimeAxis axis{3.0, kBin_m, 200};
    rendered.time_axis = calib::axis_to_render(applied, axis);
    rendered.transient = core::Transient(36, rendered.time_axis.num_bins);
    constexpr double kPath_m = 1.7;
    for (std::size_t p = 0; p < 36; ++p) {
        const int bin = *rendered.time_axis.bin_of(kPath_m);
        rendered.transient.histogram(p)[static_cast<std::size_t>(bin)] = 1.0F;
    }
    core::Capture recorded = calib::record_with(applied, rendered, axis);
    recorded.variance = recorded.transient;  // of light where it was
    const core::Capture undone = calib::apply_calibration(applied, recorded);
    EXPECT_FALSE(undone.variance.has_value());
    for (const std::size_t p : {0U, 20U, 35U}) {
        double sum = 0.0;
        double moment = 0.0;
        for (int b = 0; b < undone.time_axis.num_bins; ++b) {
            const double light =
                static_cast<double>(undone.transient.histogram(p)[static_cast<std::size_t>(b)]);
            sum += light;
            moment += light * undone.time_axis.bin_center_m(b);
        }
        EXPECT_NEAR(sum, 1.0, 1e-4);
        const double bin = *rendered.time_axis.bin_of(kPath_m);
        EXPECT_NEAR(moment / sum, rendered.time_axis.bin_center_m(bin), 1e-4);
    }

    // What was observed moves with the light.
    core::restrict_observed(recorded, {40, 160});
    const core::Capture gated = calib::apply_calibration(applied, recorded);
    core::validate(gated, "gated");
    int num_whole = 0;  // the others begin before the axis
    for (std::size_t p = 0; p < 36; ++p) {
        const core::BinRange range = gated.observed_range(p);
        EXPECT_LE(range.size(), 120);
        if (range.begin > 0) {
            EXPECT_GE(range.size(), 119);
            ++num_whole;
        }
        for (int b = range.begin; b < range.end; ++b) {
            const auto i = static_cast<std::size_t>(b);
            EXPECT_EQ(gated.transient.histogram(p)[i], undone.transient.histogram(p)[i]);
        }
    }
    EXPECT_GT(num_whole, 3);
}

// Counts of a hidden rectangle as the true device records them.
core::Capture counts_through(const Device& device,
                             const std::vector<std::array<double, 2>>& commands,
                             const renderer::SceneGeometry& hidden) {
    std::vector<Vec3> spots;
    for (const auto& command : commands) spots.push_back(spot_of(device, command));
    const core::Scan scan = test_support::confocal_scan(spots);
    calib::FitSettings settings;
    settings.free.ambient = false;
    settings.free.objects = {{"target", true, false, false, false, false}};
    const calib::SceneModel model(hidden, settings, false);
    calib::ForwardSettings forward;
    forward.axis = {2.5, kBin_m, 400};
    forward.sigma_m = kSigma_m;
    forward.offset_m = ranges_of(device, commands);
    calib::ForwardModel light(model, scan, calib::WallMotion(scan), forward);
    light.refresh(model.start());
    light.update(model.start(), renderer::Gradients::Without);
    core::Capture capture;
    capture.scan = test_support::confocal_grid(static_cast<int>(std::sqrt(commands.size())));
    capture.time_axis = forward.axis;
    capture.unit = core::TransientUnit::Counts;
    capture.transient = core::Transient(commands.size(), forward.axis.num_bins);
    std::mt19937_64 engine(test_support::seed_of("CountsThrough"));
    calib::PairModel pair;
    for (std::size_t p = 0; p < commands.size(); ++p) {
        light.evaluate(p, pair);
        for (std::size_t b = 0; b < pair.mean.size(); ++b) {
            constexpr double kCountsPerLight = 2e4;
            capture.transient.histogram(p)[b] = static_cast<float>(
                std::poisson_distribution<int>(0.1 + kCountsPerLight * pair.mean[b])(engine));
        }
    }
    return capture;
}

TEST(Calibrate, AFitThroughTheResultFindsTheHiddenScene) {
    Device device;
    device.tilt_x = 0.5;
    const auto commands = command_grid(8, 0.4);
    const auto peaks = direct_returns(ranges_of(device, commands), 5000.0, 0.0, "FitThrough");
    const calib::Calibration calibration = calib::calibrate(setup_of(commands), peaks);
    const calib::AppliedCalibration applied = read_back(calibration);

    const Vec3 center(0.05, -0.02, 0.7);
    renderer::SceneGeometry hidden;
    hidden.objects = {test_support::tilted_rectangle("target", center, 0.4)};
    const core::Capture counts = counts_through(device, commands, hidden);
    renderer::SceneGeometry start;
    start.objects = {
        test_support::tilted_rectangle("target", center + Vec3(0.03, -0.03, 0.04), 0.3)};
    calib::FitInput input = test_support::fit_input(counts, start);
    calib::replace_points(applied, input.capture.scan);
    input.offset_m = calib::pair_offsets(applied, input.capture.scan);
    input.settings.response = applied.response;
    const calib::FitResult fit = calib::fit_scene(input, {});
    ASSERT_TRUE(fit.converged) << fit.message;
    EXPECT_LT((fit.objects[0].position_m - center).norm(), 0.002);
    // Without the calibration the device's legs are missing, and the light is nowhere near.
    EXPECT_ERROR_WITH(calib::fit_scene(test_support::fit_input(counts, start), {}), "time axis");
}

TEST(Calibrate, BoardsWithoutImagesAreNoCamera) {
    const test_support::TemporaryFolder folder;
    core::write_text_file(folder.file("setup.json"),
                          R"({"direct_returns": "d.h5", "boards": {"images": []}})");
    EXPECT_FALSE(calib::read_setup(folder.file("setup.json"), {}).boards);
}

TEST(Calibrate, ListsOfDifferentLengthsAreNamed) {
    const auto commands = command_grid(3, 0.4);
    const auto capture = direct_returns({2.0, 2.1}, 100.0, 0.0, "Lengths");
    EXPECT_ERROR_WITH(calib::calibrate(setup_of(commands), capture), "commands: found 9");
}

}  // namespace
