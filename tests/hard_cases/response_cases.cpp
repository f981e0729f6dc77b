// SPDX-License-Identifier: MIT
// Instrument responses and resampling of the time axis.
#include "nlos/fourier/unit_phasor.h"
#include "nlos/preparation/conservative_resampling.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/random.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"

#include <algorithm>
#include <numeric>

namespace hard_cases {
namespace {

using truth::Quad;

Quad normal_cdf(Quad z) {
    return truth::erfcq(-z / truth::sqrtq(2)) / 2;
}

// Phi(z) - exp(s^2/(2 t^2) - u/t) Phi(z - s/t), z = u/s.
Quad exponential_gaussian_cdf(Quad u, Quad sigma, Quad tail) {
    const Quad z = u / sigma;
    const Quad y = z - sigma / tail;
    return normal_cdf(z) -
           truth::expq(sigma * sigma / (2 * tail * tail) - u / tail) * normal_cdf(y);
}

struct Moments {
    double sum = 0.0, mean = 0.0, variance = 0.0;
};

Moments moments_of(const core::ResponseFilter& filter) {
    Moments m;
    for (std::size_t k = 0; k < filter.weights.size(); ++k) {
        const double delay = filter.first_delay + static_cast<double>(k);
        m.sum += filter.weights[k];
        m.mean += delay * filter.weights[k];
    }
    for (std::size_t k = 0; k < filter.weights.size(); ++k) {
        const double delay = filter.first_delay + static_cast<double>(k) - m.mean;
        m.variance += delay * delay * filter.weights[k];
    }
    return m;
}

}  // namespace

double response_with_narrow_core_or_tail() {
    core::Rng rng(test_support::seed_of("response_with_narrow_core_or_tail"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const double sigma = test_support::power_of_ten(rng, -3.0, 0.0);
        const double tail = sigma * test_support::power_of_ten(rng, -2.0, 3.0);
        const double u = sigma * (20.0 * rng.uniform() - 8.0);
        worst.add(truth::relative_error(core::exponential_gaussian_cdf(u, sigma, tail),
                                        exponential_gaussian_cdf(u, sigma, tail),
                                        1));
        // exp(z^2/2) Phi(z), on its own from one end to the other.
        const double z = -200.0 * rng.uniform() * rng.uniform();
        const Quad expected = truth::expq(Quad(z) * Quad(z) / 2) * normal_cdf(z);
        if (z > -100.0) worst.add(truth::relative_error(core::scaled_normal_cdf(z), expected));
    }
    return worst.value();
}

double moments_of_responses_across_bins() {
    core::Rng rng(test_support::seed_of("moments_of_responses_across_bins"), 0, 0);
    Worst worst;
    for (int i = 0; i < 100; ++i) {
        // Cores from half a bin, where linear splitting still leaves room, to 100 bins.
        const double sigma = 0.008 * test_support::power_of_ten(rng, -0.3, 2.0);
        const double tail = i % 2 == 0 ? 0.0 : sigma * test_support::power_of_ten(rng, -2.0, 0.5);
        const core::InstrumentResponse response =
            tail > 0.0 ? core::InstrumentResponse(core::ExponentialGaussianResponse{sigma, tail})
                       : core::InstrumentResponse(core::GaussianResponse{sigma});
        const Moments m = moments_of(core::sample_response(response, 0.008));
        const double width2 = 0.008 * 0.008;
        const double variance = sigma * sigma + tail * tail;
        worst.add(std::abs(m.sum - 1.0));
        worst.add(std::abs(0.008 * m.mean - tail) / std::sqrt(variance));
        worst.add(std::abs(width2 * m.variance - variance) / variance);
    }
    return worst.value();
}

double shifts_by_parts_of_a_bin() {
    core::Rng rng(test_support::seed_of("shifts_by_parts_of_a_bin"), 0, 0);
    Worst worst;
    for (int i = 0; i < 5000; ++i) {
        const double width = test_support::power_of_ten(rng, -6.0, 1.0);
        const double delay =
            (i % 2 == 0 ? 1.0 : -1.0) * width * test_support::power_of_ten(rng, -12.0, 6.0);
        const Moments m =
            moments_of(core::sample_response(core::MeasuredResponse{{delay}, {1.0}}, width));
        worst.add(std::abs(m.sum - 1.0));
        worst.add(truth::relative_error(
            m.mean, Quad(delay) / Quad(width), std::max(1.0, std::abs(delay / width))));
    }
    return worst.value();
}

double squared_range_far_from_the_wall() {
    // LCT moves bins of range [r_k, r_k+1] to even bins of v = r^2; at 500 m a bin of v holds
    // 4e-6 of it.
    Worst worst;
    for (const double start : {0.0, 0.3, 500.0}) {
        constexpr std::size_t kBins = 256;
        const std::vector<double> r = nlos::even_edges(start, start + 1.0, kBins);
        std::vector<double> r2;
        for (const double edge : r) r2.push_back(edge * edge);
        const std::vector<double> v = nlos::even_edges(r2.front(), r2.back(), 3 * kBins);
        const nlos::ConservativeResampling to_squares(r2, v, std::vector<double>(kBins, 1.0));
        for (std::size_t bin = 0; bin < kBins; bin += 5) {
            std::vector<float> input(kBins, 0.0F);
            std::vector<float> output(3 * kBins);
            input[bin] = 1.0F;
            to_squares.apply(input.data(), output.data());
            double sum = 0.0;
            for (std::size_t k = 0; k < output.size(); ++k) {
                sum += output[k];
                const Quad from = Quad(r[bin]) * Quad(r[bin]);
                const Quad to = Quad(r[bin + 1]) * Quad(r[bin + 1]);
                const Quad overlap = std::min(to, Quad(v[k + 1])) - std::max(from, Quad(v[k]));
                const Quad expected = overlap > 0 ? overlap / (to - from) : Quad(0);
                worst.add(truth::relative_error(output[k], expected, 1));
            }
            worst.add(std::abs(sum - 1.0));
        }
    }
    return worst.value();
}

double phases_of_a_billion_turns() {
    core::Rng rng(test_support::seed_of("phases_of_a_billion_turns"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const double turns =
            test_support::power_of_ten(rng, -9.0, 9.0) * (2.0 * rng.uniform() - 1.0);
        const nlos::UnitPhasor found = nlos::unit_phasor(turns);
        const Quad angle = 2 * truth::pi() * (Quad(turns) - truth::floorq(turns));
        worst.add(truth::relative_error(found.re, truth::cosq(angle), 1));
        worst.add(truth::relative_error(found.im, truth::sinq(angle), 1));
    }
    return worst.value();
}

}  // namespace hard_cases
