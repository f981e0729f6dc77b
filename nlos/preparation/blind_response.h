// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/histogram_preparation.h"

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// Mean power spectrum of a capture's histograms.
struct MeanSpectrum {
    std::vector<double> power;     ///< per frequency, of transforms twice as long as it has values
    double noise_power = 0.0;      ///< of noise, which is the same at all frequencies
    double frequency_step = 0.0;   ///< [cycles per metre of path]
    std::size_t num_averaged = 0;  ///< histograms
};

/// The spectrum of at most 4,096 histograms, evenly chosen, of which the plan's background is taken
/// off; the median of the highest quarter of frequencies is its noise.
///
/// transient   of at least kMinBins bins
/// plan        whose deconvolution is not looked at
MeanSpectrum mean_spectrum(const core::Transient& transient,
                           const PreparationPlan& plan,
                           double bin_width_m);

/// The power of frequency by which a mean spectrum falls off.
///
/// The histogram of a surface starts with a step, with the root of one or with a ramp (a patch, an
/// edge, a corner is nearest), so that its power falls off with frequency to the power of 2, 3 or
/// 4, and less where points shine; that of many surfaces seen from many points with 2 to 3. What a
/// medium or a detector smears falls off faster the higher the frequency: with
/// exp(-a sqrt(frequency)) behind a diffusing slab, by another 2 where delays are exponential.
///
/// The exponent is that of a line through logarithms, from where 1/63 of the power at frequency 0
/// is left to where 1/4000 is, noise covers it, or scan points of distance `pitch_m` no longer tell
/// directions (half a cycle of range in that distance).
///
/// returns   nothing where the spectrum does not fall so far
std::optional<double> spectral_slope(const MeanSpectrum& spectrum, double pitch_m);

/// From this slope on a response is taken to be there. Of 600 captures of 200 scenes of random
/// plates and balls, clean and with 300 and 10,000 photons per histogram, two pass it without one,
/// both with 300 photons (6.5 and 7.5); of the others the steepest has 5.0 and all but one scene
/// less than 3.8.
inline constexpr double kSlopeOfResponse = 5.2;

/// Whether a mean spectrum falls off as only behind a response, see spectral_slope().
bool shows_response(const MeanSpectrum& spectrum, double pitch_m);

/// A response that all histograms share, as they tell it themselves.
struct BlindResponse {
    std::shared_ptr<const ResponseDeconvolution> deconvolution;
    double delay_m = 0.0;  ///< path length after which half of its light has come
};

/// Blind deconvolution: of the responses with the mean spectrum P of the histograms, the one of
/// minimum phase, by the folded cepstrum of log P. Where surfaces are sharper than the response the
/// spectrum is the response's but for a factor that varies slowly.
///
/// Its inverse is damped as by Wiener, S / (S + e) with S the spectrum without noise, both as
/// fractions of the power at frequency 0; e is 1e-4, an error of the model that no noise tells, or
/// three times the noise. The delay that a response has beyond that of minimum phase cannot be told
/// and stays in the histograms.
///
/// num_bins   of a histogram
/// source     [Oppenheim1975], chapter 10; [Wiener1949]
BlindResponse find_blind_response(const MeanSpectrum& spectrum, std::size_t num_bins);

/// What was found and what it does to depths, in words.
std::string describe(const BlindResponse& response);

}  // namespace nlos
