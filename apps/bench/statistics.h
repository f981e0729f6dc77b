// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/transient.h"

#include <cstddef>
#include <span>
#include <vector>

namespace apps {

/// Sums over values that errors against a truth known twice, by independent estimates a and b, are
/// made of: the mean of (x - a) (x - b) is the squared error of x, without that of a and b.
struct ErrorSums {
    double squared = 0.0;
    double trimmed = 0.0;  ///< without the worst 0.2 % of values
    double reference = 0.0;
    double sum = 0.0;
    double reference_sum = 0.0;

    ErrorSums& operator+=(const ErrorSums& other) {
        squared += other.squared;
        trimmed += other.trimmed;
        reference += other.reference;
        sum += other.sum;
        reference_sum += other.reference_sum;
        return *this;
    }
    double rel_mse() const { return squared / reference; }
    double trimmed_rel_mse() const { return trimmed / reference; }
};

/// y = coefficient * x^exponent.
struct PowerLaw {
    double coefficient = 0.0;
    double exponent = 0.0;
};

/// The law whose line lies closest to the points by least squares, in logarithms of both. All
/// values are above 0; with fewer than two different x the exponent is 0.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

/// Mean of independent values and its standard error; 0 for a single value.
struct Estimate {
    double mean = 0.0;
    double standard_error = 0.0;
};
Estimate estimate_of(const std::vector<double>& values);

/// All of the same shape.
ErrorSums errors_of(const core::Transient& x, const core::Transient& a, const core::Transient& b);

/// Errors of the frames of a sequence, over several runs.
class SequenceErrors {
 public:
    explicit SequenceErrors(std::size_t num_frames) : of_frames_(num_frames) {}

    /// Adds a run; frame by frame, truth by way of two references.
    void add(std::span<const core::Transient> frames,
             std::span<const core::Transient> a,
             std::span<const core::Transient> b);

    std::vector<double> rel_mse_of_frames() const;
    /// All frames from one on together: reuse has to settle.
    ErrorSums settled(std::size_t first_frame) const;

 private:
    std::vector<ErrorSums> of_frames_;
};

}  // namespace apps
