// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/transient.h"

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

/// All of the same shape.
ErrorSums errors_of(const core::Transient& x, const core::Transient& a, const core::Transient& b);

}  // namespace apps
