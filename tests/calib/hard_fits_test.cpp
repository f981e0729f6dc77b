// SPDX-License-Identifier: MIT
// Hard cases: each ends in a result whose reported errors are honest, in a warning, or in a
// refusal.
#include "calib/fit.h"
#include "tests/support/error_message.h"
#include "tests/support/fit_examples.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace {

using test_support::counted;

using core::Vec3;

const Vec3 kCenter(0.05, -0.02, 0.8);

Eigen::Quaterniond turn(double degrees, const Vec3& axis) {
    return Eigen::Quaterniond(
        Eigen::AngleAxisd(degrees / core::kDegreesPerRadian, axis.normalized()));
}

renderer::Object rectangle(const std::string& name,
                           const Vec3& center,
                           const Eigen::Quaterniond& rotation,
                           double width_m = 0.4,
                           double height_m = 0.3) {
    const Vec3 u = rotation * Vec3(width_m, 0.0, 0.0);
    const Vec3 v = rotation * Vec3(0.0, height_m, 0.0);
    renderer::Object object =
        test_support::parallelogram_object({center - 0.5 * (u + v), u, v, 0.5});
    object.name = name;
    object.world_from_node.linear() = rotation.toRotationMatrix();
    object.world_from_node.translation() = center;
    return object;
}

renderer::SceneGeometry only(const renderer::Object& object) {
    renderer::SceneGeometry geometry;
    geometry.objects = {object};
    return geometry;
}

renderer::Object tilted(double degrees, double width_m = 0.4) {
    return rectangle("target", kCenter, turn(degrees, Vec3(0.6, 0.8, 0.0)), width_m);
}

renderer::Object nearby_start(double degrees, double width_m = 0.4) {
    return rectangle("target",
                     kCenter + Vec3(-0.02, 0.02, -0.02),
                     turn(degrees - 5.0, Vec3(0.7, 0.7, 0.0)),
                     width_m);
}

core::Capture light_of(const renderer::SceneGeometry& geometry,
                       double photons,
                       double ambient,
                       int points = 8) {
    return test_support::expected_capture(
        geometry, test_support::confocal_grid(points), photons, ambient);
}

core::Capture with_bins(const core::Capture& capture, int begin, int end) {
    core::Capture cut = capture;
    cut.time_axis.opl_start_m = capture.time_axis.bin_begin_m(begin);
    cut.time_axis.num_bins = end - begin;
    cut.transient = core::Transient(capture.transient.num_pairs(), end - begin);
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        const auto from = capture.transient.histogram(pair);
        std::copy(from.begin() + begin, from.begin() + end, cut.transient.histogram(pair).begin());
    }
    return cut;
}

// Turn about the world's axes from truth to fit, the smallest modulo a rectangle's half turns.
Vec3 turn_error(const Eigen::Quaterniond& fitted, const Eigen::Quaterniond& truth) {
    Vec3 least = Vec3::Constant(10.0);
    for (const Vec3& axis : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        const Eigen::Quaterniond half =
            axis.isZero() ? Eigen::Quaterniond::Identity() : turn(180.0, axis);
        Eigen::Quaterniond difference = fitted * half * truth.inverse();
        if (difference.w() < 0.0) difference.coeffs() *= -1.0;
        const Eigen::AngleAxisd angle_axis(difference);
        const Vec3 error = angle_axis.angle() * angle_axis.axis();
        if (error.norm() < least.norm()) least = error;
    }
    return least;
}

// Errors of position [m] and turn about the world's axes [rad].
Eigen::Matrix<double, 6, 1> pose_error(const calib::FitResult& fit, const renderer::Object& truth) {
    const auto object = std::find_if(fit.objects.begin(), fit.objects.end(), [&](const auto& o) {
        return o.name == truth.name;
    });
    Eigen::Matrix<double, 6, 1> error;
    error << object->position_m - truth.world_from_node.translation(),
        turn_error(object->rotation, Eigen::Quaterniond(truth.world_from_node.rotation()));
    return error;
}

