// SPDX-License-Identifier: MIT
#include "renderer/triangle/normal_integrals.h"

#include "renderer/core/types.h"

namespace renderer {

NormalIntegralTable::NormalIntegralTable() {
    for (std::size_t node = 0; node < kNumNodes; ++node) {
        const double u = static_cast<double>(node) / kNodesPerUnit - kReach;
        const double density = std::exp(-0.5 * u * u) / std::sqrt(2.0 * core::kPi);
        const double cumulative = 0.5 * std::erfc(-std::sqrt(0.5) * u);
        Coefficients& c = nodes_[node];
        c[3] = cumulative;
        c[2] = u * c[3] + density;
        c[1] = 0.5 * (u * c[2] + c[3]);
        c[0] = (u * c[1] + c[2]) / 3.0;
        c[4] = density;
        c[5] = -u * density;
        for (std::size_t k = 6; k < kTerms; ++k) {
            c[k] = -u * c[k - 1] - static_cast<double>(k - 5) * c[k - 2];
        }
        double factorial = 1.0;
        for (std::size_t k = 2; k < kTerms; ++k) {
            factorial *= static_cast<double>(k);
            c[k] /= factorial;
        }
    }
}

const NormalIntegralTable& NormalIntegralTable::instance() {
    static const NormalIntegralTable kTable;
    return kTable;
}

}  // namespace renderer
