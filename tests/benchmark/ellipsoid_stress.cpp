// SPDX-License-Identifier: MIT
// Draws random ellipsoidal connections of every size and degeneracy; fails when one is bad.
//   ellipsoid_stress [COUNT] [SEED]
#include "tests/support/ellipsoid_stress.h"

#include <fmt/core.h>

#include <cstdlib>

int main(int argc, char** argv) {
    const std::uint64_t count = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000'000ULL;
    const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 0;
    const auto counts = test_support::stress_ellipsoid(count, seed);
    fmt::print("{} tried, {} drawn, {} bad\n", count, counts.drawn, counts.bad);
    return counts.bad == 0 ? 0 : 1;
}
