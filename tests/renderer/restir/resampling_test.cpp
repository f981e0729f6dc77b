// SPDX-License-Identifier: MIT
// Reservoirs and the MIS rules that merge them, on a line where every integral is known.
#include "renderer/restir/resampling.h"

#include "renderer/core/random.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace {

using Reservoir = renderer::Reservoir<double>;
using Builder = renderer::ReservoirBuilder<double>;
using Carry = std::optional<renderer::Carried<double>>;

// Domains on [0, 1]. Domain 0 is canonical. Each neighbour has its own target and a map to domain 0
// that is one-to-one but not defined everywhere, and stretches.
struct Domain {
    std::function<double(double)> target;
    double power;       ///< the map to domain 0 is x^power ...
    double defined_to;  ///< ... for x below this

    Carry to_canonical(double x, const Domain& canonical) const {
        if (x >= defined_to) return std::nullopt;
        const double image = std::pow(x, power);
        return renderer::Carried<double>{
            image, canonical.target(image), power * std::pow(x, power - 1.0)};
    }
    Carry from_canonical(double y) const {
        const double x = std::pow(y, 1.0 / power);
        if (x >= defined_to) return std::nullopt;
        return renderer::Carried<double>{x, target(x), std::pow(y, 1.0 / power - 1.0) / power};
    }
};

// Integral 0.75 by parts: 2 x on [0, 1/2) is 0.25, 1 on [1/2, 1) is 0.5.
double canonical_target(double x) {
    return x < 0.5 ? 2.0 * x : 1.0;
}
constexpr double kIntegral = 0.75;

const std::vector<Domain> kDomains{{canonical_target, 1.0, 1.0},
                                   {[](double x) { return x * x; }, 1.5, 0.9},
                                   {[](double x) { return x > 0.3 ? 1.0 - x : 0.0; }, 0.7, 1.0},
                                   {[](double x) { return 3.0 * std::exp(-5.0 * x); }, 2.0, 0.6}};

Reservoir candidates(const Domain& domain, int count, double confidence, core::Rng& rng) {
    Builder builder;
    for (int i = 0; i < count; ++i) {
        const double x = rng.uniform();
        const double target = domain.target(x);
        builder.add(x, target, target / count, rng.uniform());
    }
    return builder.finish(confidence);
}

// Mean estimates of several functions over many merges, each tested against its integral.
using Merge = std::function<Reservoir(core::Rng&)>;

void expect_unbiased(const Merge& merge, const char* name) {
    constexpr int kRuns = 400'000;
    const std::array<std::function<double(double)>, 3> functions{
        canonical_target, [](double) { return 1.0; }, [](double x) { return x < 0.2 ? x : 0.0; }};
    const std::array<double, 3> integrals{kIntegral, 1.0, 0.02};
    std::array<double, 3> sums{};
    std::array<double, 3> squares{};
    core::Rng rng(test_support::seed_of(name), 0, 0);
    for (int i = 0; i < kRuns; ++i) {
        const Reservoir result = merge(rng);
        if (result.empty()) continue;
        for (std::size_t f = 0; f < functions.size(); ++f) {
            const double estimate = functions[f](result.sample) * result.contribution_weight;
            sums[f] += estimate;
            squares[f] += estimate * estimate;
        }
    }
    for (std::size_t f = 0; f < functions.size(); ++f) {
        const double mean = sums[f] / kRuns;
        const double sigma = std::sqrt((squares[f] / kRuns - mean * mean) / kRuns);
        EXPECT_GT(test_support::normal_tail((mean - integrals[f]) / sigma),
                  test_support::sidak_level(1e-3, functions.size()))
            << name << " function " << f << ": " << mean << " +- " << sigma;
        EXPECT_LT(sigma, 0.01 * integrals[f]);
    }
}

Carry here_of(const Domain& domain, const Reservoir& reservoir) {
    return reservoir.empty() ? Carry{} : domain.to_canonical(reservoir.sample, kDomains[0]);
}

Carry there_of(const Domain& domain, const Reservoir& canonical) {
    return canonical.empty() ? Carry{} : domain.from_canonical(canonical.sample);
}

Reservoir merge_pairwise(core::Rng& rng) {
    const Reservoir canonical = candidates(kDomains[0], 2, 2.0, rng);
    renderer::PairwiseMisMerge<double> merge(canonical, 3);
    for (int i = 1; i <= 3; ++i) {
        const Domain& domain = kDomains[static_cast<std::size_t>(i)];
        const Reservoir neighbour = candidates(domain, i, 1.5 * i, rng);
        merge.add_neighbour(
            neighbour, here_of(domain, neighbour), there_of(domain, canonical), rng.uniform());
    }
    return merge.finish(rng.uniform());
}

TEST(Resampling, StreamOfCandidatesIsUnbiased) {
    expect_unbiased([](core::Rng& rng) { return candidates(kDomains[0], 4, 1.0, rng); },
                    "Resampling.Stream");
}

