// SPDX-License-Identifier: MIT
#include "renderer/core/simd.h"

#include "renderer/core/random.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace {

using core::load;
using core::Simd;

struct alignas(64) Lanes {
    std::array<double, 2 * Simd::size()> values;
};

Lanes random_lanes(core::Rng& rng) {
    Lanes lanes;
    // Small whole numbers are often equal, and add up exactly.
    for (double& value : lanes.values) value = 0.5 * std::floor(9.0 * rng.uniform()) - 2.0;
    return lanes;
}

TEST(Simd, DoesToEachLaneWhatIsDoneToNumbers) {
    core::Rng rng(test_support::seed_of("Simd.DoesToEachLane"), 0, 0);
    constexpr std::size_t kBegin = Simd::size();
    for (int trial = 0; trial < 200; ++trial) {
        const Lanes x = random_lanes(rng);
        const Lanes y = random_lanes(rng);
        const Simd a = load(x.values, kBegin);
        const Simd b = load(y.values, kBegin);
        Simd sum = a;
        sum += b;
        Simd product = a;
        product *= b;
        const core::SimdMask less = a < b;
        const core::SimdMask both = (a <= b) & !(b != 1.0);
        const Simd chosen = core::select(less, 2.0 * a, a / 4.0 - b);
        Lanes stored{};
        core::store(core::sqrt(a * a), stored.values, kBegin);
        bool any = false;
        for (std::size_t i = 0; i < Simd::size(); ++i) {
            const double p = x.values[kBegin + i];
            const double q = y.values[kBegin + i];
            EXPECT_EQ(sum[i], p + q);
            EXPECT_EQ(product[i], p * q);
            EXPECT_EQ((-a)[i], -p);
            EXPECT_EQ(core::max(a, b)[i], std::max(p, q));
            EXPECT_EQ(core::min(a, b)[i], std::min(p, q));
            EXPECT_EQ(floor(a)[i], std::floor(p));
            EXPECT_EQ(stored.values[kBegin + i], std::abs(p));
            EXPECT_EQ(stored.values[i], 0.0);
            EXPECT_EQ(less.bits() >> i & 1U, p < q ? 1U : 0U);
            EXPECT_EQ(both.bits() >> i & 1U, p <= q && q == 1.0 ? 1U : 0U);
            EXPECT_EQ(chosen[i], p < q ? 2.0 * p : p / 4.0 - q);
            any |= p < q;
        }
        EXPECT_EQ(less.any(), any);
        EXPECT_EQ(less.bits() >> Simd::size(), 0U);
        const auto begin = x.values.begin() + kBegin;
        EXPECT_EQ(core::sum_of(a), std::accumulate(begin, x.values.end(), 0.0));
        EXPECT_EQ(core::reduce_min(a), *std::min_element(begin, x.values.end()));
        EXPECT_EQ(core::reduce_max(a), *std::max_element(begin, x.values.end()));
    }
}

}  // namespace
