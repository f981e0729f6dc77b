// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace nlos {

/// Cosine and sine of a phase.
struct UnitPhasor {
    float re = 1.0F;
    float im = 0.0F;
};

/// exp(2 pi i turns) within 1e-6, free of branches so that loops over it become vector code.
///
/// turns   phase in full turns, of any size; double keeps its fraction exact enough
/// source  Taylor series of half the angle, |angle / 2| <= pi / 2, then the double-angle formulas
inline UnitPhasor unit_phasor(double turns) {
    const auto h = static_cast<float>((turns - std::nearbyint(turns)) * 3.14159265358979323846);
    const float h2 = h * h;
    const float sine =
        h * (1.0F + h2 * (-1.0F / 6.0F +
                          h2 * (1.0F / 120.0F + h2 * (-1.0F / 5040.0F +
                                                      h2 * (1.0F / 362880.0F +
                                                            h2 * (-1.0F / 39916800.0F +
                                                                  h2 * (1.0F / 6227020800.0F)))))));
    const float cosine =
        1.0F +
        h2 * (-0.5F + h2 * (1.0F / 24.0F +
                            h2 * (-1.0F / 720.0F +
                                  h2 * (1.0F / 40320.0F +
                                        h2 * (-1.0F / 3628800.0F + h2 * (1.0F / 479001600.0F))))));
    return {1.0F - 2.0F * sine * sine, 2.0F * sine * cosine};
}

}  // namespace nlos
