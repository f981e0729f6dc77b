// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace nlos {

/// The middle value, or the mean of the middle two; `values` must not be empty.
double median(std::vector<double> values);

}  // namespace nlos
