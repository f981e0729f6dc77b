// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"
#include "nlos/methods/methods.h"

#include <array>
#include <vector>

namespace nlos {

/// The wave of the phasor field, exp(-t^2 / (2 sigma^2)) exp(2 pi i t / wavelength) over path
/// length t [m], as a sum of waves of even spacing in frequency [cycles per metre of path].
struct VirtualWave {
    double wavelength_m = 0.0;
    double sigma_m = 0.0;
    double first_frequency = 0.0;
    double frequency_step = 0.0;
    std::vector<double> amplitudes;  ///< of each frequency; they sum to 1

    std::size_t size() const { return amplitudes.size(); }
    double frequency(std::size_t i) const {
        return first_frequency + static_cast<double>(i) * frequency_step;
    }

    /// Frequencies [begin, end) alone: fields of parts add up to the field of the wave.
    VirtualWave part(std::size_t begin, std::size_t end) const;
};

/// Of methods that show the magnitude of a wave.
inline constexpr VolumeErrors kWaveErrors{.scale = VolumeScale::Magnitude,
                                          .model_fraction = 0.115,
                                          .noise_fraction = 0.3,
                                          .doubt = 7.0,
                                          .plateau = {0.0, 0.5}};

/// Distance of neighbouring wall points [m]: the grid's, or that of as many points spread evenly
/// over the footprint.
double wall_pitch_m(const core::WallScan& scan, const WallFrame& wall);

/// The wavelength to use when none is set: long enough for the wall's pitch to sample the wave,
/// 4 pitches for single and exhaustive scans (twice what is needed), 6 for confocal ones (1.5 times
/// what is needed), and never below 4 bins.
double default_wavelength_m(const core::WallScan& scan,
                            const WallFrame& wall,
                            const core::TimeAxis& axis);

/// Splits the wave into frequencies within 3 standard deviations of the centre.
///
/// settings   wavelength_m must be set
/// span_m     longest distance in path length over which the wave must not repeat itself
/// source     [Liu2019]: sigma = cycles * wavelength / 6
VirtualWave make_virtual_wave(const PhasorSettings& settings, double span_m);

/// Coefficients of histograms at the wave's frequencies, times the wave's amplitudes: sum over bins
/// of H exp(-2 pi i f (bin centre - device segments)).
///
/// pairs     which [begin, end)
/// returns   stored [frequency][pair - begin]
std::vector<ComplexF> analyse(const MethodInput& input,
                              const VirtualWave& wave,
                              const core::BinRange& bins,
                              std::array<std::size_t, 2> pairs);

enum class WavePart { Real, Imaginary };

/// Histograms convolved with a part of the wave.
struct FilteredHistograms {
    core::TimeAxis time_axis;
    core::Transient transient;
};

/// The axis of filtered histograms: bins fine enough for linear interpolation, at least 16 per
/// wavelength, and room for the wave before and behind.
core::TimeAxis filtered_axis(const core::TimeAxis& axis, const PhasorSettings& settings);

/// Convolves every histogram with a part of the wave, on filtered_axis(). Device segments stay part
/// of the axis.
FilteredHistograms filter_histograms(const MethodInput& input,
                                     const PhasorSettings& settings,
                                     WavePart part);

}  // namespace nlos
