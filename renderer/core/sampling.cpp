// SPDX-License-Identifier: MIT
#include "renderer/core/sampling.h"

#include <cassert>
#include <limits>

namespace core {

Vec3 sample_cosine_hemisphere(const Vec2& u) {
    const double radius = std::sqrt(u.x());
    const double angle = 2.0 * kPi * u.y();
    return {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1.0 - u.x())};
}

double pdf_cosine_hemisphere(const Vec3& direction) {
    return std::max(0.0, direction.z()) / kPi;
}

Vec3 sample_sphere(const Vec2& u) {
    const double z = 1.0 - 2.0 * u.x();
    const double radius = 2.0 * std::sqrt(u.x() * (1.0 - u.x()));
    const double angle = 2.0 * kPi * u.y();
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

DiscreteDistribution::DiscreteDistribution(std::span<const double> weights)
    : cumulative_(weights.size()) {
    for (std::size_t i = 0; i < weights.size(); ++i) {
        assert(weights[i] >= 0.0 && std::isfinite(weights[i]));
        sum_ += weights[i];
        cumulative_[i] = sum_;
    }
    assert(sum_ > 0.0);
    for (double& value : cumulative_) value /= sum_;
    // Trailing zero weights must keep an empty interval although rounding lifts the end to 1.
    for (std::size_t i = cumulative_.size();
         i-- > 0 && (i + 1 == cumulative_.size() || weights[i + 1] == 0.0);) {
        cumulative_[i] = 1.0;
    }
}

std::size_t DiscreteDistribution::sample(double u, double& remapped) const {
    const auto it = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
    const auto index = static_cast<std::size_t>(it - cumulative_.begin());
    remapped = interval_of(index).remap(u);
    return index;
}

DiscreteDistribution::Interval DiscreteDistribution::interval_of(std::size_t index) const {
    const double begin = index == 0 ? 0.0 : cumulative_[index - 1];
    const double end = cumulative_[index];
    return {index, begin, end, 1.0 / std::max(end - begin, std::numeric_limits<double>::min())};
}

DiscreteDistribution::Interval DiscreteDistribution::interval_from(std::size_t hint,
                                                                   double u) const {
    if (u < cumulative_[hint]) return interval_of(hint);
    // Gallop: intervals are usually narrower than the steps of u only by a small factor.
    std::size_t step = 1;
    std::size_t low = hint;
    while (low + step < cumulative_.size() && cumulative_[low + step - 1] <= u) {
        low += step;
        step *= 2;
    }
    const auto first = cumulative_.begin() + static_cast<std::ptrdiff_t>(low);
    const auto last =
        cumulative_.begin() + static_cast<std::ptrdiff_t>(std::min(low + step, cumulative_.size()));
    return interval_of(
        static_cast<std::size_t>(std::upper_bound(first, last, u) - cumulative_.begin()));
}

}  // namespace core