// Squared error of an object's pose in units of the reported covariance: chi-square with 6 degrees
// of freedom when that is honest.
double normalised_square(const calib::FitResult& fit, const renderer::Object& truth) {
    const auto first = std::find(fit.parameters.begin(), fit.parameters.end(), truth.name + ".x") -
                       fit.parameters.begin();
    const Eigen::Matrix<double, 6, 1> error = pose_error(fit, truth);
    const Eigen::MatrixXd covariance = fit.covariance.block(first, first, 6, 6);
    return error.dot(covariance.ldlt().solve(error));
}

struct Case {
    std::string name;
    renderer::SceneGeometry truth;
    renderer::SceneGeometry start;
    double photons = 1e5;
    double ambient = 1.0;
    int seeds = 6;
    int points = 8;  ///< of the wall, on a side
    std::function<void(calib::FitInput&)> adapt = [](calib::FitInput&) {};
};

// Fits several drawings and calls check on each; mean normalised square per degree of freedom.
double mean_square(const Case& wanted, const std::function<void(const calib::FitResult&)>& check) {
    const core::Capture light =
        light_of(wanted.truth, wanted.photons, wanted.ambient, wanted.points);
    double sum = 0.0;
    for (int seed = 0; seed < wanted.seeds; ++seed) {
        calib::FitInput input = test_support::fit_input(
            counted(light, wanted.name + std::to_string(seed)), wanted.start);
        wanted.adapt(input);
        const calib::FitResult fit = calib::fit_scene(input, {});
        EXPECT_TRUE(fit.converged) << fit.message;
        for (const renderer::Object& object : wanted.truth.objects) {
            sum += normalised_square(fit, object);
        }
        check(fit);
    }
    return sum / (6.0 * wanted.seeds * static_cast<double>(wanted.truth.objects.size()));
}

double chi_square_p(double mean, double degrees) {
    const double tail = test_support::chi_square_tail(mean * degrees, degrees);
    return 2.0 * std::min(tail, 1.0 - tail);
}

void expect_no_warning(const calib::FitResult& fit) {
    EXPECT_TRUE(fit.warnings.empty()) << fit.warnings.front();
}

TEST(HardFit, GrazingTiltHasHonestErrors) {
    for (const double degrees : {70.0, 85.0}) {
        const Case grazing{"Grazing" + std::to_string(degrees),
                           only(tilted(degrees)),
                           only(nearby_start(degrees))};
        const double mean = mean_square(grazing, expect_no_warning);
        EXPECT_GT(chi_square_p(mean, 36.0), 1e-3) << degrees << " degrees: " << mean;
    }
}

TEST(HardFit, ANearlySquareObjectEndsOnItsRightSide) {
    renderer::Object wrong = nearby_start(25.0, 0.31);
    const Eigen::Quaterniond quarter =
        Eigen::Quaterniond(wrong.world_from_node.rotation()) * turn(85.0, Vec3::UnitZ());
    wrong = rectangle("target", wrong.world_from_node.translation(), quarter, 0.31);
    const Case square{"NearlySquare", only(tilted(25.0, 0.31)), only(wrong)};
    const double mean = mean_square(square, expect_no_warning);
    EXPECT_GT(chi_square_p(mean, 36.0), 1e-3) << mean;
}

TEST(HardFit, ANearlySquareObjectWithFewPhotonsIsCalledAmbiguous) {
    const core::Capture light = light_of(only(tilted(25.0, 0.31)), 1000.0, 0.02);
    int ambiguous = 0;
    for (int seed = 0; seed < 6; ++seed) {
        const calib::FitResult fit = calib::fit_scene(
            test_support::fit_input(counted(light, "Ambiguous" + std::to_string(seed)),
                                    only(nearby_start(25.0, 0.31))),
            {});
        if (test_support::mentions(fit.warnings, "another pose")) ++ambiguous;
    }
    EXPECT_GE(ambiguous, 4);
}

