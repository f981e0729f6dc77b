// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/transient.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/core/settings/settings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace core {

// How far a set-up (laser pulse, detector jitter, electronics) moves a photon along the time axis,
// as a distribution of delays in metres of path length. One struct per kind; to add one: a struct,
// its place in the variant, and a case in each function of the .cpp.

/// Normal distribution around 0.
struct GaussianResponse {
    double sigma_m = 0.0;
};

/// Normal core around 0 plus an exponential delay of mean `tail_m`: a SPAD's diffusion tail.
struct ExponentialGaussianResponse {
    double sigma_m = 0.0;
    double tail_m = 0.0;
};

/// A measured histogram of delays.
struct MeasuredResponse {
    std::vector<double> delays_m;  ///< ascending
    std::vector<double> weights;   ///< fraction of the light at each delay; not negative, sum 1
};

using InstrumentResponse =
    std::variant<GaussianResponse, ExponentialGaussianResponse, MeasuredResponse>;

/// The response as users state it, in picoseconds; all 0 and empty: what a capture's provenance
/// gives, if it does. The text `capture` insists on that, and `none` on no response; see
/// recorded_detector.h.
struct ResponseSettings {
    double jitter_fwhm_ps = 0.0;
    double tail_ps = 0.0;
    std::string curve;
    bool of_capture = false;
    bool is_none = false;
};

template <class Visitor>
void for_each_field(ResponseSettings& s, Visitor&& visit) {
    visit(
        "jitter_fwhm_ps", s.jitter_fwhm_ps, "full width at half maximum of pulse and jitter [ps]");
    visit("tail_ps", s.tail_ps, "mean of an exponential tail behind the Gaussian core [ps]");
    visit("curve",
          s.curve,
          "text file of a measured response instead: a delay [ps] and a weight on every line");
}

void read_value(const Json& json, const std::string& where, ResponseSettings& settings);
Json write_value(const ResponseSettings& settings);

/// Whether there is any response.
inline bool is_given(const ResponseSettings& settings) {
    return settings.of_capture || settings.jitter_fwhm_ps != 0.0 || settings.tail_ps != 0.0 ||
           !settings.curve.empty();
}

/// Throws Error naming `where` unless widths are finite and not negative and the curve stands alone
/// and can be read.
InstrumentResponse make_response(const ResponseSettings& settings, const std::string& where);

/// Standard deviation in path length [m] of a Gaussian of this full width at half maximum [ps].
double sigma_m_from_fwhm_ps(double fwhm_ps);

/// The widest bins in which a Gaussian response of this full width at half maximum shows: half its
/// standard deviation, which loses less than 1 % of its width.
double widest_bin_m(double fwhm_ps);

/// First moments of the delays.
struct ResponseMoments {
    double mean_m = 0.0;
    double variance_m2 = 0.0;
    double third_central_m3 = 0.0;
};
ResponseMoments moments(const InstrumentResponse& response);

/// The response on a time axis: output[i] = sum over k of weights[k] input[i - first_delay - k].
struct ResponseFilter {
    int first_delay = 0;          ///< [bins], may be negative
    std::vector<double> weights;  ///< not negative, sum 1
};

/// Samples a response for histograms of a bin width.
///
/// A delay is split linearly between its two neighbouring bins, which is exact for light spread
/// evenly over a bin and keeps every mean delay, however small a part of a bin. Splitting widens:
/// a Gaussian core is therefore narrowed beforehand until the weights have the response's own
/// variance (where it is wide enough for that), as if light had been delayed before it was binned.
///
/// bin_width_m   [m], positive
/// returns       delays that hold all but 1e-12 of the light
ResponseFilter sample_response(const InstrumentResponse& response, double bin_width_m);

/// Convolves one histogram; light that leaves the axis is lost, none enters. Output has the
/// input's size and must not be the input.
template <class In, class Out>
void apply_filter(const ResponseFilter& filter, std::span<const In> input, std::span<Out> output) {
    const auto bins = static_cast<std::ptrdiff_t>(input.size());
    const auto taps = static_cast<std::ptrdiff_t>(filter.weights.size());
    for (std::ptrdiff_t i = 0; i < bins; ++i) {
        const std::ptrdiff_t newest = i - filter.first_delay;  // input bin of the first weight
        const std::ptrdiff_t begin = std::max<std::ptrdiff_t>(0, newest - bins + 1);
        const std::ptrdiff_t end = std::min(taps, newest + 1);
        double sum = 0.0;
        for (std::ptrdiff_t k = begin; k < end; ++k) {
            sum += filter.weights[static_cast<std::size_t>(k)] *
                   static_cast<double>(input[static_cast<std::size_t>(newest - k)]);
        }
        output[static_cast<std::size_t>(i)] = static_cast<Out>(sum);
    }
}

/// Convolves every histogram, in parallel.
Transient apply_filter(const ResponseFilter& filter, const Transient& transient);

// The distributions behind the weights, for any scalar type that has exp and erfc (such as a dual
// number). u [m] is a delay; sigma, tail > 0.

/// Probability that a normal delay is at most u.
template <class T>
T gaussian_cdf(const T& u, const T& sigma) {
    using std::erfc;
    return T(0.5) * erfc(-u / (sigma * T(std::sqrt(2.0))));
}

/// Expectation of max(0, u - delay), whose second derivative is the density.
template <class T>
T gaussian_ramp(const T& u, const T& sigma) {
    using std::exp;
    const T z = u / sigma;
    const T density = exp(T(-0.5) * z * z) * T(1.0 / std::sqrt(2.0 * kPi));
    return u * gaussian_cdf(u, sigma) + sigma * density;
}

/// exp(z^2 / 2) times the standard normal's cumulative probability at z <= 0, where the one may be
/// too large for a number and the other too small.
template <class T>
T scaled_normal_cdf(const T& z) {
    using std::erfc;
    using std::exp;
    if (z > T(-25.0)) return exp(T(0.5) * z * z) * T(0.5) * erfc(-z / T(std::sqrt(2.0)));
    const T y = T(1.0) / (z * z);  // asymptotic series; the first term left out is 1e-11
    const T series = T(1.0) - y * (T(1.0) - y * (T(3.0) - y * (T(15.0) - y * T(105.0))));
    return series * T(-1.0 / std::sqrt(2.0 * kPi)) / z;
}

/// Probability that the sum of a normal and an exponential delay is at most u.
template <class T>
T exponential_gaussian_cdf(const T& u, const T& sigma, const T& tail) {
    using std::exp;
    const T z = u / sigma;
    const T y = z - sigma / tail;
    // P = Phi(z) - exp(sigma^2 / (2 tail^2) - u / tail) Phi(y), and the exponent is (y^2 - z^2)
    // / 2.
    const T late = y > T(0.0) ? T(exp(T(0.5) * (y * y - z * z)) * gaussian_cdf(y, T(1.0)))
                              : T(exp(T(-0.5) * z * z) * scaled_normal_cdf(y));
    return gaussian_cdf(u, sigma) - late;
}

/// Expectation of max(0, u - delay): with R + tail R' = gaussian_ramp and R' the probability above.
template <class T>
T exponential_gaussian_ramp(const T& u, const T& sigma, const T& tail) {
    return gaussian_ramp(u, sigma) - tail * exponential_gaussian_cdf(u, sigma, tail);
}

}  // namespace core
