// SPDX-License-Identifier: MIT
// Responses that histograms tell themselves: which are found, what comes of them, false alarms.
#include "nlos/preparation/blind_response.h"

#include "nlos/reconstruct.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/methods/confocal_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace nlos {
namespace {

using core::Vec3;

constexpr double kBlindPitch_m = 0.03;
constexpr core::TimeAxis kBlindAxis{0.5, 0.006, 384};

core::Capture capture_before_surfaces() {
    return nlos_test::confocal_capture(
        nlos_test::wall_grid({16, 16}, {kBlindPitch_m, kBlindPitch_m}), kBlindAxis);
}

/// One to three plates or balls, 0.2 to 0.5 m wide, anywhere before the wall and turned anyhow, as
/// scatterers much finer than a bin.
core::Capture random_surfaces(std::uint64_t number) {
    core::Rng rng(0xb11d, number, 0);
    const auto between = [&](double low, double high) {
        return low + (high - low) * rng.uniform();
    };
    core::Capture capture = capture_before_surfaces();
    const int count = 1 + static_cast<int>(3.0 * rng.uniform());
    for (int i = 0; i < count; ++i) {
        const Vec3 center(between(-0.3, 0.3), between(-0.3, 0.3), between(0.5, 1.0));
        const double size_m = between(0.2, 0.5);
        const Vec3 axis = Vec3(between(-1.0, 1.0), between(-1.0, 1.0), -1.5).normalized();
        const Vec3 u = axis.unitOrthogonal();
        const Vec3 v = axis.cross(u);
        const bool is_ball = rng.uniform() < 0.5;
        for (int k = 0; k < 4000; ++k) {
            const double a = between(-0.5, 0.5) * size_m;
            const double b = between(-0.5, 0.5) * size_m;
            double c = 0.0;
            if (is_ball) {
                const double height = 0.25 * size_m * size_m - a * a - b * b;
                if (height < 0.0) continue;
                c = std::sqrt(height);
            }
            nlos_test::add_scatterer(capture, center + a * u + b * v + c * axis, 4.0);
        }
    }
    return capture;
}

/// Both ways through a slab of that diffusion time: [(theta / sinh theta)^2](t), as a response.
core::Capture behind_a_slab(const core::Capture& clean, double time_ns) {
    const double length_m = 1e-9 * time_ns * core::kSpeedOfLight;
    // One way: sum of alternating exponentials, 2 sum (-1)^(n+1) k_n exp(-k_n t), k_n = (n pi)^2 /
    // T.
    std::vector<double> one_way(kBlindAxis.num_bins);
    for (std::size_t bin = 0; bin < one_way.size(); ++bin) {
        const double t = (static_cast<double>(bin) + 0.5) * kBlindAxis.bin_width_m / length_m;
        double sum = 0.0;
        for (int n = 1; n < 60; ++n) {
            const double rate = std::pow(n * core::kPi, 2);
            sum += (n % 2 == 1 ? 1.0 : -1.0) * rate * std::exp(-rate * t);
        }
        one_way[bin] = std::max(0.0, sum);
    }
    core::ResponseFilter filter{0, one_way};
    double total = 0.0;
    for (const double weight : one_way) total += weight;
    for (double& weight : filter.weights) weight /= total;
    core::Capture blurred = clean;
    blurred.transient = core::apply_filter(filter, core::apply_filter(filter, clean.transient));
    return blurred;
}

/// Counts with this mean number of photons per histogram and a background of a twentieth of them.
core::Capture counts_from(const core::Capture& capture, double photons) {
    core::Capture counts = capture;
    counts.unit = core::TransientUnit::Counts;
    double sum = 0.0;
    for (const float value : capture.transient.values()) sum += double{value};
    const double scale = photons * static_cast<double>(capture.scan.num_pairs()) / sum;
    std::mt19937 generator(7);
    for (float& value : counts.transient.values()) {
        const double expected = scale * double{value} + 0.05 * photons / kBlindAxis.num_bins;
        value = static_cast<float>(std::poisson_distribution<int>(expected)(generator));
    }
    return counts;
}

std::optional<double> slope_of(const core::Capture& capture) {
    PreparationPlan plan;
    if (const auto signal = find_signal(capture.transient, std::nullopt, capture.unit)) {
        plan.ambient_per_bin = signal->ambient_per_bin;
    }
    return spectral_slope(mean_spectrum(capture.transient, plan, kBlindAxis.bin_width_m),
                          kBlindPitch_m);
}

Reconstruction lct_with(const core::Capture& capture, const std::vector<std::string>& overrides) {
    ReconstructSettings settings;
    settings.method = Method::Lct;
    for (const std::string& text : overrides) core::apply_override(settings, text);
    return reconstruct(capture, settings, {});
}

// 120 captures. The steepest has 4.9, the next scene 3.5. It is no proof for all scenes: see
// kSlopeOfResponse for how often others are mistaken.
TEST(BlindResponse, SurfacesAloneAreNoResponse) {
    double steepest = 0.0;
    for (std::uint64_t number = 0; number < 40; ++number) {
        const core::Capture clean = random_surfaces(number);
        for (const double photons : {0.0, 300.0, 10000.0}) {
            const auto slope = slope_of(photons > 0.0 ? counts_from(clean, photons) : clean);
            steepest = std::max(steepest, slope.value_or(0.0));
        }
    }
    EXPECT_LT(steepest, kSlopeOfResponse);
}

// Steps of many surfaces hide the slab's own fall where they are as long as it delays: two in ten.
TEST(BlindResponse, AScatteringSlabMostlyIsOne) {
    int found = 0;
    for (std::uint64_t number = 0; number < 10; ++number) {
        const core::Capture blurred = behind_a_slab(random_surfaces(number), 6.0);
        if (slope_of(counts_from(blurred, 3000.0)).value_or(0.0) > kSlopeOfResponse) ++found;
    }
    EXPECT_GE(found, 8);
}

// Of a point, all of the spectrum is the response's: an exponential decay comes back as a peak at
// its place.
TEST(BlindResponse, TakesADecayOffAPoint) {
    constexpr std::size_t kBins = 256;
    core::Transient transient(4, kBins);
    for (std::size_t pair = 0; pair < 4; ++pair) {
        for (std::size_t bin = 40 + 10 * pair; bin < kBins; ++bin) {
            transient.histogram(pair)[bin] =
                std::exp(-0.1F * static_cast<float>(bin - 40 - 10 * pair));
        }
    }
    const BlindResponse response = find_blind_response(mean_spectrum(transient, {}, 0.01), kBins);
    EXPECT_NEAR(response.delay_m, 0.07, 0.011);  // 10 ln 2 bins
    std::vector<double> histogram(transient.histogram(1).begin(), transient.histogram(1).end());
    response.deconvolution->apply(histogram);
    double beside = 0.0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        if (bin < 40 || bin > 60) beside = std::max(beside, std::abs(histogram[bin]));
    }
    EXPECT_LT(beside, 0.05 * histogram[50]);
}

