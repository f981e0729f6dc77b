// SPDX-License-Identifier: MIT
#include "nlos/methods/virtual_wave.h"

#include "nlos/fourier/unit_phasor.h"

#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kPairsPerBlock = 64;
constexpr double kBinsPerWavelength = 16.0;  // linear interpolation then errs by 2 % at most
constexpr double kWaveReach = 4.0;           // standard deviations after which the wave is over

// One column per bin or per histogram.
using Matrix = Eigen::MatrixXf;
using Histograms = Eigen::Map<const Matrix, 0, Eigen::OuterStride<>>;

/// exp(sign 2 pi i f t): rows for real parts, then as many for imaginary parts, of each frequency;
/// a column per time.
Matrix phases(const VirtualWave& wave, double first_m, double step_m, std::size_t count, int sign) {
    const std::size_t n = wave.size();
    Matrix basis(2 * n, count);
    for (std::size_t column = 0; column < count; ++column) {
        const double t = first_m + static_cast<double>(column) * step_m;
        for (std::size_t i = 0; i < n; ++i) {
            const UnitPhasor p = unit_phasor(sign * wave.frequency(i) * t);
            basis(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(column)) = p.re;
            basis(static_cast<Eigen::Index>(n + i), static_cast<Eigen::Index>(column)) = p.im;
        }
    }
    return basis;
}

/// phases() of bin centres, each frequency times its amplitude.
Matrix analysis_basis(const VirtualWave& wave,
                      const core::TimeAxis& axis,
                      const core::BinRange& bins) {
    Matrix basis = phases(wave,
                          axis.bin_center_m(bins.begin),
                          axis.bin_width_m,
                          static_cast<std::size_t>(bins.size()),
                          -1);
    for (std::size_t i = 0; i < wave.size(); ++i) {
        const auto amplitude = static_cast<float>(wave.amplitudes[i]);
        basis.row(static_cast<Eigen::Index>(i)) *= amplitude;
        basis.row(static_cast<Eigen::Index>(wave.size() + i)) *= amplitude;
    }
    return basis;
}

Histograms histograms_of(const core::Transient& transient,
                         std::size_t first_pair,
                         std::size_t num_pairs,
                         const core::BinRange& bins) {
    return {transient.histogram(first_pair).data() + bins.begin,
            bins.size(),
            static_cast<Eigen::Index>(num_pairs),
            Eigen::OuterStride<>(static_cast<Eigen::Index>(transient.num_bins()))};
}

std::size_t oversampling(const core::TimeAxis& axis, const PhasorSettings& settings) {
    return static_cast<std::size_t>(
        std::ceil(kBinsPerWavelength * axis.bin_width_m / *settings.wavelength_m - 1e-9));
}

}  // namespace

double wall_pitch_m(const core::WallScan& scan, const WallFrame& wall) {
    if (wall.grid) return std::max(wall.grid->pitch_m[0], wall.grid->pitch_m[1]);
    const double area = (wall.max_m[0] - wall.min_m[0]) * (wall.max_m[1] - wall.min_m[1]);
    const auto points =
        static_cast<double>(std::max(scan.sensing.size(), scan.illumination.size()));
    return std::sqrt(area / points);
}

double default_wavelength_m(const core::WallScan& scan,
                            const WallFrame& wall,
                            const core::TimeAxis& axis) {
    const double pitches = scan.pattern == core::ScanPattern::Confocal ? 6.0 : 4.0;
    return std::max(pitches * wall_pitch_m(scan, wall), 4.0 * axis.bin_width_m);
}

VirtualWave make_virtual_wave(const PhasorSettings& settings, double span_m) {
    VirtualWave wave;
    wave.wavelength_m = *settings.wavelength_m;
    wave.sigma_m = settings.cycles * wave.wavelength_m / 6.0;
    const double center = 1.0 / wave.wavelength_m;
    const double deviation = 1.0 / (2.0 * core::kPi * wave.sigma_m);
    wave.frequency_step = 1.0 / (span_m + kWaveReach * wave.sigma_m);
    const double lowest = std::max(0.0, center - 3.0 * deviation);
    const double first = std::max(1.0, std::ceil(lowest / wave.frequency_step));
    wave.first_frequency = first * wave.frequency_step;
    for (double i = first; i * wave.frequency_step <= center + 3.0 * deviation; ++i) {
        const double x = (i * wave.frequency_step - center) / deviation;
        wave.amplitudes.push_back(std::exp(-0.5 * x * x));
    }
    const double sum = std::accumulate(wave.amplitudes.begin(), wave.amplitudes.end(), 0.0);
    for (double& amplitude : wave.amplitudes) amplitude /= sum;
    return wave;
}

