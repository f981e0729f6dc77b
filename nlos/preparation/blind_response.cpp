// SPDX-License-Identifier: MIT
#include "nlos/preparation/blind_response.h"

#include "renderer/core/system/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kMostHistograms = 4096;
constexpr double kModelError = 1e-4;  // of the power at frequency 0
constexpr double kTimesNoise = 3.0;

/// One number per frequency.
struct Powers {
    std::vector<double> values;

    Powers& operator+=(const Powers& other) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] += other.values[i];
        return *this;
    }
};

/// Logarithms of a spectrum in bands, decibels of frequency against decibels of power.
struct Bands {
    std::vector<double> frequency;
    std::vector<double> power;
};

double decibels(double ratio) {
    return 10.0 * std::log10(ratio);
}

/// A sixth of an octave wide and at least one frequency, up to where noise or the limit begins.
Bands bands_of(const MeanSpectrum& spectrum, double last_frequency) {
    constexpr double kBandRatio = 1.122462;  // sixth root of 2
    constexpr double kSignificance = 5.0;
    constexpr double kLeastOverNoise = 0.25;
    Bands bands;
    std::size_t begin = 1;
    while (begin + 1 < spectrum.power.size()) {
        const auto end = std::min(
            spectrum.power.size(),
            std::max(
                begin + 1,
                static_cast<std::size_t>(std::round(kBandRatio * static_cast<double>(begin)))));
        double power = 0.0;
        double log_frequency = 0.0;
        for (std::size_t i = begin; i < end; ++i) {
            power += spectrum.power[i] - spectrum.noise_power;
            log_frequency += std::log10(static_cast<double>(i) * spectrum.frequency_step);
        }
        const auto count = static_cast<double>(end - begin);
        power /= count;
        log_frequency /= count;
        const double deviation =
            spectrum.noise_power / std::sqrt(static_cast<double>(spectrum.num_averaged) * count);
        const double least =
            std::max(kSignificance * deviation, kLeastOverNoise * spectrum.noise_power);
        if (!(power > least) || std::pow(10.0, log_frequency) > last_frequency) break;
        bands.frequency.push_back(10.0 * log_frequency);
        bands.power.push_back(decibels(power / spectrum.power[0]));
        begin = end;
    }
    return bands;
}

/// Slope of a straight line through points from `begin` to the one before `end`.
double line_slope(const Bands& bands, std::size_t begin, std::size_t end) {
    const auto count = static_cast<double>(end - begin);
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
        mean_x += bands.frequency[i] / count;
        mean_y += bands.power[i] / count;
    }
    double xy = 0.0;
    double xx = 0.0;
    for (std::size_t i = begin; i < end; ++i) {
        const double x = bands.frequency[i] - mean_x;
        xy += x * (bands.power[i] - mean_y);
        xx += x * x;
    }
    return xy / xx;
}

/// A transform of as many values as a spectrum has frequencies on both sides.
class SpectrumTransform {
 public:
    explicit SpectrumTransform(std::size_t num_frequencies)
        : length_(2 * (num_frequencies - 1)),
          forward_(Fft::real_to_complex(length_, 1)),
          inverse_(Fft::complex_to_real(length_, 1)) {}

    /// The values of which this is the spectrum.
    std::vector<double> inverse(const std::vector<std::complex<double>>& spectrum) const {
        FftBuffer from(Fft::row_floats(length_));
        FftBuffer to(from.num_floats());
        std::ranges::transform(
            spectrum, from.complex(), [](std::complex<double> v) { return ComplexF(v); });
        inverse_.run(from, to);
        std::vector<double> values(to.data(), to.data() + length_);
        for (double& value : values) value /= static_cast<double>(length_);
        return values;
    }
    std::vector<std::complex<double>> forward(const std::vector<double>& values) const {
        FftBuffer from(Fft::row_floats(length_));
        FftBuffer to(from.num_floats());
        std::ranges::transform(
            values, from.data(), [](double value) { return static_cast<float>(value); });
        forward_.run(from, to);
        return {to.complex(), to.complex() + length_ / 2 + 1};
    }

 private:
    std::size_t length_;
    Fft forward_;
    Fft inverse_;
};

/// The spectrum of minimum phase of this power: the cepstrum of its logarithm, whose values before
/// time 0 are moved behind it.
std::vector<std::complex<double>> minimum_phase(const SpectrumTransform& transform,
                                                const std::vector<double>& power) {
    std::vector<std::complex<double>> logarithm;
    for (const double value : power) logarithm.emplace_back(0.5 * std::log(value));
    std::vector<double> cepstrum = transform.inverse(logarithm);
    const std::size_t middle = cepstrum.size() / 2;
    for (std::size_t i = 1; i < middle; ++i) cepstrum[i] *= 2.0;
    std::fill(cepstrum.begin() + static_cast<std::ptrdiff_t>(middle) + 1, cepstrum.end(), 0.0);
    std::vector<std::complex<double>> result = transform.forward(cepstrum);
    for (std::complex<double>& value : result) value = std::exp(value);
    return result;
}

