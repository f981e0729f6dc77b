// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"
#include "renderer/core/capture/instrument_response.h"

#include <memory>
#include <span>
#include <vector>

namespace nlos {

/// Takes a set-up's response off histograms: a Wiener filter along time.
///
/// Where the response lets through the share R of a frequency's amplitude, the filter multiplies by
/// conj(R) / (|R|^2 + floor^2): by 1/R where |R| is well above the floor, and never by more than
/// 1 / (2 floor), which is how much it may raise noise. Delays are undone along with the blur, so
/// that light of a response with a tail comes to lie at its length.
///
/// source   [Wiener1949]
class ResponseDeconvolution {
 public:
    /// filter     response on the histograms' axis
    /// num_bins   of a histogram
    /// floor      positive; about the ratio of noise to signal, as amplitudes
    ResponseDeconvolution(const core::ResponseFilter& filter, std::size_t num_bins, double floor);

    /// Replaces a histogram of num_bins by what it would be without the response; nothing is taken
    /// from beyond its ends. Bins may become negative. Safe to call from several threads.
    void apply(std::span<double> histogram) const;

 private:
    std::size_t num_bins_;
    std::size_t length_;  ///< of transforms
    Fft forward_;
    Fft inverse_;
    std::vector<ComplexF> factors_;  ///< per frequency, the transforms' scale included
};

}  // namespace nlos
