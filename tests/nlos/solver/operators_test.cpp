// SPDX-License-Identifier: MIT
#include "nlos/reconstruct.h"
#include "nlos/solver/cone_convolution.h"
#include "nlos/solver/proximal.h"
#include "nlos/solver/time_operator.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/nlos/solver/adjoint.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace nlos {
namespace {

using nlos_test::expect_adjoint;
using nlos_test::product;
using nlos_test::signed_values;

TimeOperator example_time_operator(bool has_response) {
    const core::TimeAxis axis{0.9, 0.016, 40};
    const core::ResponseFilter response =
        has_response ? core::sample_response(core::ExponentialGaussianResponse{0.03, 0.05}, 0.016)
                     : core::ResponseFilter{};
    return {axis, even_edges(0.45 * 0.45, 0.77 * 0.77, 36), 4.0, response};
}

TEST(TimeOperator, AdjointIsExact) {
    for (const bool has_response : {false, true}) {
        const TimeOperator time = example_time_operator(has_response);
        constexpr std::size_t kLanes = 5;
        const std::vector<float> x = signed_values(time.num_v() * kLanes, 1);
        const std::vector<float> y = signed_values(time.num_bins() * kLanes, 2);
        std::vector<float> ax(y.size());
        std::vector<float> aty(x.size());
        time.apply(x.data(), ax.data(), kLanes);
        time.apply_adjoint(y.data(), aty.data(), kLanes);
        expect_adjoint(ax, y, x, aty);
    }
}

TEST(TimeOperator, SolvesItsNormalEquations) {
    for (const bool has_response : {false, true}) {
        TimeOperator time = example_time_operator(has_response);
        std::vector<double> weights(time.num_bins());
        for (std::size_t t = 0; t < weights.size(); ++t)
            weights[t] = 0.1 + 0.02 * static_cast<double>(t);
        time.factorize(weights);
        const std::vector<float> right = signed_values(time.num_v(), 3);
        std::vector<float> x = right;
        time.solve(x.data(), 1);
        std::vector<float> bins(time.num_bins());
        std::vector<float> back(time.num_v());
        time.apply(x.data(), bins.data(), 1);
        for (std::size_t t = 0; t < bins.size(); ++t) bins[t] *= static_cast<float>(weights[t]);
        time.apply_adjoint(bins.data(), back.data(), 1);
        for (std::size_t v = 0; v < x.size(); ++v) EXPECT_NEAR(x[v] + back[v], right[v], 2e-5);
    }
}

TEST(TimeOperator, KeepsLightThatTheAxisHoldsAndDelaysItByTheResponse) {
    const core::TimeAxis axis{0.0, 0.02, 200};
    const std::vector<double> edges = even_edges(0.6 * 0.6, 1.0, 80);
    const core::InstrumentResponse response = core::ExponentialGaussianResponse{0.02, 0.06};
    const TimeOperator plain(axis, edges, 0.0, {});
    const TimeOperator blurred(axis, edges, 0.0, core::sample_response(response, 0.02));
    const std::vector<float> light(80, 1.0F);
    const auto moments_of = [&](const TimeOperator& time) {
        std::vector<float> bins(time.num_bins());
        time.apply(light.data(), bins.data(), 1);
        double sum = 0.0;
        double mean = 0.0;
        for (std::size_t t = 0; t < bins.size(); ++t) {
            sum += static_cast<double>(bins[t]);
            mean += static_cast<double>(bins[t]) * axis.bin_center_m(static_cast<double>(t));
        }
        return std::array{sum, mean / sum};
    };
    EXPECT_NEAR(moments_of(plain)[0], 80.0, 1e-3);
    EXPECT_NEAR(moments_of(blurred)[0], 80.0, 1e-3);
    EXPECT_NEAR(
        moments_of(blurred)[1] - moments_of(plain)[1], core::moments(response).mean_m, 1e-4);
}

// Light behind the axis's end and before its start belongs to it where the response moves it there.
TEST(TimeOperator, LightBeyondTheAxisComesInByTheResponse) {
    const core::TimeAxis all{0.8, 0.02, 60};
    const core::TimeAxis part{0.8 + 20 * 0.02, 0.02, 20};
    const std::vector<double> edges = even_edges(0.45 * 0.45, 0.95 * 0.95, 50);
    const auto response = core::sample_response(core::ExponentialGaussianResponse{0.05, 0.1}, 0.02);
    const TimeOperator whole(all, edges, 4.0, response);
    const TimeOperator cut(part, edges, 4.0, response);
    const std::vector<float> light = signed_values(50, 13);
    std::vector<float> whole_bins(60);
    std::vector<float> cut_bins(20);
    whole.apply(light.data(), whole_bins.data(), 1);
    cut.apply(light.data(), cut_bins.data(), 1);
    for (std::size_t t = 0; t < 20; ++t) EXPECT_FLOAT_EQ(cut_bins[t], whole_bins[t + 20]);
}

struct ConeExample {
    core::Capture capture =
        nlos_test::confocal_capture(nlos_test::wall_grid({9, 7}, {0.05, 0.06}), {0.8, 0.02, 30});
    WallFrame wall = derive_wall_frame(capture.scan.wall());
    VolumeAxes axes{};
    core::Progress progress{};
    Cone cone = make_cone({capture.scan.wall(),
                           capture.time_axis,
                           capture.transient,
                           wall,
                           axes,
                           {0.4, 0.7},
                           progress},
                          1);

