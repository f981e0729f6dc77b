// SPDX-License-Identifier: MIT
#include "nlos/detector/detector.h"

#include "nlos/detector/count_sampling.h"
#include "nlos/detector/dead_time.h"
#include "renderer/core/system/parallel.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

using test_support::seed_of;

constexpr double kLevel = 0.001;

/// `pairs` equal histograms with two peaks on some background.
core::Capture repeated_capture(std::size_t pairs, int bins) {
    core::Capture capture;
    capture.scan.wall().sensing = test_support::as_list(test_support::example_grid(pairs, 1));
    capture.scan.wall().illumination = capture.scan.wall().sensing;
    capture.time_axis = {0.0, 0.008, bins};
    capture.transient = core::Transient(pairs, bins);
    for (std::size_t pair = 0; pair < pairs; ++pair) {
        const auto histogram = capture.transient.histogram(pair);
        for (std::size_t i = 0; i < histogram.size(); ++i) {
            const double x = static_cast<double>(i) / static_cast<double>(bins);
            histogram[i] = static_cast<float>(0.02 + std::exp(-std::pow((x - 0.3) / 0.05, 2)) +
                                              0.4 * std::exp(-std::pow((x - 0.7) / 0.1, 2)));
        }
    }
    return capture;
}

DetectorSettings with_photons_per_point(double photons) {
    DetectorSettings settings;
    settings.photons_per_point = photons;
    return settings;
}

/// Mean over the pairs of each bin.
std::vector<double> mean_histogram(const core::Capture& capture) {
    std::vector<double> mean(capture.transient.num_bins(), 0.0);
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        const auto histogram = capture.transient.histogram(pair);
        for (std::size_t i = 0; i < mean.size(); ++i) {
            mean[i] += histogram[i] / static_cast<double>(capture.transient.num_pairs());
        }
    }
    return mean;
}

/// p-value of sum (observed - mean)^2 / variance against chi-square.
double chi_square_p(const std::vector<double>& observed,
                    const std::vector<double>& mean,
                    const std::vector<double>& variance) {
    double sum = 0.0;
    for (std::size_t i = 0; i < mean.size(); ++i) {
        sum += std::pow(observed[i] - mean[i], 2) / variance[i];
    }
    return test_support::chi_square_tail(sum, static_cast<double>(mean.size()));
}

TEST(Detector, PhotonBudgetIsTheExpectedSignal) {
    const core::Capture capture = test_support::example_capture(core::ScanPattern::Exhaustive);
    DetectorSettings settings;
    settings.expected = true;
    settings.photons = 12345.0;
    const core::Capture total = detect(capture, settings);
    EXPECT_NEAR(test_support::sum_of(total.transient.values()), 12345.0, 0.01);
    EXPECT_EQ(total.unit, core::TransientUnit::Counts);
    const double scale = total.counts_per_radiance.value();
    EXPECT_NEAR(scale, 12345.0 / test_support::sum_of(capture.transient.values()), 1e-9);
    EXPECT_NEAR(total.transient.histogram(3)[2], scale * capture.transient.histogram(3)[2], 1e-3);

    settings.photons.reset();
    settings.photons_per_point = 100.0;
    const double pairs = static_cast<double>(capture.scan.num_pairs());
    EXPECT_NEAR(
        test_support::sum_of(detect(capture, settings).transient.values()), 100.0 * pairs, 0.01);
}

TEST(Detector, ExposureCountsPhotonsOfTheRadiance) {
    const core::Capture capture = repeated_capture(1, 50);
    DetectorSettings settings;
    settings.expected = true;
    settings.exposure_s = 2.0;
    settings.radiometry = {0.25, 670.0, 1e-9, 0.4};
    // Power at the detector per radiance, divided by the energy h c / lambda of a photon.
    const double photons_per_radiance =
        2.0 * 0.25 * 1e-9 * 0.4 / (6.62607015e-34 * 299792458.0 / 670e-9);
    const core::Capture counts = detect(capture, settings);
    EXPECT_NEAR(counts.counts_per_radiance.value() / photons_per_radiance, 1.0, 1e-12);
    EXPECT_NEAR(test_support::sum_of(counts.transient.values()) /
                    (photons_per_radiance * test_support::sum_of(capture.transient.values())),
                1.0,
                1e-6);
}

