// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/volume.h"

#include <cstddef>
#include <vector>

namespace nlos {

/// What a method's values are: amplitudes, to which noise adds, or magnitudes of a complex field, to
/// which it adds.
enum class VolumeScale { Amplitude, Magnitude };

/// A voxel's value; 0 for those below it.
double brightness_of(float value);

/// How much of a volume can be noise, told from the same scene measured again.
///
/// Noise differs much between depths, which a falloff of range^4 has raised differently, and little
/// across the wall: its deviation is a function of depth. Differences of the two volumes are taken
/// where the first is positive and the second exceeds it: methods that cut off negative values
/// leave these alone, and of noise without bias they have its whole mean square.
class VolumeNoise {
 public:
    /// volume   of the measurement
    /// again    of one with noise of the same deviation on top, see measure_again()
    VolumeNoise(const Volume& volume, const Volume& again, VolumeScale scale);

    /// Standard deviation of amplitudes at a depth; 0 where the volume is dark.
    double sigma(std::size_t iz) const { return sigma_[iz]; }

    /// An amplitude in deviations of its depth; 0 where the volume is dark.
    double significance(double amplitude, std::size_t iz) const {
        return sigma_[iz] > 0.0 ? amplitude / sigma_[iz] : 0.0;
    }

    /// The chance that the most significant of a column's voxels is at least this significant by
    /// noise alone: that of as many independent values as explain how large the noise of half of
    /// all columns becomes, doubled for safety.
    double chance_in_column(double significance) const;

    /// The significance of which that chance is `chance`.
    double significance_of_chance(double chance) const;

 private:
    VolumeScale scale_;
    std::vector<double> sigma_;
    double independent_values_ = 1.0;  ///< in a column
};

}  // namespace nlos
