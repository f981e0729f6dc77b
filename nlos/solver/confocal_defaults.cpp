// SPDX-License-Identifier: MIT
#include "nlos/solver/confocal_defaults.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

// Weights of total variation where light is plenty: the fourth root of how scarce it is multiplies
// them. `nlos bench weights` holds what follows from them against a search. What radiance leaves
// unexplained is the model's error, much alike at neighbouring points, where counts have noise of
// their own.
constexpr double kPoissonWeight = 0.35;
constexpr double kGaussianWeight = 0.6;
constexpr double kPlenty = 150.0;  // photons per wall point
constexpr double kFewest = 0.6;    // fewer weigh as these

// Powers of how far the response smears depth, where the model tells all of the light: then a
// smaller weight shows more of the shape, and takes longer to settle.
constexpr double kSmearedWeight = -2.5;
constexpr double kSmearedTolerance = -2.0;

// Of the relative change of the albedo.
constexpr double kToleranceOfGrids = 0.015;
constexpr double kToleranceUnderSpot = 0.001;

/// Fraction of the wall points that were observed at all.
double observed_fraction(const ConfocalProblem& data) {
    const auto num_seen = std::ranges::count_if(
        data.observed, [](const core::BinRange& seen) { return seen.size() > 0; });
    return static_cast<double>(num_seen) / static_cast<double>(data.observed.size());
}

}  // namespace

double default_weight(const ConfocalProblem& data) {
    const double smeared = data.is_confined ? std::pow(data.blur, kSmearedWeight) : 1.0;
    if (data.likelihood == Likelihood::Gaussian) {
        return kGaussianWeight * smeared * std::pow(observed_fraction(data), -0.25);
    }
    const double photons = std::max(kFewest, data.photons_per_point);
    return kPoissonWeight * smeared * std::pow(std::max(1.0, kPlenty / photons), 0.25);
}

double default_tolerance(const ConfocalProblem& data) {
    const double smeared = data.is_confined ? std::pow(data.blur, kSmearedTolerance) : 1.0;
    const double full = data.is_under_spot ? kToleranceUnderSpot : kToleranceOfGrids * smeared;
    return full * std::sqrt(observed_fraction(data));
}

std::vector<double> voxel_noise(const ConfocalProblem& data, const WallGrid& grid) {
    const ConeKernel kernel(data.cone, grid);
    const std::size_t num_v = data.cone.num_v();
    std::vector<double> fraction(num_v + 1, 0.0);  // of K's square, per shift from u to v
    for (std::size_t ix = 0; ix < kernel.qx(); ++ix) {
        for (std::size_t iy = 0; iy < kernel.qy(); ++iy) {
            const ConeEntry& entry = kernel.entry(ix, iy);
            fraction[entry.shift] += std::pow(static_cast<double>(entry.here), 2);
            fraction[entry.shift + 1] += std::pow(static_cast<double>(entry.next), 2);
        }
    }
    const std::vector<double> light = data.time.normal_diagonal(data.precision);
    const double observed = observed_fraction(data);
    std::vector<double> noise(num_v);
    for (std::size_t u = 0; u < num_v; ++u) {
        double sum = 0.0;
        double weights = 0.0;
        for (std::size_t shift = 0; u + shift < num_v; ++shift) {
            sum += fraction[shift] * light[u + shift];
            weights += fraction[shift];
        }
        noise[u] = weights > 0.0 ? std::sqrt(observed * sum / weights) : 0.0;
    }
    return noise;
}

}  // namespace nlos
