// SPDX-License-Identifier: MIT
#include "renderer/material/bsdf.h"

#include "renderer/core/random.h"
#include "renderer/core/sampling.h"
#include "renderer/core/simd.h"
#include "renderer/material/ggx.h"
#include "tests/support/statistics.h"
#include "tests/support/surface_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace {

using core::Vec3;
using renderer::Bsdf;

using test_support::bsdf_text;
using test_support::bsdfs_of_all_models;

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
            const double fraction = std::atan2(out->y(), out->x()) / (2.0 * core::kPi) + 0.5;
            const int row = std::min(kRows - 1, static_cast<int>(std::abs(out->z()) * kRows));
            const int column = std::min(kColumns - 1, static_cast<int>(fraction * kColumns));
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
            const double fraction = renderer::pdf_bsdf(bsdf, incoming, out) * 2.0 * core::kPi /
                                    (kRows * kFine * kColumns * kFine);
            expected[static_cast<std::size_t>(i / kFine * kColumns + j / kFine)] +=
                kDraws * fraction;
            total += fraction;
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
    const std::vector<Bsdf> all = bsdfs_of_all_models({0.6}, {0.05, 0.3, 1.0});
    const double level = test_support::sidak_level(1e-3, all.size() * incomings.size());
    for (const Bsdf& bsdf : all) {
        for (const Vec3& incoming : incomings) {
            EXPECT_GT(sampler_p_value(bsdf, incoming), level)
                << bsdf_text(bsdf) << ", incoming z " << incoming.z();
        }
    }
}

// The reflected fraction by quadrature: points of a lattice through the sampler, which the test
// above checks.
double reflected_fraction(const Bsdf& bsdf, const Vec3& incoming) {
    constexpr int kPoints = 4096;
    const auto lobe = renderer::lobe_of(bsdf, std::abs(incoming.z()));
    double sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
        const auto out =
            renderer::sample_bsdf(bsdf, incoming, core::lattice_point(i, kPoints, {0.4, 0.3}));
        if (!out) continue;
        const double weight = renderer::evaluate_bsdf(bsdf, incoming, *out) * std::abs(out->z()) /
                              renderer::pdf_bsdf(bsdf, incoming, *out);
        // Where only some samples follow the lobe, single ones may weigh more.
        if (!lobe || lobe->fraction == 1.0) {
            EXPECT_LE(weight, 1.0 + 1e-9) << bsdf_text(bsdf);
        }
        sum += weight;
    }
    return sum / kPoints;
}

TEST(Bsdf, ReflectsAtMostItsBound) {
    constexpr double kQuadrature = 2e-3;
    for (const Bsdf& bsdf :
         bsdfs_of_all_models({0.0, 0.04, 0.3, 0.6, 1.0}, {1e-3, 0.03, 0.1, 0.3, 0.6, 1.0})) {
        for (const double cosine : {1e-3, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.85, 1.0}) {
            const double reflected = reflected_fraction(bsdf, direction_at(cosine, 0.7));
            const double most = renderer::reflects_at_most(bsdf, cosine);
            EXPECT_LE(reflected, most + kQuadrature) << bsdf_text(bsdf) << ", cosine " << cosine;
            EXPECT_LE(most, 1.0);
        }
    }
}

// As far as it has to be: what is bounded too high costs Russian roulette its use.
TEST(Bsdf, ReflectsAboutItsBoundAtNormalIncidence) {
    for (const Bsdf& bsdf : bsdfs_of_all_models({0.0, 0.3, 1.0}, {1e-3, 0.1})) {
        const double most = renderer::reflects_at_most(bsdf, 1.0);
        const double reflected = renderer::returned_to_source(bsdf).value_or(
            reflected_fraction(bsdf, Vec3(Vec3::UnitZ())));
        EXPECT_NEAR(most, reflected, 0.04) << bsdf_text(bsdf);
    }
}

TEST(Bsdf, IsReciprocalAndOpaque) {
    core::Rng rng(test_support::seed_of("Bsdf.reciprocal"), 0, 0);
    for (const Bsdf& bsdf : bsdfs_of_all_models({0.6}, {0.05, 0.3, 1.0})) {
        for (int i = 0; i < 100; ++i) {
            const double u1 = rng.uniform();
            const Vec3 a = core::sample_sphere({u1, rng.uniform()});
            const double u2 = rng.uniform();
            const Vec3 b = core::sample_sphere({u2, rng.uniform()});
            const double value = renderer::evaluate_bsdf(bsdf, a, b);
            EXPECT_NEAR(value, renderer::evaluate_bsdf(bsdf, b, a), 1e-9 * (1.0 + value));
            const bool may_reflect =
                a.z() * b.z() > 0.0 && !renderer::traits_of(bsdf).returns_to_source;
            EXPECT_EQ(value > 0.0, may_reflect) << bsdf_text(bsdf);
        }
    }
}

struct Pair {
    Vec3 in;
    Vec3 out;
};

std::vector<Pair> pairs_of_directions() {
    core::Rng rng(test_support::seed_of("SurfaceTraits"), 0, 0);
    std::vector<Pair> pairs;
    for (int i = 0; i < 200; ++i) {
        const auto draw = [&] {
            return direction_at(0.01 + 0.99 * rng.uniform(), 7.0 * rng.uniform());
        };
        const Vec3 in = draw();
        pairs.push_back({in, draw()});
    }
    return pairs;
}