VirtualWave VirtualWave::part(std::size_t begin, std::size_t end) const {
    VirtualWave result = *this;
    result.first_frequency = frequency(begin);
    result.amplitudes.assign(amplitudes.begin() + static_cast<std::ptrdiff_t>(begin),
                             amplitudes.begin() + static_cast<std::ptrdiff_t>(end));
    return result;
}

std::vector<ComplexF> analyse(const MethodInput& input,
                              const VirtualWave& wave,
                              const core::BinRange& bins,
                              std::array<std::size_t, 2> pairs) {
    const std::size_t num_pairs = pairs[1] - pairs[0];
    const std::size_t n = wave.size();
    const Matrix basis = analysis_basis(wave, input.time_axis, bins);
    std::vector<ComplexF> coefficients(n * num_pairs);
    core::parallel_blocks(num_pairs, kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
        const Matrix block =
            basis * histograms_of(input.transient, pairs[0] + begin, end - begin, bins);
        for (std::size_t pair = begin; pair < end; ++pair) {
            const double segment = input.scan.device_segments_m(pairs[0] + pair);
            const float* values = block.col(static_cast<Eigen::Index>(pair - begin)).data();
            for (std::size_t i = 0; i < n; ++i) {
                const ComplexF value{values[i], values[n + i]};
                const UnitPhasor p = unit_phasor(wave.frequency(i) * segment);
                coefficients[i * num_pairs + pair] = value * ComplexF{p.re, p.im};
            }
        }
    });
    return coefficients;
}

core::TimeAxis filtered_axis(const core::TimeAxis& axis, const PhasorSettings& settings) {
    const double sigma = settings.cycles * *settings.wavelength_m / 6.0;
    const double margin = std::ceil(kWaveReach * sigma / axis.bin_width_m);
    const std::size_t factor = std::max<std::size_t>(1, oversampling(axis, settings));
    core::TimeAxis finer = axis;
    finer.opl_start_m -= margin * axis.bin_width_m;
    finer.bin_width_m /= static_cast<double>(factor);
    finer.num_bins = (axis.num_bins + 2 * static_cast<int>(margin)) * static_cast<int>(factor);
    return finer;
}

FilteredHistograms filter_histograms(const MethodInput& input,
                                     const PhasorSettings& settings,
                                     WavePart part) {
    const core::TimeAxis axis = filtered_axis(input.time_axis, settings);
    const std::size_t num_pairs = input.transient.num_pairs();
    const VirtualWave wave =
        make_virtual_wave(settings, axis.bin_width_m * static_cast<double>(axis.num_bins));
    const core::BinRange bins{0, input.time_axis.num_bins};
    const Matrix analysis = analysis_basis(wave, input.time_axis, bins);
    const Matrix synthesis = phases(wave,
                                    axis.bin_center_m(0.0),
                                    axis.bin_width_m,
                                    static_cast<std::size_t>(axis.num_bins),
                                    1)
                                 .transpose();
    const auto n = static_cast<Eigen::Index>(wave.size());
    FilteredHistograms result{axis, core::Transient(num_pairs, axis.num_bins)};
    core::parallel_blocks(num_pairs, kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
        const Matrix block = analysis * histograms_of(input.transient, begin, end - begin, bins);
        const auto cosines = synthesis.leftCols(n);
        const auto sines = synthesis.rightCols(n);
        const auto re = block.topRows(n);
        const auto im = block.bottomRows(n);
        Eigen::Map<Matrix> filtered(result.transient.histogram(begin).data(),
                                    axis.num_bins,
                                    static_cast<Eigen::Index>(end - begin));
        if (part == WavePart::Real) {
            filtered = cosines * re - sines * im;
        } else {
            filtered = cosines * im + sines * re;
        }
    });
    return result;
}

}  // namespace nlos
