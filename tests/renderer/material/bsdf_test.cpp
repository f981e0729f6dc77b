// SPDX-License-Identifier: MIT
#include "renderer/material/bsdf.h"

#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "renderer/core/simd.h"
#include "renderer/material/ggx.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace {

using core::Vec3;
using renderer::Bsdf;

const std::vector<Bsdf> kSampled{renderer::Lambertian{0.8},
                                 renderer::Ggx{0.9, 0.05},
                                 renderer::Ggx{0.5, 0.3},
                                 renderer::Ggx{1.0, 1.0},
                                 renderer::Dielectric{0.6, 0.05},
                                 renderer::Dielectric{0.8, 0.4}};

Vec3 direction_at(double cosine, double azimuth) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

// Counts over a grid of (cosine, azimuth) against the density, integrated finely over each cell;
// what falls below the surface is one more cell.
double sampler_p_value(const Bsdf& bsdf, const Vec3& incoming) {
    constexpr int kRows = 12;
    constexpr int kColumns = 12;
    constexpr int kFine = 60;
    constexpr int kDraws = 200'000;
    std::vector<double> observed(kRows * kColumns + 1, 0.0);
    std::vector<double> expected(kRows * kColumns + 1, 0.0);
    core::Rng rng(test_support::seed_of("Bsdf.sampler"), 0, 0);
    for (int i = 0; i < kDraws; ++i) {
        const double u1 = rng.uniform();
        const auto out = renderer::sample_bsdf(bsdf, incoming, {u1, rng.uniform()});
        std::size_t cell = kRows * kColumns;
        if (out) {
            const double share = std::atan2(out->y(), out->x()) / (2.0 * core::kPi) + 0.5;
            const int row = std::min(kRows - 1, static_cast<int>(std::abs(out->z()) * kRows));
            const int column = std::min(kColumns - 1, static_cast<int>(share * kColumns));
            cell = static_cast<std::size_t>(row * kColumns + column);
        }
        observed[cell] += 1.0;
    }
    const double side = incoming.z() > 0.0 ? 1.0 : -1.0;
    double total = 0.0;
    for (int i = 0; i < kRows * kFine; ++i) {
        for (int j = 0; j < kColumns * kFine; ++j) {
            const double cosine = (i + 0.5) / (kRows * kFine);
            const double azimuth = 2.0 * core::kPi * ((j + 0.5) / (kColumns * kFine) - 0.5);
            Vec3 out = direction_at(cosine, azimuth);
            out.z() *= side;
            const double share = renderer::pdf_bsdf(bsdf, incoming, out) * 2.0 * core::kPi /
                                 (kRows * kFine * kColumns * kFine);
            expected[static_cast<std::size_t>(i / kFine * kColumns + j / kFine)] += kDraws * share;
            total += share;
        }
    }
    expected.back() = std::max(0.0, 1.0 - total) * kDraws;
    return test_support::chi_square_p_value(observed, expected);
}

TEST(Bsdf, SamplesMatchTheirDensity) {
    const std::vector<Vec3> incomings{direction_at(0.98, 0.3),
                                      direction_at(0.5, 2.0),
                                      direction_at(0.15, -1.0),
                                      direction_at(-0.6, 1.0)};
    const double level = test_support::sidak_level(1e-3, kSampled.size() * incomings.size());
    for (std::size_t model = 0; model < kSampled.size(); ++model) {
        for (const Vec3& incoming : incomings) {
            EXPECT_GT(sampler_p_value(kSampled[model], incoming), level)
                << "model " << model << " incoming z " << incoming.z();
        }
    }
}

