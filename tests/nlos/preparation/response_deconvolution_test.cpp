// SPDX-License-Identifier: MIT
#include "nlos/preparation/histogram_preparation.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kNumBins = 512;
constexpr double kBin_m = 0.001;

// A core of 8 bins and a tail of 20.
core::ResponseFilter response() {
    return core::sample_response(core::ExponentialGaussianResponse{8.0 * kBin_m, 20.0 * kBin_m},
                                 kBin_m);
}

// A pulse of 12 bins (standard deviation) with a sum of 1.
std::vector<double> pulse(double center) {
    std::vector<double> histogram(kNumBins);
    for (std::size_t i = 0; i < kNumBins; ++i) {
        const double z = (static_cast<double>(i) - center) / 12.0;
        histogram[i] = std::exp(-0.5 * z * z) / (12.0 * std::sqrt(2.0 * core::kPi));
    }
    return histogram;
}

std::vector<double> smeared(const core::ResponseFilter& filter, const std::vector<double>& light) {
    std::vector<double> result(light.size());
    core::apply_filter<double, double>(filter, light, result);
    return result;
}

double norm(const std::vector<double>& values) {
    return std::sqrt(std::inner_product(values.begin(), values.end(), values.begin(), 0.0));
}

// What the response lets through comes back, at its place: to the floor's 1e-3 and the rounding of
// single precision that the filter may raise 500 times.
TEST(ResponseDeconvolution, RestoresWhatTheResponseLetsThrough) {
    const core::ResponseFilter filter = response();
    const ResponseDeconvolution deconvolution(filter, kNumBins, 1e-3);
    const std::vector<double> light = pulse(200.3);
    std::vector<double> restored = smeared(filter, light);
    deconvolution.apply(restored);
    double off = 0.0;
    for (std::size_t i = 0; i < kNumBins; ++i)
        off = std::max(off, std::abs(restored[i] - light[i]));
    EXPECT_LT(off, 2e-3 * light[200]);
}

TEST(ResponseDeconvolution, WithoutAResponseNothingButTheScaleChanges) {
    const ResponseDeconvolution deconvolution({0, {1.0}}, kNumBins, 0.1);
    const std::vector<double> light = pulse(100.0);
    std::vector<double> restored = light;
    deconvolution.apply(restored);
    for (std::size_t i = 0; i < kNumBins; ++i) {
        EXPECT_NEAR(restored[i], light[i] / 1.01, 1e-7);
    }
}

TEST(ResponseDeconvolution, TellsPulsesApartThatTheResponseMerges) {
    const core::ResponseFilter filter =
        core::sample_response(core::GaussianResponse{10.0 * kBin_m}, kBin_m);
    std::vector<double> light(kNumBins);
    light[250] = light[269] = 1.0;
    std::vector<double> blurred = smeared(filter, light);
    EXPECT_GT(blurred[260], blurred[250]);
    ResponseDeconvolution(filter, kNumBins, 0.002).apply(blurred);
    EXPECT_LT(blurred[260], 0.7 * blurred[250]);
    EXPECT_LT(blurred[260], 0.7 * blurred[269]);
}

TEST(ResponseDeconvolution, RaisesNoiseByNoMoreThanItsBound) {
    core::Rng rng(11, 0, 0);
    std::vector<double> noise(kNumBins);
    for (double& value : noise) value = rng.uniform() - 0.5;
    for (const double floor : {0.02, 0.1, 0.5}) {
        std::vector<double> raised = noise;
        ResponseDeconvolution(response(), kNumBins, floor).apply(raised);
        EXPECT_LT(norm(raised), norm(noise) / (2.0 * floor));
        EXPECT_GT(norm(raised), 0.0);
    }
}

// Light near the ends neither wraps around nor moves beyond them.
TEST(ResponseDeconvolution, EndsDoNotMeet) {
    const ResponseDeconvolution deconvolution(response(), kNumBins, 0.1);
    std::vector<double> light(kNumBins);
    light[2] = 1.0;
    deconvolution.apply(light);
    double late = 0.0;
    for (std::size_t i = kNumBins - 100; i < kNumBins; ++i)
        late = std::max(late, std::abs(light[i]));
    EXPECT_LT(late, 1e-3);
}

}  // namespace
}  // namespace nlos
