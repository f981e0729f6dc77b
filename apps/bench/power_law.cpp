// SPDX-License-Identifier: MIT
#include "apps/bench/power_law.h"

#include <cmath>

namespace apps {

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
    const double n = static_cast<double>(x.size());
    double mean_x = 0.0;
    double mean_y = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        mean_x += std::log(x[i]) / n;
        mean_y += std::log(y[i]) / n;
    }
    double xx = 0.0;
    double xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double offset = std::log(x[i]) - mean_x;
        xx += offset * offset;
        xy += offset * (std::log(y[i]) - mean_y);
    }
    const double exponent = xx > 0.0 ? xy / xx : 0.0;
    return {std::exp(mean_y - exponent * mean_x), exponent};
}

}  // namespace apps