// White furnace: what a surface reflects of light from all sides never exceeds what arrives, and a
// white Lambertian surface reflects all of it.
TEST(Bsdf, ReflectsAtMostAllEnergy) {
    constexpr int kDraws = 100'000;
    for (const Bsdf& bsdf : kSampled) {
        for (const double cosine : {0.99, 0.5, 0.1}) {
            core::Rng rng(test_support::seed_of("Bsdf.furnace"), 0, 0);
            double sum = 0.0;
            for (int i = 0; i < kDraws; ++i) {
                const Vec3 incoming = direction_at(cosine, 0.7);
                const double u1 = rng.uniform();
                const auto out = renderer::sample_bsdf(bsdf, incoming, {u1, rng.uniform()});
                if (!out) continue;
                const double weight = renderer::evaluate_bsdf(bsdf, incoming, *out) * out->z() /
                                      renderer::pdf_bsdf(bsdf, incoming, *out);
                // Where a body reflects beside an interface, single samples may weigh more.
                if (!std::holds_alternative<renderer::Dielectric>(bsdf)) {
                    ASSERT_LE(weight, 1.0 + 1e-9);
                }
                sum += weight;
            }
            const double reflected = sum / kDraws;
            EXPECT_GT(reflected, 0.0);
            EXPECT_LE(reflected, 1.0 + 1e-9);
            if (std::holds_alternative<renderer::Lambertian>(bsdf)) {
                EXPECT_NEAR(reflected, 0.8, 1e-9);
            }
        }
    }
}

TEST(Bsdf, IsReciprocalAndOpaque) {
    core::Rng rng(test_support::seed_of("Bsdf.reciprocal"), 0, 0);
    for (const Bsdf& bsdf : kSampled) {
        for (int i = 0; i < 100; ++i) {
            const double u1 = rng.uniform();
            const Vec3 a = core::sample_sphere({u1, rng.uniform()});
            const double u2 = rng.uniform();
            const Vec3 b = core::sample_sphere({u2, rng.uniform()});
            const double value = renderer::evaluate_bsdf(bsdf, a, b);
            EXPECT_NEAR(value, renderer::evaluate_bsdf(bsdf, b, a), 1e-9 * (1.0 + value));
            EXPECT_EQ(value > 0.0, a.z() * b.z() > 0.0);
        }
    }
}

TEST(Bsdf, RetroreflectorsAreBlackForBsdfSampling) {
    const Bsdf bsdf = renderer::Retroreflective{1.0};
    EXPECT_EQ(renderer::evaluate_bsdf(bsdf, Vec3::UnitZ(), Vec3::UnitZ()), 0.0);
    EXPECT_FALSE(renderer::sample_bsdf(bsdf, Vec3::UnitZ(), {0.3, 0.3}));
}

TEST(Bsdf, GgxInVectorsIsGgx) {
    core::Rng rng(test_support::seed_of("Bsdf.GgxInVectors"), 0, 0);
    // Widths and cosines down to a thousandth.
    const auto down_to_thousandth = [&] { return std::pow(10.0, -3.0 * rng.uniform()); };
    constexpr std::size_t kSize = core::Simd::size();
    using Lanes = std::array<double, kSize>;
    for (int round = 0; round < 1000; ++round) {
        alignas(64) Lanes albedo, alpha, cos2, sin2, cos_in, cos_out, cos_half, expected;
        for (std::size_t i = 0; i < kSize; ++i) {
            const renderer::Ggx ggx{rng.uniform(), down_to_thousandth()};
            const double in_cosine = down_to_thousandth();
            const Vec3 in = direction_at(in_cosine, 7.0 * rng.uniform());
            const double out_cosine = down_to_thousandth();
            const Vec3 out = direction_at(out_cosine, 7.0 * rng.uniform());
            const Vec3 half = (in + out).normalized();
            albedo[i] = ggx.albedo;
            alpha[i] = ggx.alpha;
            cos2[i] = half.z() * half.z();
            sin2[i] = half.head<2>().squaredNorm();
            cos_in[i] = in.z();
            cos_out[i] = out.z();
            cos_half[i] = half.dot(in);
            expected[i] = renderer::evaluate_bsdf(ggx, in, out);
        }
        const auto all = [](const Lanes& lanes) { return core::load(lanes, 0); };
        const core::Simd density =
            renderer::ggx_normal_density<core::Simd>(all(alpha), all(cos2), all(sin2));
        const core::Simd value = renderer::ggx_value<core::Simd>(
            all(albedo), all(alpha), density, all(cos_in), all(cos_out), all(cos_half));
        for (std::size_t i = 0; i < kSize; ++i) {
            EXPECT_NEAR(value[i] / expected[i], 1.0, 1e-12);
        }
    }
}

}  // namespace