TEST(BlindResponse, IsTakenOffByDefaultWhereItIsThereAndSaidSo) {
    const core::Capture clean = random_surfaces(3);
    const core::Capture blurred = counts_from(behind_a_slab(clean, 4.0), 30000.0);
    const Reconstruction by_default = lct_with(blurred, {});
    EXPECT_EQ(by_default.settings.blind_deconvolution, BlindDeconvolution::On);
    ASSERT_FALSE(by_default.warnings.empty());
    EXPECT_NE(by_default.warnings.back().find("blind_deconvolution"), std::string::npos);

    // Of the light that a capture without the slab shows, more is shown in its place.
    const auto likeness = [](const Volume& a, const Volume& b) {
        double ab = 0.0;
        double aa = 0.0;
        double bb = 0.0;
        const std::size_t nz = a.axes.z_m.size();
        for (std::size_t column = 0; column < a.values.size() / nz; ++column) {
            float in_a = 0.0F;
            float in_b = 0.0F;
            for (std::size_t i = 0; i < nz; ++i) in_a = std::max(in_a, a.values[column * nz + i]);
            const std::size_t other = b.axes.z_m.size();
            for (std::size_t i = 0; i < other; ++i) {
                in_b = std::max(in_b, b.values[column * other + i]);
            }
            ab += double{in_a} * double{in_b};
            aa += double{in_a} * double{in_a};
            bb += double{in_b} * double{in_b};
        }
        return ab / std::sqrt(aa * bb);
    };
    const Volume truth = lct_with(clean, {}).volume;
    const double with = likeness(by_default.volume, truth);
    const double without = likeness(lct_with(blurred, {"blind_deconvolution=off"}).volume, truth);
    EXPECT_GT(with, without);
}

// What explains its data explains no response that it does not know.
TEST(BlindResponse, AutoTakesADirectMethodBehindOne) {
    const core::Capture clean = random_surfaces(3);
    const core::Capture blurred = behind_a_slab(clean, 4.0);
    EXPECT_EQ(reconstruct(counts_from(clean, 3000.0), {}, {}).settings.method, Method::Solver);
    const Reconstruction behind = reconstruct(counts_from(blurred, 30000.0), {}, {});
    EXPECT_EQ(behind.settings.method, Method::Lct);
    EXPECT_EQ(behind.settings.blind_deconvolution, BlindDeconvolution::On);
    EXPECT_NE(behind.reason.find("a response that nobody stated"), std::string::npos);
    ReconstructSettings stated;
    core::apply_override(stated, "response.jitter_fwhm_ps=300");
    EXPECT_EQ(reconstruct(counts_from(blurred, 30000.0), stated, {}).settings.method,
              Method::Solver);
}

TEST(BlindResponse, ChangesNoBitOfCapturesWithoutOne) {
    for (const double photons : {0.0, 3000.0}) {
        const core::Capture clean = random_surfaces(5);
        const core::Capture capture = photons > 0.0 ? counts_from(clean, photons) : clean;
        const Reconstruction by_default = lct_with(capture, {});
        EXPECT_EQ(by_default.settings.blind_deconvolution, BlindDeconvolution::Off);
        const Reconstruction off = lct_with(capture, {"blind_deconvolution=off"});
        EXPECT_TRUE(std::ranges::equal(by_default.volume.values, off.volume.values));
    }
}

TEST(BlindResponse, GivesWayToAStatedOne) {
    const core::Capture blurred = behind_a_slab(random_surfaces(3), 4.0);
    for (const char* stated : {"response.jitter_fwhm_ps=300", "response=none"}) {
        EXPECT_EQ(lct_with(blurred, {stated}).settings.blind_deconvolution,
                  BlindDeconvolution::Off);
    }
    EXPECT_THROW(lct_with(blurred, {"response.jitter_fwhm_ps=300", "blind_deconvolution=on"}),
                 core::Error);
    EXPECT_THROW(lct_with(blurred, {"method=solver", "blind_deconvolution=on"}), core::Error);
}

}  // namespace
}  // namespace nlos