/// How many values hold half of all that is positive.
std::size_t half_light(const std::vector<double>& response) {
    double sum = 0.0;
    for (const double value : response) sum += std::max(0.0, value);
    double so_far = 0.0;
    std::size_t count = 0;
    while (count < response.size() && so_far < 0.5 * sum) {
        so_far += std::max(0.0, response[count++]);
    }
    return count;
}

}  // namespace

MeanSpectrum mean_spectrum(const core::Transient& transient,
                           const PreparationPlan& plan,
                           double bin_width_m) {
    const std::size_t length = 2 * good_fft_size(transient.num_bins());
    const std::size_t num_frequencies = length / 2 + 1;
    const std::size_t stride =
        std::max<std::size_t>(1, (transient.num_pairs() + kMostHistograms - 1) / kMostHistograms);
    MeanSpectrum spectrum;
    spectrum.num_averaged = (transient.num_pairs() + stride - 1) / stride;
    spectrum.frequency_step = 1.0 / (static_cast<double>(length) * bin_width_m);
    const Fft forward = Fft::real_to_complex(length, 1);
    const auto power_of = [&](std::size_t number) {
        const std::vector<double> signal = signal_of(transient, plan, number * stride);
        FftBuffer from(Fft::row_floats(length));
        FftBuffer to(from.num_floats());
        std::ranges::transform(
            signal, from.data(), [](double value) { return static_cast<float>(value); });
        forward.run(from, to);
        Powers powers;
        for (std::size_t i = 0; i < num_frequencies; ++i) {
            powers.values.push_back(double{std::norm(to.complex()[i])});
        }
        return powers;
    };
    spectrum.power =
        core::parallel_sum<Powers>(
            spectrum.num_averaged, Powers{std::vector<double>(num_frequencies)}, power_of)
            .values;
    for (double& power : spectrum.power) power /= static_cast<double>(spectrum.num_averaged);
    std::vector<double> highest(spectrum.power.end() - static_cast<std::ptrdiff_t>(length / 8),
                                spectrum.power.end());
    const auto median = highest.begin() + static_cast<std::ptrdiff_t>(highest.size() / 2);
    std::ranges::nth_element(highest, median);
    spectrum.noise_power = *median;
    return spectrum;
}

std::optional<double> spectral_slope(const MeanSpectrum& spectrum, double pitch_m) {
    constexpr double kFirstLevel = -18.0;
    constexpr double kLastLevel = -36.0;
    constexpr std::size_t kFewest = 3;
    if (!(spectrum.power[0] > 0.0)) return std::nullopt;
    // A cycle of range is two of path length.
    const Bands bands = bands_of(spectrum, 0.25 / pitch_m);
    const auto first_below = [&](double level) {
        return static_cast<std::size_t>(
            std::ranges::find_if(bands.power, [&](double power) { return power < level; }) -
            bands.power.begin());
    };
    const std::size_t below = first_below(kFirstLevel);
    const std::size_t begin = std::max<std::size_t>(below, 1) - 1;
    const std::size_t end = std::min(first_below(kLastLevel) + 1, bands.power.size());
    if (below >= bands.power.size() || end < begin + kFewest) return std::nullopt;
    return -line_slope(bands, begin, end);
}

bool shows_response(const MeanSpectrum& spectrum, double pitch_m) {
    const auto slope = spectral_slope(spectrum, pitch_m);
    return slope && *slope >= kSlopeOfResponse;
}

BlindResponse find_blind_response(const MeanSpectrum& spectrum, std::size_t num_bins) {
    const double total = spectrum.power[0];
    const double floor = std::max(kModelError, kTimesNoise * spectrum.noise_power / total);
    std::vector<double> damped;
    for (const double power : spectrum.power) damped.push_back(power / total + floor);
    const SpectrumTransform transform(spectrum.power.size());
    const std::vector<std::complex<double>> passed = minimum_phase(transform, damped);
    std::vector<std::complex<double>> factors;
    for (std::size_t i = 0; i < passed.size(); ++i) {
        const double signal = std::max(0.0, spectrum.power[i] - spectrum.noise_power) / total;
        factors.push_back(signal / (signal + floor) / passed[i]);
    }
    BlindResponse response;
    const double bin_width_m =
        0.5 / (static_cast<double>(spectrum.power.size() - 1) * spectrum.frequency_step);
    response.delay_m = static_cast<double>(half_light(transform.inverse(passed))) * bin_width_m;
    response.deconvolution = std::make_shared<const ResponseDeconvolution>(factors, num_bins);
    return response;
}

std::string describe(const BlindResponse& response) {
    return fmt::format(
        "a response of about {:.2g} ns that all histograms share was taken off without knowing it "
        "(blind_deconvolution): depths may be off by its delay, up to {:.2g} m",
        1e9 * response.delay_m / core::kSpeedOfLight,
        0.5 * response.delay_m);
}

}  // namespace nlos
