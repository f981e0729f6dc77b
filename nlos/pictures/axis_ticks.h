// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace nlos {

/// Round numbers along an axis with the texts to print beside them.
struct AxisTicks {
    std::vector<double> values;
    std::vector<std::string> labels;  ///< of values / 10^exponent
    int exponent = 0;                 ///< a multiple of 3; to be named beside the axis unless 0
};

/// Chooses ticks at multiples of 1, 2 or 5 times a power of ten.
///
/// low, high   ends of the axis, in any order
/// at_most     the largest number of ticks wanted, at least 1
AxisTicks choose_ticks(double low, double high, int at_most);

/// The label of an axis with the power of ten that its numbers are multiples of, as a part of its
/// unit: "light [W]" becomes "light [10⁻⁶ W]".
std::string label_with_exponent(std::string label, int exponent);

}  // namespace nlos
