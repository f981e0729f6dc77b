// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"
#include "renderer/core/random.h"
#include "renderer/third_bounce/third_bounce_visibility.h"

#include <array>
#include <cstdint>
#include <vector>

namespace renderer {

/// An estimate of a squared error; below 0 by chance only.
struct SquaredError {
    double value = 0.0;
    double variance = 0.0;  ///< of `value`

    SquaredError& operator+=(const SquaredError& other) {
        value += other.value;
        variance += other.variance;
        return *this;
    }
};

/// Of a pair's histogram, per bin: what two independent sets of rays find missing.
using VisibilityDifferences = std::array<std::vector<double>, 2>;

/// The product of both, summed over bins.
SquaredError squared_error_of(const VisibilityDifferences& differences);

/// Compares what wall points are taken to see of the elements with what rays to random points find.
///
/// The points are drawn by what the elements add to H. Where a ray contradicts the element's mask,
/// the difference counts in the bin of its path. Its sum has the error of H in that bin as its
/// expectation, and the product of the sums of two independent sets of rays has the squared error,
/// free of noise: shadows that are finer than the elements, and that cuts of any size miss alike,
/// show.
class VisibilityCheck {
 public:
    /// An end of a pair's paths, and what it is taken to see.
    struct End {
        const WallPoint& point;
        const VisibleElements& seen;
    };

    /// scene, elements   must outlive the check
    VisibilityCheck(const Scene& scene, const ElementSet& elements)
        : scene_(scene), set_(elements) {}

    /// Adds what is found for a pair's histogram and wall albedos of pi; several sets of elements
    /// add up.
    ///
    /// light, sensor   the same one twice for a confocal pair
    /// axis            of the histogram, its start reduced by the pair's device segments
    /// num_rays        in each set, from each end
    /// rng             of the pair
    void add_differences(const End& light,
                         const End& sensor,
                         const core::TimeAxis& axis,
                         std::size_t num_rays,
                         core::Rng rng,
                         VisibilityDifferences& sums);

    std::uint64_t num_rays() const { return num_rays_; }

 private:
    /// A random point of an element.
    struct Target {
        std::uint32_t element;
        std::array<double, 3> fraction;  ///< of the corners
        core::Vec3 position;             ///< relative to ElementSet::origin
    };

    void sum_masses(const WallPoint& light, const WallPoint& sensor);
    void draw_targets(std::size_t count, core::Rng& rng);
    void trace_from(const WallPoint& point);
    double weight_of(const Target& target, const WallPoint& light, const WallPoint& sensor) const;
    void add(const End& light,
             const End& sensor,
             const core::TimeAxis& axis,
             std::vector<double>& sums) const;

    const Scene& scene_;
    const ElementSet& set_;
    std::vector<double> mass_up_to_;  ///< sums over elements, each as if it were diffuse
    std::vector<Target> targets_;
    std::vector<bool> is_blocked_;  ///< per target
    std::uint64_t num_rays_ = 0;
};

}  // namespace renderer
