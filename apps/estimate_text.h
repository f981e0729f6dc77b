// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace apps {

/// A value and its standard deviation with so many decimals that both can be read against each
/// other: two significant digits of the deviation, as in "0.70002 +- 0.00013".
///
/// sigma    0: the value was not free and stands alone; infinite: the data do not determine it
std::string estimate_text(double value, double sigma);

}  // namespace apps
