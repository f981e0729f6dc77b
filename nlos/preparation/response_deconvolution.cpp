// SPDX-License-Identifier: MIT
#include "nlos/preparation/histogram_preparation.h"

#include <algorithm>
#include <cmath>
#include <complex>

namespace nlos {
namespace {

// Even, with room for what the response moves past either end.
std::size_t transform_length(const core::ResponseFilter& filter, std::size_t num_bins) {
    const auto taps =
        filter.weights.size() + static_cast<std::size_t>(std::abs(filter.first_delay));
    return 2 * good_fft_size((num_bins + taps + 1) / 2);
}

}  // namespace

ResponseDeconvolution::ResponseDeconvolution(const core::ResponseFilter& filter,
                                             std::size_t num_bins,
                                             double floor)
    : num_bins_(num_bins),
      length_(transform_length(filter, num_bins)),
      forward_(Fft::real_to_complex(length_, 1)),
      inverse_(Fft::complex_to_real(length_, 1)) {
    const auto length = static_cast<std::ptrdiff_t>(length_);
    FftBuffer response(Fft::row_floats(length_));
    for (std::size_t k = 0; k < filter.weights.size(); ++k) {
        const std::ptrdiff_t delay = filter.first_delay + static_cast<std::ptrdiff_t>(k);
        const std::ptrdiff_t bin = ((delay % length) + length) % length;
        response.data()[bin] += static_cast<float>(filter.weights[k]);
    }
    FftBuffer spectrum(response.num_floats());
    forward_.run(response, spectrum);
    for (std::size_t i = 0; i < length_ / 2 + 1; ++i) {
        const std::complex<double> passed(spectrum.complex()[i]);
        const std::complex<double> factor =
            std::conj(passed) / (std::norm(passed) + floor * floor) / static_cast<double>(length_);
        factors_.emplace_back(factor);
    }
}

ResponseDeconvolution::ResponseDeconvolution(const std::vector<std::complex<double>>& factors,
                                             std::size_t num_bins)
    : num_bins_(num_bins),
      length_(2 * (factors.size() - 1)),
      forward_(Fft::real_to_complex(length_, 1)),
      inverse_(Fft::complex_to_real(length_, 1)) {
    for (const std::complex<double>& factor : factors) {
        factors_.emplace_back(factor / static_cast<double>(length_));
    }
}

void ResponseDeconvolution::apply(std::span<double> histogram) const {
    FftBuffer buffer(Fft::row_floats(length_));
    FftBuffer spectrum(buffer.num_floats());
    std::copy(histogram.begin(), histogram.end(), buffer.data());
    forward_.run(buffer, spectrum);
    for (std::size_t i = 0; i < factors_.size(); ++i) spectrum.complex()[i] *= factors_[i];
    inverse_.run(spectrum, buffer);
    std::copy_n(buffer.data(), num_bins_, histogram.begin());
}

}  // namespace nlos