TEST(SurfaceTraits, SayWhatTheFunctionsDo) {
    constexpr double kAlbedo = 0.6;
    const std::vector<Pair> pairs = pairs_of_directions();
    for (const Bsdf& bsdf : bsdfs_of_all_models({kAlbedo}, {0.3})) {
        SCOPED_TRACE(bsdf_text(bsdf));
        const renderer::SurfaceTraits& traits = renderer::traits_of(bsdf);
        const bool is_constant = std::ranges::all_of(pairs, [&](const Pair& pair) {
            return renderer::evaluate_bsdf(bsdf, pair.in, pair.out) == kAlbedo / core::kPi &&
                   renderer::pdf_bsdf(bsdf, pair.in, pair.out) == pair.out.z() / core::kPi;
        });
        EXPECT_EQ(traits.is_constant, is_constant);
        EXPECT_EQ(renderer::constant_value(bsdf).has_value(), is_constant);
        const bool is_distribution = std::ranges::none_of(pairs, [&](const Pair& pair) {
            return renderer::evaluate_bsdf(bsdf, pair.in, pair.out) > 0.0 ||
                   renderer::sample_bsdf(bsdf, pair.in, {0.3, 0.3});
        });
        EXPECT_EQ(traits.returns_to_source, is_distribution);
        if (traits.element && !traits.element->glossy) {
            EXPECT_EQ(is_constant, *traits.element == renderer::ElementResponse{});
            EXPECT_EQ(is_distribution, traits.element->towards_source);
        }
    }
}

TEST(SurfaceTraits, SayWhatReflectsWhenBlack) {
    const std::vector<Pair> pairs = pairs_of_directions();
    for (const Bsdf& bsdf : bsdfs_of_all_models({0.0}, {0.3})) {
        const bool reflects = std::ranges::any_of(pairs, [&](const Pair& pair) {
            return renderer::evaluate_bsdf(bsdf, pair.in, pair.out) > 0.0;
        });
        EXPECT_EQ(renderer::traits_of(bsdf).reflects_when_black, reflects) << bsdf_text(bsdf);
    }
}

// Half vectors of a GGX lobe are within 10 alpha of the normal but for 1 %; directions turn by
// twice that angle.
TEST(SurfaceTraits, SayHowManySamplesFollowTheLobe) {
    constexpr int kPoints = 4096;
    constexpr double kAlpha = 0.01;
    for (const Bsdf& bsdf : bsdfs_of_all_models({0.0, 0.6, 1.0}, {kAlpha})) {
        for (const double cosine : {0.1, 0.5, 1.0}) {
            const Vec3 incoming = direction_at(cosine, 0.7);
            const Vec3 mirrored(-incoming.x(), -incoming.y(), incoming.z());
            int following = 0;
            for (int i = 0; i < kPoints; ++i) {
                const auto out = renderer::sample_bsdf(
                    bsdf, incoming, core::lattice_point(i, kPoints, {0.4, 0.3}));
                following += out && (*out - mirrored).norm() < 20.0 * kAlpha ? 1 : 0;
            }
            const auto lobe = renderer::lobe_of(bsdf, cosine);
            EXPECT_EQ(lobe.has_value(), renderer::traits_of(bsdf).has_lobe);
            EXPECT_NEAR(static_cast<double>(following) / kPoints, lobe ? lobe->fraction : 0.0, 0.06)
                << bsdf_text(bsdf) << ", cosine " << cosine;
        }
    }
}

TEST(SurfaceTraits, TellModelsApart) {
    const auto& all = renderer::kSurfaceTraits;
    for (std::size_t i = 0; i < all.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_NE(all[i].name, all[j].name);
            EXPECT_TRUE(!all[i].gltf || all[i].gltf != all[j].gltf) << all[i].name;
        }
        if (all[i].gltf) {
            EXPECT_EQ(static_cast<std::size_t>(renderer::model_of(*all[i].gltf)), i);
        }
    }
    EXPECT_EQ(renderer::model_of({}), renderer::Material{}.model);
}

TEST(SurfaceTraits, GlossyElementsAreGgxInVectors) {
    core::Rng rng(test_support::seed_of("Bsdf.GgxInVectors"), 0, 0);
    // Widths and cosines down to a thousandth.
    const auto down_to_thousandth = [&] { return std::pow(10.0, -3.0 * rng.uniform()); };
    constexpr std::size_t kSize = core::Simd::size();
    using Lanes = std::array<double, kSize>;
    for (const auto& material : test_support::materials_of_all_models(1.0, 1.0)) {
        const auto& element = renderer::traits_of(material.model).element;
        if (!element || !element->glossy) continue;
        for (int round = 0; round < 1000; ++round) {
            alignas(64) Lanes albedo, alpha, cos2, sin2, cos_in, cos_out, cos_half, expected;
            for (std::size_t i = 0; i < kSize; ++i) {
                albedo[i] = rng.uniform();
                alpha[i] = down_to_thousandth();
                const Bsdf bsdf = renderer::make_bsdf(material.model, albedo[i], alpha[i]);
                const double in_cosine = down_to_thousandth();
                const Vec3 in = direction_at(in_cosine, 7.0 * rng.uniform());
                const double out_cosine = down_to_thousandth();
                const Vec3 out = direction_at(out_cosine, 7.0 * rng.uniform());
                const Vec3 half = (in + out).normalized();
                cos2[i] = half.z() * half.z();
                sin2[i] = half.head<2>().squaredNorm();
                cos_in[i] = in.z();
                cos_out[i] = out.z();
                cos_half[i] = half.dot(in);
                expected[i] = renderer::evaluate_bsdf(bsdf, in, out);
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
}

}  // namespace