TEST(HardFit, OneHundredPhotonsGiveWideErrorsAndSayWhy) {
    const core::Capture light = light_of(only(tilted(25.0)), 100.0, 0.0125, 5);
    const renderer::Object truth = tilted(25.0);
    constexpr int kFits = 4;
    double squares = 0.0;
    for (int seed = 0; seed < kFits; ++seed) {
        const calib::FitResult fit = calib::fit_scene(
            test_support::fit_input(counted(light, "Hundred" + std::to_string(seed)),
                                    only(nearby_start(25.0))),
            {});
        EXPECT_TRUE(test_support::mentions(fit.warnings, "photons: the reported errors"));
        const calib::FittedObject& object = fit.objects[0];
        EXPECT_GT(object.position_sigma_m.norm(), 0.01);
        const Vec3 error = object.position_m - truth.world_from_node.translation();
        const Vec3 turned =
            core::kDegreesPerRadian *
            turn_error(object.rotation, Eigen::Quaterniond(truth.world_from_node.rotation()));
        squares += error.cwiseQuotient(object.position_sigma_m).squaredNorm() +
                   turned.cwiseQuotient(object.rotation_sigma_deg).squaredNorm();
    }
    EXPECT_LT(squares / (6.0 * kFits), 1.7);
    EXPECT_GT(squares / (6.0 * kFits), 0.4);
}

TEST(HardFit, AWrongResponseWidthIsNamed) {
    for (const double fwhm_ps : {60.0, 140.0}) {
        Case wrong{"Width", only(tilted(25.0)), only(nearby_start(25.0)), 1e5, 1.0, 3};
        wrong.adapt = [&](calib::FitInput& input) {
            input.settings.response.jitter_fwhm_ps = fwhm_ps;
        };
        mean_square(wrong, [&](const calib::FitResult& fit) {
            EXPECT_TRUE(test_support::mentions(
                fit.warnings, "the response's width: " + std::string(fwhm_ps < 94.0 ? "+" : "-")));
        });
        wrong.adapt = [&](calib::FitInput& input) {
            input.settings.response.jitter_fwhm_ps = fwhm_ps;
            input.settings.free.parameters.insert("response_fwhm");
        };
        const double mean = mean_square(wrong, [](const calib::FitResult& fit) {
            expect_no_warning(fit);
            EXPECT_NEAR(fit.estimates["response_fwhm_ps"].value,
                        94.0,
                        4.5 * fit.estimates["response_fwhm_ps"].sigma);
        });
        EXPECT_GT(chi_square_p(mean, 18.0), 1e-3) << mean;
    }
}

TEST(HardFit, WildWallPointsAreNamedAndALossDisarmsThem) {
    const core::Capture light = light_of(only(tilted(25.0)), 1e5, 1.0);
    double squares = 0.0;
    constexpr int kFits = 5;
    for (int seed = 0; seed < kFits; ++seed) {
        core::Capture capture = counted(light, "Wild" + std::to_string(seed));
        for (const std::size_t pair : {3U, 17U, 40U}) {
            const auto histogram = capture.transient.histogram(pair);
            for (std::size_t b = 0; b < histogram.size() / 2; ++b) histogram[b] += 20.0F;
        }
        calib::FitInput input = test_support::fit_input(capture, only(nearby_start(25.0)));
        EXPECT_TRUE(test_support::mentions(calib::fit_scene(input, {}).warnings, "(3, 17, 40)"));
        input.settings.loss = calib::LossKind::Huber;
        const calib::FitResult held = calib::fit_scene(input, {});
        EXPECT_EQ(held.warnings.size(), 1U);
        EXPECT_TRUE(test_support::mentions(held.warnings, "the loss gives them little weight"));
        squares += normalised_square(held, tilted(25.0));
    }
    EXPECT_GT(chi_square_p(squares / (6.0 * kFits), 6.0 * kFits), 1e-3) << squares;
}