TEST(Detector, BackgroundIsAmbientPlusDarkCounts) {
    const core::Capture capture = repeated_capture(1, 50);
    DetectorSettings settings = with_photons_per_point(10.0);
    settings.expected = true;
    const core::Capture dark = detect(capture, settings);
    settings.ambient = 1.5;
    settings.dark_counts_hz = 300.0;
    settings.exposure_s = 4.0;
    settings.repetition_hz = 5e6;
    const core::Capture lit = detect(capture, settings);
    const double open_s = 4.0 * 5e6 * 0.008 / core::kSpeedOfLight;
    for (std::size_t i = 0; i < 50; ++i) {
        EXPECT_NEAR(lit.transient.histogram(0)[i] - dark.transient.histogram(0)[i],
                    1.5 + 300.0 * open_s,
                    1e-5);
    }
}

TEST(Detector, CountsNothingInBinsThatAreNotObserved) {
    for (const double dead_time_ns : {0.0, 20.0}) {
        core::Capture capture = repeated_capture(4, 100);
        core::restrict_observed(capture, {{0, 100}, {20, 60}, {0, 0}, {20, 60}});
        DetectorSettings settings = with_photons_per_point(500.0);
        settings.ambient = 10.0;
        settings.dark_counts_hz = 100.0;
        settings.response.jitter_fwhm_ps = 100.0;
        settings.dead_time_ns = dead_time_ns;
        const core::Capture counts = detect(capture, settings);
        EXPECT_EQ(counts.observed, capture.observed);
        EXPECT_NO_THROW(core::validate(counts, "counts"));  // 0 where nothing was observed
        double sum = 0.0;
        for (const float value : counts.observed_values(1)) sum += value;
        EXPECT_GT(sum, 40.0 * 10.0);
    }
}

TEST(Detector, PhotonsPerPointAreThoseOfPointsThatWereObserved) {
    core::Capture capture = repeated_capture(4, 100);
    core::restrict_observed(capture, {{0, 100}, {0, 0}, {0, 100}, {0, 0}});
    DetectorSettings settings = with_photons_per_point(500.0);
    settings.expected = true;
    const core::Capture counts = detect(capture, settings);
    const auto values = counts.transient.values();
    EXPECT_NEAR(std::accumulate(values.begin(), values.end(), 0.0), 1000.0, 0.1);
}

TEST(Detector, CountsHaveTheDispersionOfPoisson) {
    constexpr std::size_t kPairs = 2000;
    const core::Capture capture = repeated_capture(kPairs, 40);
    DetectorSettings settings = with_photons_per_point(400.0);
    settings.seed = seed_of("CountsHaveTheDispersionOfPoisson");
    const core::Capture counts = detect(capture, settings);
    settings.expected = true;
    const std::vector<double> mean = mean_histogram(detect(capture, settings));
    double chi_square = 0.0;
    for (std::size_t pair = 0; pair < kPairs; ++pair) {
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const double count = counts.transient.histogram(pair)[i];
            ASSERT_EQ(count, std::round(count));
            chi_square += std::pow(count - mean[i], 2) / mean[i];
        }
    }
    // A Poisson number's (n - m)^2 / m has mean 1 and variance 2 + 1/m.
    double variance = 0.0;
    for (const double m : mean) variance += kPairs * (2.0 + 1.0 / m);
    const double z = (chi_square - static_cast<double>(kPairs * mean.size())) / std::sqrt(variance);
    EXPECT_GT(test_support::normal_tail(z), kLevel) << z;
}

TEST(Detector, ResponseShiftsAndWidensByItsMoments) {
    core::Capture capture = repeated_capture(1, 400);
    const auto input = capture.transient.histogram(0);
    std::fill(input.begin(), input.end(), 0.0F);
    input[100] = 1.0F;
    DetectorSettings settings = with_photons_per_point(1000.0);
    settings.expected = true;
    settings.response.jitter_fwhm_ps = 94.0;
    settings.response.tail_ps = 200.0;
    const core::Capture counts = detect(capture, settings);
    double mean = 0.0;
    double square = 0.0;
    for (std::size_t i = 0; i < 400; ++i) {
        const double delay_m = 0.008 * (static_cast<double>(i) - 100.0);
        mean += delay_m * counts.transient.histogram(0)[i] / 1000.0;
        square += delay_m * delay_m * counts.transient.histogram(0)[i] / 1000.0;
    }
    const double ps = 1e-12 * core::kSpeedOfLight;
    EXPECT_NEAR(mean, 200.0 * ps, 1e-6);
    const double sigma_ps = 94.0 / 2.354820045;
    EXPECT_NEAR(square - mean * mean,
                (sigma_ps * sigma_ps + 200.0 * 200.0) * ps * ps,
                1e-4 * 200.0 * 200.0 * ps * ps);
}

