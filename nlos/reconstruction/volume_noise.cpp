// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/volume_noise.h"

#include "renderer/core/statistics.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kSharedDepths = 2;  // depths on either side that share a deviation
constexpr double kSafety = 2.0;           // more independent values than were found

/// Chance that one value exceeds `t` deviations by noise alone.
double chance_of_one(double t, VolumeScale scale) {
    if (scale == VolumeScale::Magnitude) return std::exp(-0.5 * t * t);  // the length of a phasor
    return 0.5 * std::erfc(t / std::sqrt(2.0));
}

/// Sums of squared upward differences at every depth, and how many they are.
struct SquaredDifferences {
    std::vector<double> sum;
    std::vector<double> count;
};

SquaredDifferences upward_differences(const Volume& volume, const Volume& again) {
    const std::size_t nz = volume.axes.z_m.size();
    SquaredDifferences differences{std::vector<double>(nz), std::vector<double>(nz)};
    for (std::size_t i = 0; i < volume.values.size(); ++i) {
        if (!(volume.values[i] > 0.0F && again.values[i] > volume.values[i])) continue;
        const double rise = brightness_of(again.values[i]) - brightness_of(volume.values[i]);
        differences.sum[i % nz] += rise * rise;
        differences.count[i % nz] += 1.0;
    }
    return differences;
}

/// The median of the largest rise in every column, in deviations.
double median_largest_rise(const Volume& volume, const Volume& again, const VolumeNoise& noise) {
    const std::size_t nz = volume.axes.z_m.size();
    std::vector<double> largest(volume.values.size() / nz, 0.0);
    for (std::size_t i = 0; i < volume.values.size(); ++i) {
        const double rise = brightness_of(again.values[i]) - brightness_of(volume.values[i]);
        double& top = largest[i / nz];
        top = std::max(top, noise.significance(rise, i % nz));
    }
    return core::upper_median(std::move(largest));
}

}  // namespace

double brightness_of(float value) {
    return std::max(0.0, static_cast<double>(value));
}

VolumeNoise::VolumeNoise(const Volume& volume, const Volume& again, VolumeScale scale)
    : scale_(scale), sigma_(volume.axes.z_m.size(), 0.0) {
    const SquaredDifferences squares = upward_differences(volume, again);
    const std::size_t nz = sigma_.size();
    for (std::size_t iz = 0; iz < nz; ++iz) {
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t jz = iz - std::min(iz, kSharedDepths);
             jz < std::min(nz, iz + kSharedDepths + 1);
             ++jz) {
            sum += squares.sum[jz];
            count += squares.count[jz];
        }
        if (count > 0.0) sigma_[iz] = std::sqrt(sum / count);
    }
    if (volume.values.empty()) return;
    const double median = median_largest_rise(volume, again, *this);
    const double below = 1.0 - chance_of_one(median, VolumeScale::Amplitude);
    independent_values_ = std::max(1.0, kSafety * std::log(0.5) / std::log(below));
}

double VolumeNoise::chance_in_column(double significance) const {
    const double one = std::min(chance_of_one(significance, scale_), 1.0 - 1e-12);
    return -std::expm1(independent_values_ * std::log1p(-one));
}

double VolumeNoise::significance_of_chance(double chance) const {
    double low = 0.0;
    double high = 40.0;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (chance_in_column(middle) > chance ? low : high) = middle;
    }
    return high;
}

}  // namespace nlos