TEST(HardFit, LightBeyondEitherEndOfTheAxisIsHonestAndSaid) {
    // The object's light covers bins 31 to 68.
    for (const auto& [begin, end] : {std::pair{0, 46}, std::pair{42, 120}}) {
        const core::Capture light = with_bins(light_of(only(tilted(25.0)), 1e5, 1.0), begin, end);
        double squares = 0.0;
        constexpr int kFits = 5;
        for (int seed = 0; seed < kFits; ++seed) {
            const calib::FitResult fit = calib::fit_scene(
                test_support::fit_input(counted(light, "Cut" + std::to_string(begin + seed)),
                                        only(nearby_start(25.0))),
                {});
            EXPECT_TRUE(test_support::mentions(fit.warnings,
                                               begin == 0 ? "beyond the end" : "beyond the begin"));
            squares += normalised_square(fit, tilted(25.0));
        }
        EXPECT_GT(chi_square_p(squares / (6.0 * kFits), 6.0 * kFits), 1e-3) << squares;
    }
}

TEST(HardFit, DataWithoutTheObjectAreRefused) {
    const core::Capture dark =
        with_bins(counted(light_of(only(tilted(25.0)), 1e5, 1.0), "Dark"), 80, 120);
    const auto near_end = rectangle("target", Vec3(0.0, 0.0, 1.3), turn(5.0, Vec3::UnitX()));
    const calib::FitResult fit =
        calib::fit_scene(test_support::fit_input(dark, only(near_end)), {});
    EXPECT_FALSE(fit.converged);
    EXPECT_NE(fit.message.find("no light"), std::string::npos) << fit.message;
}

TEST(HardFit, AStartWithoutLightOnTheAxisIsRefused) {
    const core::Capture capture = counted(light_of(only(tilted(25.0)), 1e5, 1.0), "Outside");
    const auto start = rectangle("target", Vec3(0.0, 0.0, 1.9), turn(5.0, Vec3::UnitX()));
    EXPECT_ERROR_WITH(calib::fit_scene(test_support::fit_input(capture, only(start)), {}),
                      "start: search");
}

TEST(HardFit, AStartThroughTheWallThatLeavesTheDataDoesNotConverge) {
    const core::Capture capture = counted(light_of(only(tilted(25.0)), 1e5, 1.0), "Straddling");
    const auto start = rectangle("target", Vec3(0.0, 0.0, 0.02), turn(60.0, Vec3::UnitX()));
    const calib::FitResult fit =
        calib::fit_scene(test_support::fit_input(capture, only(start)), {});
    EXPECT_FALSE(fit.converged);
    EXPECT_FALSE(fit.message.empty());
}

// A rectangle partly behind another.
Case overlapping(const std::string& name, int seeds) {
    Case two{name, {}, {}, 2e5, 1.0, seeds, 6};
    two.truth.objects = {
        rectangle("front", Vec3(0.0, 0.0, 0.7), turn(20.0, Vec3(0.6, 0.8, 0.0))),
        rectangle("back", Vec3(0.08, 0.05, 0.85), turn(-15.0, Vec3(0.8, -0.6, 0.0)), 0.3, 0.25)};
    two.start.objects = {
        rectangle("front", Vec3(0.02, -0.015, 0.71), turn(25.0, Vec3(0.7, 0.7, 0.0))),
        rectangle("back", Vec3(0.065, 0.07, 0.835), turn(-19.0, Vec3(0.7, -0.7, 0.0)), 0.3, 0.25)};
    return two;
}

TEST(HardFit, OverlappingObjectsThatHideOneAnotherAreFound) {
    Case two = overlapping("Overlapping", 2);
    two.adapt = [](calib::FitInput& input) {
        input.settings.free.objects.push_back({"back", {"pose", "albedo"}});
    };
    double sum = 0.0;
    const double mean = mean_square(two, [&](const calib::FitResult& fit) {
        expect_no_warning(fit);
        for (std::size_t o = 0; o < 2; ++o) {
            sum += (fit.objects[o].position_m - two.truth.objects[o].world_from_node.translation())
                       .squaredNorm();
        }
    });
    EXPECT_LT(std::sqrt(sum / (2.0 * two.seeds)), 0.0016);
    EXPECT_GT(chi_square_p(mean, 24.0), 1e-3) << mean;
}