/// Coates' estimate of the photons per pulse from first-photon counts.
std::vector<double> invert_pile_up(const std::vector<double>& counts, double pulses) {
    std::vector<double> rates;
    double left = pulses;
    for (const double count : counts) {
        rates.push_back(-std::log1p(-count / left));
        left -= count;
    }
    return rates;
}

TEST(Detector, InversionOfPileUpRecoversTheRate) {
    constexpr std::size_t kPairs = 200;
    const core::Capture capture = repeated_capture(kPairs, 60);
    DetectorSettings settings = with_photons_per_point(20'000.0);
    settings.pile_up = true;
    settings.exposure_s = 0.001;  // 10,000 pulses of 2 photons each
    settings.expected = true;
    const double pulses = 1e4;
    const std::vector<double> expected = mean_histogram(detect(capture, settings));
    settings.pile_up = false;
    const std::vector<double> truth = mean_histogram(detect(capture, settings));

    EXPECT_LT(std::accumulate(expected.begin(), expected.end(), 0.0), 0.9 * pulses);
    const std::vector<double> exact = invert_pile_up(expected, pulses);
    for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_NEAR(exact[i] * pulses / truth[i], 1.0, 1e-5);
    }

    settings.pile_up = true;
    settings.expected = false;
    settings.seed = seed_of("InversionOfPileUpRecoversTheRate");
    const std::vector<double> counts = mean_histogram(detect(capture, settings));
    const std::vector<double> estimate = invert_pile_up(counts, pulses);
    // Of the L pulses left at a bin, expected counts n: the variance of the estimate is n / (L (L -
    // n)).
    std::vector<double> rates;
    std::vector<double> variances;
    double left = pulses;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        rates.push_back(truth[i] / pulses);
        variances.push_back(expected[i] / (left * (left - expected[i]) * kPairs));
        left -= expected[i];
    }
    EXPECT_GT(chi_square_p(estimate, rates, variances), kLevel);
}

TEST(Detector, ConstantLightGivesTheRateOfADeadDetector) {
    // r / (1 + r tau), the rate of a detector that is blind for tau after each detection.
    core::Capture capture = repeated_capture(64, 200);
    for (const double photons_per_ns : {0.002, 0.02, 0.2}) {
        DetectorSettings settings = with_photons_per_point(1e-6);
        const double bin_ns = 1e9 * 0.008 / core::kSpeedOfLight;
        settings.exposure_s = 0.01;
        const double pulses = 1e5;
        settings.ambient = photons_per_ns * bin_ns * pulses;
        settings.dead_time_ns = 25.0;
        settings.expected = true;
        const double wanted = settings.ambient / (1.0 + photons_per_ns * settings.dead_time_ns);
        for (const double mean : mean_histogram(detect(capture, settings))) {
            // Rounding to bins moves the dead time by up to half a bin of 27 ps.
            EXPECT_NEAR(mean / wanted, 1.0, 0.0015) << photons_per_ns;
        }
        settings.expected = false;
        settings.seed = seed_of("ConstantLightGivesTheRateOfADeadDetector");
        double sum = 0.0;
        const core::Capture counts = detect(capture, settings);
        for (const float count : counts.transient.values()) sum += count;
        const double all = 64.0 * 200.0 * wanted;
        EXPECT_NEAR(sum, all, 4.0 * std::sqrt(all) + 0.0015 * all) << photons_per_ns;
    }
}

/// Photon by photon: a detector that is armed, detects, and is blind.
std::vector<double> count_photon_by_photon(const std::vector<double>& rates,
                                           const PulseTrain& train,
                                           core::Rng& rng) {
    const auto period = static_cast<std::int64_t>(rates.size() + train.gap_bins);
    std::vector<double> counts(rates.size(), 0.0);
    std::int64_t seeing_from = 0;
    constexpr std::int64_t kSettling = 20;
    for (std::int64_t pulse = -kSettling; pulse < train.pulses; ++pulse) {
        bool is_blocked = false;
        for (std::int64_t bin = 0; bin < period; ++bin) {
            const std::int64_t now = (pulse + kSettling) * period + bin;
            const bool on_axis = bin < static_cast<std::int64_t>(rates.size());
            const double rate = on_axis ? rates[static_cast<std::size_t>(bin)] : train.gap_rate;
            if (now < seeing_from || is_blocked || sample_poisson(rng, rate) == 0) continue;
            seeing_from = now + 1 + static_cast<std::int64_t>(train.blind_bins);
            is_blocked = train.first_photon_only;
            if (on_axis && pulse >= 0) counts[static_cast<std::size_t>(bin)] += 1.0;
        }
    }
    return counts;
}

