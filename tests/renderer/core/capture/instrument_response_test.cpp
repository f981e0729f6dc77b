// SPDX-License-Identifier: MIT
#include "renderer/core/capture/instrument_response.h"

#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace core {
namespace {

constexpr double kWidth_m = 0.008;

/// Moments of the weights, in metres.
ResponseMoments moments_of(const ResponseFilter& filter, double bin_width_m) {
    MeasuredResponse points;
    for (std::size_t k = 0; k < filter.weights.size(); ++k) {
        points.delays_m.push_back((filter.first_delay + static_cast<double>(k)) * bin_width_m);
        points.weights.push_back(filter.weights[k]);
    }
    return moments(points);
}

double sum_of(const ResponseFilter& filter) {
    return std::accumulate(filter.weights.begin(), filter.weights.end(), 0.0);
}

TEST(InstrumentResponse, WeightsHaveTheMomentsOfTheResponse) {
    for (const double sigma_m : {0.002, 0.005, 0.012, 0.03}) {
        for (const double tail_m : {0.0, 0.004, 0.06}) {
            const InstrumentResponse response =
                tail_m > 0.0 ? InstrumentResponse(ExponentialGaussianResponse{sigma_m, tail_m})
                             : InstrumentResponse(GaussianResponse{sigma_m});
            const ResponseFilter filter = sample_response(response, kWidth_m);
            const ResponseMoments wanted = moments(response);
            const ResponseMoments found = moments_of(filter, kWidth_m);
            SCOPED_TRACE(testing::Message() << "sigma " << sigma_m << " tail " << tail_m);
            EXPECT_NEAR(sum_of(filter), 1.0, 1e-12);
            EXPECT_NEAR(found.mean_m, wanted.mean_m, 1e-9);
            // A tail without much of a core is wider once split between bins.
            const bool can_be_narrowed = tail_m == 0.0 || sigma_m >= 0.005;
            if (can_be_narrowed) {
                EXPECT_NEAR(found.variance_m2, wanted.variance_m2, 1e-6 * wanted.variance_m2);
                EXPECT_NEAR(found.third_central_m3,
                            wanted.third_central_m3,
                            0.02 * std::pow(wanted.variance_m2, 1.5));
            }
            EXPECT_GE(found.variance_m2, wanted.variance_m2 * (1.0 - 1e-6));
        }
    }
}

TEST(InstrumentResponse, NoWidthChangesNothing) {
    const ResponseFilter filter = sample_response(GaussianResponse{}, kWidth_m);
    EXPECT_EQ(filter.first_delay, 0);
    EXPECT_EQ(filter.weights, std::vector<double>{1.0});
}

TEST(InstrumentResponse, DistributionsAreDerivativesOfTheirRamps) {
    const double step = 1e-5;
    for (const double sigma : {0.3, 1.0}) {
        for (const double tail : {0.02, 0.5, 4.0}) {
            for (double u = -6.0 * sigma; u < 8.0; u += 0.37) {
                const auto gaussian = [&](double x) { return gaussian_ramp(x, sigma); };
                const auto ramp = [&](double x) {
                    return exponential_gaussian_ramp(x, sigma, tail);
                };
                EXPECT_NEAR((gaussian(u + step) - gaussian(u - step)) / (2.0 * step),
                            gaussian_cdf(u, sigma),
                            1e-9);
                EXPECT_NEAR((ramp(u + step) - ramp(u - step)) / (2.0 * step),
                            exponential_gaussian_cdf(u, sigma, tail),
                            1e-8);
            }
        }
    }
}

TEST(InstrumentResponse, ExponentialCoreIsTheConvolutionOfItsParts) {
    const double sigma = 0.7;
    const double tail = 1.3;
    for (const double u : {-1.5, 0.0, 0.8, 3.0}) {
        double integral = 0.0;
        const double step = 1e-3;
        for (double t = 0.5 * step; t < 40.0; t += step) {
            integral += step * std::exp(-t / tail) / tail * gaussian_cdf(u - t, sigma);
        }
        EXPECT_NEAR(exponential_gaussian_cdf(u, sigma, tail), integral, 1e-6);
    }
}

TEST(InstrumentResponse, ScaledProbabilityIsContinuousWhereItsFormsMeet) {
    const double below = scaled_normal_cdf(-25.0 - 1e-12);
    const double above = scaled_normal_cdf(-25.0 + 1e-12);
    EXPECT_NEAR(below / above, 1.0, 3e-11);
}

TEST(InstrumentResponse, FilterMovesLightByItsDelays) {
    ResponseFilter filter{-1, {0.25, 0.5, 0.25}};
    const std::vector<float> input{0.0F, 4.0F, 0.0F, 0.0F, 8.0F};
    std::vector<double> output(input.size());
    apply_filter<float, double>(filter, input, output);
    EXPECT_EQ(output, (std::vector<double>{1.0, 2.0, 1.0, 2.0, 4.0}));
    filter = {2, {1.0}};
    apply_filter<float, double>(filter, input, output);
    EXPECT_EQ(output, (std::vector<double>{0.0, 0.0, 0.0, 4.0, 0.0}));
    filter = {-7, {1.0}};
    apply_filter<float, double>(filter, input, output);
    EXPECT_EQ(output, std::vector<double>(5, 0.0));
}

TEST(InstrumentResponse, BlurBeforeAndAfterBinningAgree) {
    // A Gaussian bump, blurred: bins of the exact result against blurred bins.
    const double bump_m = 0.02;
    const double sigma_m = 0.011;
    const auto bins_of = [&](double width, int count) {
        std::vector<double> bins;
        for (int i = 0; i < count; ++i) {
            const double begin = i * kWidth_m - 0.4;
            bins.push_back(gaussian_cdf(begin + kWidth_m, width) - gaussian_cdf(begin, width));
        }
        return bins;
    };
    const std::vector<double> sharp = bins_of(bump_m, 100);
    const std::vector<double> exact = bins_of(std::hypot(bump_m, sigma_m), 100);
    std::vector<double> blurred(sharp.size());
    apply_filter<double, double>(
        sample_response(GaussianResponse{sigma_m}, kWidth_m), sharp, blurred);
    for (std::size_t i = 0; i < sharp.size(); ++i) EXPECT_NEAR(blurred[i], exact[i], 1e-4);
}

TEST(InstrumentResponse, MeasuredCurveKeepsItsMeanBelowABin) {
    const test_support::TemporaryFolder folder;
    const std::string path = folder.file("curve.txt");
    test_support::write_file_bytes(path, "# delay weight\n-10 1\n0 6\n\n25 3\n");
    const InstrumentResponse response = make_response({0.0, 0.0, path}, "response");
    const double ps_m = kSpeedOfLight * 1e-12;
    EXPECT_NEAR(moments(response).mean_m, 6.5 * ps_m, 1e-15);
    const ResponseFilter filter = sample_response(response, kWidth_m);
    EXPECT_NEAR(moments_of(filter, kWidth_m).mean_m, 6.5 * ps_m, 1e-12);
    EXPECT_NEAR(sum_of(filter), 1.0, 1e-14);
}

TEST(InstrumentResponse, FullWidthAtHalfMaximumIsThat) {
    const double sigma_m = sigma_m_from_fwhm_ps(94.0);
    const double half_m = 0.5 * 94e-12 * kSpeedOfLight;
    EXPECT_NEAR(std::exp(-0.5 * std::pow(half_m / sigma_m, 2)), 0.5, 1e-12);
}

TEST(InstrumentResponse, BadSettingsAreNamed) {
    const test_support::TemporaryFolder folder;
    EXPECT_ERROR_WITH(make_response({-1.0, 0.0, ""}, "response"), "response.jitter_fwhm_ps");
    EXPECT_ERROR_WITH(make_response({10.0, 0.0, "curve.txt"}, "response"), "must stand alone");
    EXPECT_ERROR_WITH(make_response({0.0, 0.0, folder.file("none")}, "response"), "opened");
    for (const std::string text : {"", "1 -1\n", "2 1\n1 1\n", "1 0\n", "1\n", "nan 1\n"}) {
        test_support::write_file_bytes(folder.file("bad"), text);
        EXPECT_ERROR_WITH(make_response({0.0, 0.0, folder.file("bad")}, "response"), "weight");
    }
}

}  // namespace
}  // namespace core
