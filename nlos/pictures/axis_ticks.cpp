// SPDX-License-Identifier: MIT
#include "nlos/pictures/axis_ticks.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nlos {
namespace {

/// The first and last multiple of a step inside an axis, in steps.
struct Multiples {
    double first;
    double last;
};

Multiples multiples_inside(double low, double high, double step) {
    const double slack = 1e-6 * (high - low);
    return {std::ceil((low - slack) / step), std::floor((high + slack) / step)};
}

/// The smallest of 1, 2, 5 x 10^k of which at most `at_most` multiples lie inside the axis.
double round_step(double low, double high, int at_most) {
    double decade = std::pow(10.0, std::floor(std::log10((high - low) / at_most)));
    while (true) {
        for (const double factor : {1.0, 2.0, 5.0}) {
            const auto [first, last] = multiples_inside(low, high, factor * decade);
            if (last - first + 1.0 <= at_most) return factor * decade;
        }
        decade *= 10.0;
    }
}

/// Powers of ten worth taking out of the labels: only far from everyday numbers.
int common_exponent(double largest) {
    if (largest >= 0.01 && largest < 1e5) return 0;
    return 3 * static_cast<int>(std::floor(std::log10(largest) / 3.0));
}

/// "10⁻⁶".
std::string power_of_ten(int exponent) {
    constexpr std::array kRaised{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = exponent < 0 ? "10⁻" : "10";
    for (const char digit : std::to_string(std::abs(exponent))) {
        text += kRaised[static_cast<std::size_t>(digit - '0')];
    }
    return text;
}

}  // namespace

AxisTicks choose_ticks(double low, double high, int at_most) {
    AxisTicks ticks;
    if (low > high) std::swap(low, high);
    const double span = high - low;
    if (!(span > 0.0) || !std::isfinite(span)) return ticks;

    const double step = round_step(low, high, std::max(1, at_most));
    const auto [first, last] = multiples_inside(low, high, step);
    ticks.exponent = common_exponent(std::max(std::abs(low), std::abs(high)));
    const double scale = std::pow(10.0, -ticks.exponent);
    const int decimals =
        std::clamp(static_cast<int>(-std::floor(std::log10(step * scale) + 1e-9)), 0, 9);
    for (double multiple = first; multiple <= last; multiple += 1.0) {
        const double value = multiple * step + 0.0;  // + 0.0 turns -0 into 0
        ticks.values.push_back(value);
        const std::string digits = fmt::format("{:.{}f}", std::abs(value) * scale, decimals);
        ticks.labels.push_back((value < 0.0 ? "−" : "") + digits);
    }
    return ticks;
}

std::string label_with_exponent(std::string label, int exponent) {
    if (exponent == 0) return label;
    const std::size_t unit = label.find('[');
    if (unit == std::string::npos) return label + " [" + power_of_ten(exponent) + "]";
    return label.insert(unit + 1, power_of_ten(exponent) + " ");
}

}  // namespace nlos
