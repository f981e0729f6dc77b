// SPDX-License-Identifier: MIT
#include "apps/bench_error.h"

#include <algorithm>
#include <vector>

namespace apps {

ErrorSums errors_of(const core::Transient& x, const core::Transient& a, const core::Transient& b) {
    constexpr double kTrimmedShare = 0.002;
    ErrorSums sums;
    std::vector<double> squares;
    for (std::size_t i = 0; i < x.values().size(); ++i) {
        const double vx = double{x.values()[i]};
        const double va = double{a.values()[i]};
        const double vb = double{b.values()[i]};
        squares.push_back((vx - va) * (vx - vb));
        sums.reference += va * vb;
        sums.sum += vx;
        sums.reference_sum += 0.5 * (va + vb);
    }
    const auto kept =
        static_cast<std::ptrdiff_t>(static_cast<double>(squares.size()) * (1.0 - kTrimmedShare));
    std::nth_element(squares.begin(), squares.begin() + kept, squares.end());
    for (std::size_t i = 0; i < squares.size(); ++i) {
        sums.squared += squares[i];
        if (static_cast<std::ptrdiff_t>(i) < kept) sums.trimmed += squares[i];
    }
    return sums;
}

}  // namespace apps
