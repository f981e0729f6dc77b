// SPDX-License-Identifier: MIT
// Ill-posed fits. Grazing tilts, nearly symmetric objects, few photons, hidden and missing objects:
// tests/calib/hard_fits_test.cpp; set-ups that the data cannot determine: calibrate_test.cpp.
#include "calib/direct_returns.h"
#include "calib/uncertainty.h"
#include "renderer/core/instrument_response.h"
#include "renderer/core/random.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

namespace hard_cases {
namespace {

using truth::Quad;

}  // namespace

double errors_of_nearly_collinear_parameters() {
    core::Rng rng(test_support::seed_of("errors_of_nearly_collinear_parameters"), 0, 0);
    Worst worst;
    for (int i = 0; i < 2000; ++i) {
        // Two parameters in units 1e-8 to 1e8 that the data tell apart by 1 - correlation^2 down to
        // 1e-8: sigma_1^2 = I_22/det.
        const double a = std::pow(10.0, 16.0 * rng.uniform() - 8.0);
        const double b = std::pow(10.0, 16.0 * rng.uniform() - 8.0);
        const double apart = std::pow(10.0, -8.0 * rng.uniform());
        const double sign = i % 2 == 0 ? 1.0 : -1.0;
        Eigen::MatrixXd information(2, 2);
        information << a * a, sign * (1.0 - apart) * a * b, sign * (1.0 - apart) * a * b, b * b;
        const calib::Uncertainty found = calib::assess(information, {"a", "b"});
        const Quad i00 = information(0, 0);
        const Quad i11 = information(1, 1);
        const Quad i01 = information(0, 1);
        const Quad determinant = i00 * i11 - i01 * i01;
        worst.add(truth::relative_error(found.sigma[0], truth::sqrtq(i11 / determinant)));
        worst.add(truth::relative_error(found.sigma[1], truth::sqrtq(i00 / determinant)));
        // What cannot be told apart is said.
        const bool is_open = apart < 0.0099;
        if (is_open) worst.add(found.unidentifiable.empty() ? HUGE_VAL : 0.0);
    }
    return worst.value();
}

double direct_returns_of_few_and_of_many_counts() {
    // Expected counts instead of drawn ones: the fit must then find the truth, far below a bin,
    // whatever the counts, beside one another.
    constexpr double kSigma = 0.012;
    const std::vector<double> counts{30.0, 1e3, 1e6, 1e9};
    core::Capture capture;
    capture.scan =
        test_support::confocal_scan(std::vector<core::Vec3>(counts.size(), core::Vec3::Zero()));
    capture.time_axis = {1.0, 0.008, 128};
    capture.unit = core::TransientUnit::Counts;
    capture.transient = core::Transient(counts.size(), 128);
    const auto length = [](std::size_t i) { return 1.4 + 0.00237 * static_cast<double>(i); };
    for (std::size_t i = 0; i < counts.size(); ++i) {
        for (int bin = 0; bin < 128; ++bin) {
            const auto below = [&](int k) {
                return core::gaussian_cdf(capture.time_axis.bin_begin_m(k) - length(i), kSigma);
            };
            capture.transient.histogram(i)[static_cast<std::size_t>(bin)] =
                static_cast<float>(0.01 + counts[i] * (below(bin + 1) - below(bin)));
        }
    }
    const calib::DirectReturns found =
        calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian);
    Worst worst;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        worst.add(std::abs(found.points[i].opl_m - length(i)) / 0.008);
    }
    worst.add(std::abs(found.sigma_m / kSigma - 1.0));
    return worst.value();
}

}  // namespace hard_cases