TEST(Detector, CountsAgreeWithASimulationPhotonByPhoton) {
    const std::vector<double> rates{0.05, 0.4, 0.1, 0.02, 0.3, 0.3, 0.0, 0.1, 0.6, 0.05};
    const std::vector<PulseTrain> trains{{100'000, 0, 0.0, 0, true},
                                         {100'000, 6, 0.03, 3, false},
                                         {100'000, 6, 0.03, 12, false},
                                         {100'000, 2, 0.03, 29, false},
                                         {100'000, 6, 0.0, 9, true},
                                         {100'000, 6, 0.0, 18, true}};
    core::Rng rng(seed_of("CountsAgreeWithASimulationPhotonByPhoton"), 0, 0);
    for (std::size_t t = 0; t < trains.size(); ++t) {
        const std::vector<double> expected = count_with_dead_time(rates, trains[t], nullptr);
        const std::vector<double> slow = count_photon_by_photon(rates, trains[t], rng);
        const std::vector<double> fast = count_with_dead_time(rates, trains[t], &rng);
        for (std::size_t i = 0; i < rates.size(); ++i) {
            // A bin's count is binomial, or narrower where pulses follow each other.
            const double deviation = std::sqrt(std::max(1e-9, expected[i]));
            EXPECT_LT(std::abs(slow[i] - expected[i]) / deviation, 5.0) << t << " bin " << i;
            EXPECT_LT(std::abs(fast[i] - expected[i]) / deviation, 5.0) << t << " bin " << i;
        }
    }
}

TEST(Detector, SeedsAreExactWhateverTheThreads) {
    const core::Capture capture = repeated_capture(50, 64);
    DetectorSettings settings = with_photons_per_point(300.0);
    settings.response.jitter_fwhm_ps = 60.0;
    settings.dead_time_ns = 2.0;
    settings.dark_counts_hz = 1e5;
    for (const bool pile_up : {false, true}) {
        settings.pile_up = pile_up;
        const auto run = [&](int threads, std::uint64_t seed) {
            const core::ThreadLimit limit(threads);
            settings.seed = seed;
            return detect(capture, settings);
        };
        const core::Capture one = run(1, 3);
        const core::Capture seven = run(7, 3);
        const core::Capture other = run(7, 4);
        EXPECT_TRUE(std::ranges::equal(one.transient.values(), seven.transient.values()));
        EXPECT_FALSE(std::ranges::equal(one.transient.values(), other.transient.values()));
    }
}

TEST(Detector, BadSettingsAreNamed) {
    core::Capture capture = repeated_capture(2, 64);
    const auto expect = [&](const DetectorSettings& settings, const std::string& part) {
        EXPECT_ERROR_WITH(detect(capture, settings), part);
    };
    DetectorSettings settings;
    expect(settings, "photons_per_point");
    settings = with_photons_per_point(-1.0);
    expect(settings, "photons_per_point: found -1; must be above 0");
    settings = with_photons_per_point(1e300);
    expect(settings, "at most 1e15 counts");
    settings = with_photons_per_point(10.0);
    settings.ambient = 1e300;
    expect(settings, "at most 1e15 counts");
    settings = with_photons_per_point(10.0);
    settings.photons = 10.0;
    expect(settings, "one of the two");
    settings = with_photons_per_point(10.0);
    settings.ambient = -1.0;
    expect(settings, "ambient");
    settings = with_photons_per_point(10.0);
    settings.pile_up = true;
    settings.repetition_hz = 1e9;
    expect(settings, "repetition_hz");
    settings = with_photons_per_point(10.0);
    settings.dead_time_ns = 1e6;
    expect(settings, "dead_time_ns");
    settings = with_photons_per_point(10.0);
    settings.radiometry.efficiency = 1.1;
    expect(settings, "efficiency");

    settings = DetectorSettings{};
    settings.exposure_s = 1.0;
    capture.unit = core::TransientUnit::Counts;
    expect(settings, "only radiance");
    settings = with_photons_per_point(10.0);
    capture.transient.values()[3] = -1.0F;
    expect(settings, "negative");
    for (float& value : capture.transient.values()) value = 0.0F;
    expect(settings, "must hold light");
}

}  // namespace
}  // namespace nlos