    std::size_t at(std::size_t ix, std::size_t v, std::size_t iy) const {
        return (ix * cone.num_v() + v) * cone.ny + iy;
    }
};

TEST(ConeConvolution, AdjointIsExact) {
    const ConeExample example;
    for (const double spot_m : {0.0, 0.1}) {
        ConeConvolution convolution(example.cone, *example.wall.grid, spot_m, 1.0, 10.0);
        const std::vector<float> x = signed_values(convolution.num_values(), 4);
        const std::vector<float> y = signed_values(convolution.num_values(), 5);
        std::vector<float> ax(x.size());
        std::vector<float> aty(x.size());
        convolution.forward(x, ax);
        convolution.adjoint(y, aty);
        expect_adjoint(ax, y, x, aty);
    }
}

TEST(ConeConvolution, ShowsAVoxelOnTheLightCone) {
    const ConeExample example;
    ConeConvolution convolution(example.cone, *example.wall.grid, 0.0, 1.0, 10.0);
    ConeField voxel(convolution.num_values(), 0.0F);
    voxel[example.at(2, 3, 4)] = 1.0F;
    ConeField light(voxel.size());
    convolution.forward(voxel, light);
    double norm = 0.0;
    const ConeKernel kernel(example.cone, *example.wall.grid);
    for (std::size_t ix = 0; ix < 9; ++ix) {
        for (std::size_t iy = 0; iy < 7; ++iy) {
            const double dx = 0.05 * (static_cast<double>(ix) - 2.0);
            const double dy = 0.06 * (static_cast<double>(iy) - 4.0);
            const double expected = 3.0 + (dx * dx + dy * dy) / example.cone.v_width();
            double sum = 0.0;
            double mean = 0.0;
            for (std::size_t v = 0; v < example.cone.num_v(); ++v) {
                sum += static_cast<double>(light[example.at(ix, v, iy)]);
                mean += static_cast<double>(light[example.at(ix, v, iy)]) * static_cast<double>(v);
            }
            EXPECT_NEAR(mean / sum, expected, 1e-3);
            norm += sum;
        }
    }
    EXPECT_NEAR(norm, 63.0 / std::sqrt(kernel.squared_norm()), 1e-3);
}

/// At its fixed point inside the footprint, where c is known everywhere that f reaches:
/// K'(c - K f) + b = mu grad'grad f + nu f.
TEST(ConeConvolution, SolvesItsSystem) {
    const ConeExample example;
    constexpr double kMu = 0.7;
    constexpr double kNu = 3.0;
    ConeConvolution convolution(example.cone, *example.wall.grid, 0.0, kMu, kNu);
    const std::vector<float> c = signed_values(convolution.num_values(), 6);
    const std::vector<float> b = signed_values(convolution.num_values(), 7);
    ConeField light(c.size(), 0.0F);
    ConeField f;
    for (int i = 0; i < 400; ++i) {
        for (std::size_t k = 0; k < c.size(); ++k) light[k] = c[k] - light[k];
        f = b;
        convolution.solve(light, f);
    }
    ConeField rest(c.size());
    for (std::size_t k = 0; k < c.size(); ++k) rest[k] = c[k] - light[k];
    ConeField slope(c.size());
    convolution.adjoint(rest, slope);
    for (std::size_t ix = 1; ix + 1 < example.cone.nx; ++ix) {
        for (std::size_t v = 1; v + 1 < example.cone.num_v(); ++v) {
            for (std::size_t iy = 1; iy + 1 < example.cone.ny; ++iy) {
                const auto value = [&](std::size_t x, std::size_t z, std::size_t y) {
                    return static_cast<double>(f[example.at(x, z, y)]);
                };
                const double curvature = 6.0 * value(ix, v, iy) - value(ix - 1, v, iy) -
                                         value(ix + 1, v, iy) - value(ix, v - 1, iy) -
                                         value(ix, v + 1, iy) - value(ix, v, iy - 1) -
                                         value(ix, v, iy + 1);
                const std::size_t i = example.at(ix, v, iy);
                ASSERT_NEAR(static_cast<double>(slope[i] + b[i]),
                            kMu * curvature + kNu * value(ix, v, iy),
                            2e-4);
            }
        }
    }
}

/// How far K f of the footprint is from the light that solve() returns, relative to that: what
/// scatterers elsewhere add.
double fraction_from_elsewhere(bool is_confined) {
    const ConeExample example;
    ConeConvolution convolution(example.cone, *example.wall.grid, 0.0, 0.7, 3.0, is_confined);
    const std::vector<float> c = signed_values(convolution.num_values(), 6);
    ConeField light(c.size(), 0.0F);
    ConeField f;
    for (int i = 0; i < 400; ++i) {
        for (std::size_t k = 0; k < c.size(); ++k) light[k] = c[k] - light[k];
        f.assign(c.size(), 0.0F);
        convolution.solve(light, f);
    }
    ConeField own(c.size());
    convolution.forward(f, own);
    double squares = 0.0;
    for (std::size_t k = 0; k < c.size(); ++k) {
        squares += std::pow(static_cast<double>(own[k] - light[k]), 2);
    }
    return std::sqrt(squares / product(light, light));
}

// Of random light they explain three quarters, unless kept out. What is left then lies before and
// behind the volume in the footprint's own columns.
TEST(ConeConvolution, KeepsScatterersBesideTheFootprintOutOnDemand) {
    EXPECT_LT(fraction_from_elsewhere(true), 0.4 * fraction_from_elsewhere(false));
}

TEST(Proximal, PoissonMinimisesItsFunction) {
    for (const float y : {0.0F, 1.0F, 7.0F, 1e4F}) {
        for (const float e : {-30.0F, 0.0F, 0.5F, 8.0F, 1e4F}) {
            for (const float penalty : {1e-3F, 1.0F, 50.0F}) {
                const double m = static_cast<double>(poisson_proximal(y, e, penalty));
                ASSERT_GE(m, 0.0);
                const auto slope = [&](double x) {
                    return 1.0 - static_cast<double>(y) / x +
                           static_cast<double>(penalty) * (x - static_cast<double>(e));
                };
                if (m > 0.0) {
                    const double size =
                        1.0 + static_cast<double>(y) / m +
                        static_cast<double>(penalty) * (m + std::abs(static_cast<double>(e)));
                    EXPECT_NEAR(slope(m), 0.0, 1e-5 * size) << y << ' ' << e << ' ' << penalty;
                } else {
                    EXPECT_EQ(y, 0.0F);
                    EXPECT_GE(1.0 - static_cast<double>(penalty) * static_cast<double>(e), 0.0);
                }
            }
        }
    }
}

TEST(Proximal, DevianceIsThatOfPoissonCounts) {
    const auto log_likelihood = [](double y, double m) { return y * std::log(m) - m; };
    EXPECT_NEAR(
        poisson_deviance(7.0, 4.0), 2.0 * (log_likelihood(7, 7) - log_likelihood(7, 4)), 1e-12);
    EXPECT_NEAR(poisson_deviance(0.0, 2.5), 5.0, 1e-12);
    EXPECT_EQ(poisson_deviance(3.0, 3.0), 0.0);
}

}  // namespace
}  // namespace nlos
