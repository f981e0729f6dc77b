// SPDX-License-Identifier: MIT
// Counts: none, one, a great many, and detectors that see no more. Darkness, negative and
// saturated values in reconstruction: tests/nlos/reconstruction_hard_cases_test.cpp.
#include "calib/statistics/poisson_deviance.h"
#include "nlos/compare/compare_image.h"
#include "nlos/detector/dead_time.h"
#include "nlos/detector/detector.h"
#include "renderer/core/random.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <algorithm>
#include <numeric>

namespace hard_cases {
namespace {

using truth::Quad;

// sign(mu - n) sqrt(2 [mu - n + n ln(n/mu)]); with t = (n - mu)/mu, 2 mu [(1+t) ln(1+t) - t]. In
// 113 bits nothing is lost down to t = 1e-12.
Quad signed_deviance(Quad mu, Quad n) {
    const Quad t = (n - mu) / mu;
    const Quad deviance = n > 0 ? 2 * mu * ((1 + t) * truth::log1pq(t) - t) : 2 * mu;
    return (mu > n ? 1 : -1) * truth::sqrtq(deviance);
}

double deviance_error(double mu, double n) {
    const calib::Residual found = calib::signed_deviance(mu, n);
    const Quad expected = signed_deviance(mu, n);
    return std::max(truth::relative_error(found.value, expected),
                    truth::relative_error(found.gradient, (1 - Quad(n) / Quad(mu)) / expected));
}

// First photons of a pulse, per pulse: exp(-sum of earlier rates) (1 - exp(-rate)).
std::vector<Quad> first_photons(const std::vector<double>& rates) {
    std::vector<Quad> counts;
    Quad before = 0;
    for (const double rate : rates) {
        counts.push_back(truth::expq(-before) * -truth::expm1q(-Quad(rate)));
        before += rate;
    }
    return counts;
}

// Detections d per bin of a ring of periods: d_i + p_i (d_i-1 + .. + d_i-b) = p_i, by elimination.
std::vector<Quad> steady_detections(const std::vector<Quad>& p, std::size_t blind) {
    const std::size_t n = p.size();
    std::vector<std::vector<Quad>> rows(n, std::vector<Quad>(n + 1, 0));
    for (std::size_t i = 0; i < n; ++i) {
        rows[i][i] = 1;
        rows[i][n] = p[i];
        for (std::size_t k = 1; k <= blind; ++k) rows[i][(i + n * blind - k) % n] += p[i];
    }
    for (std::size_t pivot = 0; pivot < n; ++pivot) {
        const auto larger = [&](const auto& a, const auto& b) {
            return truth::abs(a[pivot]) < truth::abs(b[pivot]);
        };
        const auto from = rows.begin() + static_cast<std::ptrdiff_t>(pivot);
        std::iter_swap(from, std::max_element(from, rows.end(), larger));
        for (std::size_t i = 0; i < n; ++i) {
            const Quad factor = rows[i][pivot] / rows[pivot][pivot];
            if (i == pivot || factor == 0) continue;
            for (std::size_t k = pivot; k <= n; ++k) rows[i][k] -= factor * rows[pivot][k];
        }
    }
    std::vector<Quad> detections;
    for (std::size_t i = 0; i < n; ++i) detections.push_back(rows[i][n] / rows[i][i]);
    return detections;
}

core::Capture flat_capture(std::size_t pairs, float value) {
    core::Capture capture;
    capture.scan = test_support::confocal_scan(std::vector<core::Vec3>(pairs, core::Vec3::Zero()));
    capture.time_axis = {0.0, 0.008, 64};
    capture.transient = core::Transient(pairs, 64);
    std::ranges::fill(capture.transient.values(), value);
    return capture;
}

}  // namespace

double deviance_of_nearly_expected_counts() {
    core::Rng rng(test_support::seed_of("deviance_of_nearly_expected_counts"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const double mu = test_support::power_of_ten(rng, -3.0, 12.0);
        const double t = (i % 2 == 0 ? 1.0 : -1.0) * test_support::power_of_ten(rng, -12.0, -0.1);
        const double n = mu * (1.0 + t);
        if (n != mu) worst.add(deviance_error(mu, n));
    }
    return worst.value();
}

double deviance_of_no_and_of_huge_counts() {
    core::Rng rng(test_support::seed_of("deviance_of_no_and_of_huge_counts"), 0, 0);
    Worst worst;
    for (int i = 0; i < 5000; ++i) {
        const double mu = test_support::power_of_ten(rng, -12.0, 15.0);
        worst.add(deviance_error(mu, 0.0));
        worst.add(deviance_error(mu, 1.0));
        worst.add(deviance_error(mu, test_support::power_of_ten(rng, 0.0, 15.0)));
    }
    return worst.value();
}

double expected_deviance_from_dark_to_bright() {
    Worst worst;
    for (const double mu : {1e-9, 1e-3, 0.5, 7.0, 49.9, 50.1, 80.0}) {
        Quad mean = 0;
        Quad probability = truth::expq(-Quad(mu));
        for (int n = 0; n < 400; ++n) {
            const Quad t = (Quad(n) - Quad(mu)) / Quad(mu);
            const Quad d = n > 0 ? 2 * Quad(mu) * ((1 + t) * truth::log1pq(t) - t) : 2 * Quad(mu);
            mean += probability * d;
            probability *= Quad(mu) / (n + 1);
        }
        worst.add(truth::relative_error(calib::deviance_moments(mu).mean, mean));
    }
    return worst.value();
}

double first_photons_of_a_saturated_detector() {
    Worst worst;
    for (const double rate : {1e-12, 1e-3, 0.5, 5.0, 700.0}) {
        const std::vector<double> rates(64, rate);
        const std::vector<double> counts =
            nlos::count_with_dead_time(rates, {1, 0, 0.0, 0, true}, nullptr);
        const std::vector<Quad> expected = first_photons(rates);
        for (std::size_t i = 0; i < rates.size(); ++i) {
            worst.add(truth::relative_error(counts[i], expected[i], expected[0]));
        }
    }
    return worst.value();
}

double rates_behind_pile_up() {
    // Coates' inversion, -ln(1 - n/left), while 1e-4 of the pulses are left.
    const std::vector<double> rates(64, 9.0 / 64.0);
    const std::vector<double> counts =
        nlos::count_with_dead_time(rates, {1, 0, 0.0, 0, true}, nullptr);
    Worst worst;
    Quad left = 1;
    for (std::size_t i = 0; i < rates.size(); ++i) {
        worst.add(truth::relative_error(-truth::log1pq(-Quad(counts[i]) / left), rates[i]));
        left -= Quad(counts[i]);
    }
    return worst.value();
}

double steady_light_on_a_blind_detector() {
    // A detector that sees with probability p per bin and is blind for b bins after: p/(1 + b p).
    Worst worst;
    for (const double rate : {1e-9, 1e-3, 0.02, 0.1}) {
        for (const std::size_t blind : {1, 7, 50, 100, 333}) {
            const nlos::PulseTrain train{1, 36, rate, blind, false};
            const std::vector<double> counts =
                nlos::count_with_dead_time(std::vector<double>(64, rate), train, nullptr);
            const Quad p = -truth::expm1q(-Quad(rate));
            const Quad expected = p / (1 + Quad(static_cast<double>(blind)) * p);
            for (const double count : counts) worst.add(truth::relative_error(count, expected));
        }
    }
    return worst.value();
}

double bright_peaks_on_a_blind_detector() {
    // A peak of up to 10 photons per bin on a period of 60 bins, detectors in step with it
    // included.
    Worst worst;
    for (const double peak : {0.01, 0.3, 2.0, 5.0, 10.0}) {
        std::vector<double> rates;
        std::vector<Quad> p;
        for (int i = 0; i < 60; ++i) {
            const double rate = 0.02 + peak * std::exp(-0.05 * (i - 20) * (i - 20));
            if (i < 40) rates.push_back(rate);
            p.push_back(-truth::expm1q(-Quad(i < 40 ? rate : 0.02)));
        }
        for (const std::size_t blind : {1, 30, 59, 60, 61, 62, 123, 150}) {
            const std::vector<double> counts =
                nlos::count_with_dead_time(rates, {1, 20, 0.02, blind, false}, nullptr);
            const std::vector<Quad> expected = steady_detections(p, blind);
            for (std::size_t i = 0; i < counts.size(); ++i) {
                worst.add(truth::relative_error(counts[i], expected[i]));
            }
        }
    }
    return worst.value();
}

double detections_within_a_blind_time() {
    // However bright it is, no two detections lie within a blind time: in any blind + 1 bins, over
    // the ends of pulses too, there is one on average at most.
    Worst worst;
    for (const double rate : {0.3, 2.0, 40.0, 700.0}) {
        for (const std::size_t blind : {1, 7, 50, 63}) {
            const nlos::PulseTrain train{1, 0, 0.0, blind, false};
            const std::vector<double> counts =
                nlos::count_with_dead_time(std::vector<double>(64, rate), train, nullptr);
            for (std::size_t first = 0; first < counts.size(); ++first) {
                double sum = 0.0;
                for (std::size_t k = 0; k <= blind; ++k) sum += counts[(first + k) % 64];
                worst.add(std::max(0.0, sum - 1.0));
            }
        }
    }
    return worst.value();
}

double budgets_from_one_photon_to_a_quadrillion() {
    Worst worst;
    for (const double photons : {1e-6, 1.0, 1e6, 1e15}) {
        for (const float value : {1e-30F, 1.0F, 1e30F}) {
            nlos::DetectorSettings settings;
            settings.photons = photons;
            settings.expected = true;
            const core::Capture counts = nlos::detect(flat_capture(4, value), settings);
            const auto values = counts.transient.values();
            worst.add(
                truth::relative_error(std::accumulate(values.begin(), values.end(), 0.0), photons));
        }
    }
    return worst.value();
}

double a_single_photon_in_ten_thousand_bins() {
    // Drawn with a budget of one photon: whole numbers, and about one of them.
    Worst worst;
    nlos::DetectorSettings settings;
    settings.photons = 1.0;
    double all = 0.0;
    for (settings.seed = 0; settings.seed < 100; ++settings.seed) {
        const core::Capture counts = nlos::detect(flat_capture(160, 1.0F), settings);
        for (const float value : counts.transient.values()) {
            worst.add(value == std::floor(value) && value >= 0.0F ? 0.0 : HUGE_VAL);
            all += value;
        }
    }
    worst.add(std::abs(all - 100.0) / std::sqrt(100.0));
    return worst.value();
}

double differences_of_dim_and_bright_captures() {
    // Relative mean square error of values 1e-30 to 1e30, negative ones too, differing by 1e-6.
    core::Rng rng(test_support::seed_of("differences_of_dim_and_bright_captures"), 0, 0);
    Worst worst;
    for (const double size : {1e-30, 1e-6, 1.0, 1e30}) {
        std::vector<float> reference;
        std::vector<float> result;
        Quad above = 0;
        Quad below = 0;
        for (int i = 0; i < 1000; ++i) {
            const double value = size * (2.0 * rng.uniform() - 1.0);
            reference.push_back(static_cast<float>(value));
            result.push_back(static_cast<float>(value * (1.0 + 1e-6)));
            const Quad error = Quad(result.back()) - Quad(reference.back());
            above += error * error;
            below += Quad(reference.back()) * Quad(reference.back());
        }
        const auto found = nlos::relative_mse(result, reference);
        worst.add(found ? truth::relative_error(*found, above / below) : HUGE_VAL);
    }
    return worst.value();
}

}  // namespace hard_cases