// With visibility frozen the errors are up to three times the reported ones, and the fits four
// times as far off.
TEST(HardFit, MovingShadowEdgesCountInFitsAndTheirErrors) {
    Case one = overlapping("ShadowEdges", 10);
    const renderer::Object back = one.truth.objects[1];
    one.start.objects = {
        one.truth.objects[0],
        rectangle("back", Vec3(0.075, 0.055, 0.845), turn(-17.0, Vec3(0.8, -0.6, 0.0)), 0.3, 0.25)};
    const core::Capture light = light_of(one.truth, one.photons, one.ambient, 6);
    Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();
    Eigen::Matrix<double, 6, 1> variances = squares;
    for (int seed = 0; seed < one.seeds; ++seed) {
        calib::FitInput input =
            test_support::fit_input(counted(light, one.name + std::to_string(seed)), one.start);
        input.settings.free.objects = {{"back", {"pose", "albedo"}}};
        input.settings.blur_schedule_m = {0.0};
        const calib::FitResult fit = calib::fit_scene(input, {});
        expect_no_warning(fit);
        squares += pose_error(fit, back).cwiseAbs2();
        variances += fit.covariance.topLeftCorner<6, 6>().diagonal();
    }
    for (int i = 0; i < 6; ++i) {
        const double ratio = std::sqrt(squares[i] / variances[i]);
        EXPECT_GT(ratio, 0.45) << i;  // 2.5 standard deviations of 10 fits
        EXPECT_LT(ratio, 1.55) << i;
    }
    const double all = std::sqrt(squares.cwiseQuotient(variances).mean());
    EXPECT_GT(all, 0.75);
    EXPECT_LT(all, 1.25);
}

TEST(HardFit, RenderedLightBehindAnOccluderIsFittedByAnotherMesh) {
    renderer::SceneGeometry truth = only(tilted(25.0));
    truth.objects.push_back(
        rectangle("occluder", Vec3(0.12, -0.1, 0.45), turn(0.0, Vec3::UnitX()), 0.1, 0.075));
    const core::WallScan scan = test_support::confocal_grid(8);
    renderer::RenderSettings render_settings;
    render_settings.method = renderer::Estimator::Path;
    render_settings.samples = 32768;
    core::Capture capture =
        renderer::render(
            renderer::Scene(truth, scan, {}), scan, test_support::kFitAxis, render_settings, {})
            .capture;
    const core::ResponseFilter response = core::sample_response(
        core::GaussianResponse{core::sigma_m_from_fwhm_ps(test_support::kFitFwhm_ps)},
        test_support::kFitAxis.bin_width_m);
    double total = 0.0;
    for (const float value : capture.transient.values()) total += value;
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const auto histogram = capture.transient.histogram(pair);
        const std::vector<float> sharp(histogram.begin(), histogram.end());
        core::apply_filter<float, float>(response, sharp, histogram);
        for (float& value : histogram) value = static_cast<float>(value * 1e5 / total + 1.0);
    }
    capture.unit = core::TransientUnit::Counts;
    renderer::SceneGeometry start = only(nearby_start(25.0));
    start.objects.push_back(truth.objects[1]);
    const calib::FitResult fit =
        calib::fit_scene(test_support::fit_input(counted(capture, "Rendered"), start), {});
    EXPECT_TRUE(fit.converged);
    EXPECT_LT((fit.objects[0].position_m - kCenter).norm(), 0.0025);
    EXPECT_NEAR(fit.deviance / fit.expected_deviance, 1.0, 0.05);
}

}  // namespace
