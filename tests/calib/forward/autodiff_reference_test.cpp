// SPDX-License-Identifier: MIT
// The kernel's analytic gradients against automatic derivatives of the same formula.
#include "renderer/core/random.h"
#include "renderer/triangle/triangle_splines.h"
#include "tests/support/statistics.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

namespace {

using Jet = ceres::Jet<double, 3>;

TEST(TriangleSplines, GradientsMatchJets) {
    core::Rng rng(test_support::seed_of("GradientsMatchJets"), 0, 0);
    for (int trial = 0; trial < 300; ++trial) {
        const auto spread = [&] { return std::pow(10.0, -6.0 + 7.5 * rng.uniform()); };
        const std::array<double, 3> knots{0.0, spread() * (rng.uniform() - 0.5), spread()};
        const std::array<Jet, 3> jets{Jet(knots[0], 0), Jet(knots[1], 1), Jet(knots[2], 2)};
        const renderer::TriangleSplines<double> splines(knots, renderer::Smear::Gaussian);
        const renderer::TriangleSplines<Jet> reference(jets, renderer::Smear::Gaussian);
        renderer::TriangleSplines<double>::Values values;
        renderer::TriangleSplines<Jet>::Values exact;
        for (int i = 0; i <= 20; ++i) {
            const double edge = -7.0 + (14.0 + knots[2]) * i / 20.0;
            splines.evaluate(edge, true, values);
            reference.evaluate(edge, false, exact);
            for (std::size_t j = 0; j < 3; ++j) {
                EXPECT_NEAR(values.fraction[j], exact.fraction[j].a, 1e-12);
                for (std::size_t k = 0; k < 3; ++k) {
                    const auto pair = renderer::TriangleSplines<double>::pair_index(j, k);
                    const double gradient = (j == k ? 2.0 : 1.0) * values.gradient[pair];
                    EXPECT_NEAR(gradient, exact.fraction[j].v[static_cast<int>(k)], 1e-10);
                }
            }
        }
    }
}

}  // namespace