TEST(Resampling, BalancedMergeIsUnbiasedWithEachNeighbour) {
    for (std::size_t i = 1; i < kDomains.size(); ++i) {
        expect_unbiased(
            [i](core::Rng& rng) {
                const Reservoir canonical = candidates(kDomains[0], 2, 2.0, rng);
                const Reservoir other = candidates(kDomains[i], 3, 7.0, rng);
                return renderer::resample_balance_heuristic(canonical,
                                                            other,
                                                            here_of(kDomains[i], other),
                                                            there_of(kDomains[i], canonical),
                                                            rng.uniform(),
                                                            rng.uniform());
            },
            "Resampling.Balanced");
    }
}

TEST(Resampling, PairwiseMergeIsUnbiased) {
    expect_unbiased(merge_pairwise, "Resampling.Pairwise");
}

TEST(Resampling, MergesOfMergesAreUnbiased) {
    expect_unbiased(
        [](core::Rng& rng) {
            const Reservoir canonical = merge_pairwise(rng);
            const Reservoir other = candidates(kDomains[1], 3, 5.0, rng);
            return renderer::resample_balance_heuristic(canonical,
                                                        other,
                                                        here_of(kDomains[1], other),
                                                        there_of(kDomains[1], canonical),
                                                        rng.uniform(),
                                                        rng.uniform());
        },
        "Resampling.MergesOfMerges");
}

TEST(Resampling, LeavingOutTheJacobianOrFailedNeighboursIsSeenAsBias) {
    // The tests above would notice the two usual mistakes: this one makes them.
    const auto mean_of = [](bool forget_jacobian, bool skip_failures) {
        constexpr int kRuns = 200'000;
        core::Rng rng(test_support::seed_of("Resampling.Mistakes"), 0, 0);
        double sum = 0.0;
        for (int i = 0; i < kRuns; ++i) {
            const Reservoir canonical = candidates(kDomains[0], 2, 2.0, rng);
            const Reservoir neighbour = candidates(kDomains[1], 2, 8.0, rng);
            Carry here = here_of(kDomains[1], neighbour);
            Carry there = there_of(kDomains[1], canonical);
            if (forget_jacobian && there) there->jacobian = 1.0;
            const bool skip = skip_failures && !here;
            renderer::PairwiseMisMerge<double> merge(canonical, skip ? 0 : 1);
            if (!skip) merge.add_neighbour(neighbour, here, there, rng.uniform());
            sum += merge.finish(rng.uniform()).estimate();
        }
        return sum / kRuns;
    };
    EXPECT_NEAR(mean_of(false, false), kIntegral, 0.004);
    EXPECT_GT(std::abs(mean_of(true, false) - kIntegral), 0.006);
    EXPECT_GT(std::abs(mean_of(false, true) - kIntegral), 0.006);
}

TEST(Reservoir, SelectionFollowsTheWeights) {
    constexpr int kRuns = 100'000;
    const std::array<double, 4> weights{1.0, 0.0, 3.0, 6.0};
    std::vector<double> observed(4);
    std::vector<double> expected(4);
    core::Rng rng(test_support::seed_of("Reservoir.Selection"), 0, 0);
    for (int run = 0; run < kRuns; ++run) {
        Builder builder;
        for (std::size_t i = 0; i < weights.size(); ++i) {
            builder.add(static_cast<double>(i), 1.0, weights[i], rng.uniform());
        }
        const Reservoir result = builder.finish(1.0);
        EXPECT_DOUBLE_EQ(result.contribution_weight, 10.0);
        observed[static_cast<std::size_t>(result.sample)] += 1.0;
    }
    for (std::size_t i = 0; i < 4; ++i) expected[i] = kRuns * weights[i] / 10.0;
    EXPECT_EQ(observed[1], 0.0);
    EXPECT_GT(test_support::chi_square_p_value(observed, expected), 1e-4);
}

TEST(Reservoir, MergingPartsOfAStreamChoosesLikeTheWholeStream) {
    // Same domain, same candidates: by confidence, the merge of two halves has the whole's
    // estimate.
    core::Rng rng(test_support::seed_of("Reservoir.Merging"), 0, 0);
    for (int run = 0; run < 1000; ++run) {
        const Reservoir a = candidates(kDomains[0], 3, 3.0, rng);
        const Reservoir b = candidates(kDomains[0], 5, 5.0, rng);
        const auto identity = [](const Reservoir& r) {
            return r.empty() ? Carry{}
                             : Carry{renderer::Carried<double>{r.sample, r.target_value, 1.0}};
        };
        const Reservoir merged = renderer::resample_balance_heuristic(
            a, b, identity(b), identity(a), rng.uniform(), rng.uniform());
        EXPECT_NEAR(merged.estimate(), (3.0 * a.estimate() + 5.0 * b.estimate()) / 8.0, 1e-12);
        EXPECT_DOUBLE_EQ(merged.confidence, 8.0);
    }
}

TEST(Reservoir, NoCandidateLeavesItEmpty) {
    Builder builder;
    builder.add(0.5, 1.0, 0.0, 0.1);
    EXPECT_TRUE(builder.empty());
    const Reservoir result = builder.finish(3.0);
    EXPECT_TRUE(result.empty());
    EXPECT_EQ(result.estimate(), 0.0);
    EXPECT_DOUBLE_EQ(result.confidence, 3.0);
}

}  // namespace
