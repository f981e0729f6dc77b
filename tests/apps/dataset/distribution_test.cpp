// SPDX-License-Identifier: MIT
#include "apps/dataset/distribution.h"

#include "renderer/core/settings/settings_json.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace {

using apps::Distribution;

Distribution parse(const char* json) {
    Distribution distribution;
    read_value(core::Json::parse(json), "key", distribution);
    return distribution;
}

constexpr int kDraws = 20000;

/// Fraction of draws below `value`; its standard deviation is at most 0.5 / sqrt(kDraws) = 0.0035.
double fraction_below(const Distribution& distribution, double value) {
    int below = 0;
    for (int i = 0; i < kDraws; ++i) {
        core::Rng rng(7, static_cast<std::uint64_t>(i), 3);
        below += draw_number(distribution, rng) < value ? 1 : 0;
    }
    return static_cast<double>(below) / kDraws;
}
constexpr double kFiveSigma = 5.0 * 0.0036;

TEST(Distribution, UniformDrawsFollowTheirDistributionFunction) {
    const Distribution uniform = parse(R"({"uniform": [-1, 3]})");
    for (const double value : {-0.5, 0.0, 1.0, 2.5}) {
        EXPECT_NEAR(fraction_below(uniform, value), (value + 1.0) / 4.0, kFiveSigma) << value;
    }
    EXPECT_EQ(fraction_below(uniform, -1.0), 0.0);
    EXPECT_EQ(fraction_below(uniform, 3.0), 1.0);
}

TEST(Distribution, LogarithmsOfLogUniformDrawsAreUniform) {
    const Distribution distribution = parse(R"({"log_uniform": [0.01, 100]})");
    for (const double exponent : {-1.5, -1.0, 0.0, 1.3}) {
        EXPECT_NEAR(fraction_below(distribution, std::pow(10.0, exponent)),
                    (exponent + 2.0) / 4.0,
                    kFiveSigma);
    }
}

TEST(Distribution, NormalDrawsFollowTheErrorFunctionUpToTheCut) {
    const Distribution normal = parse(R"({"normal": [2, 0.5]})");
    const double inside = std::erf(3.0 / std::sqrt(2.0));
    for (const double sigmas : {-2.0, -1.0, 0.0, 0.5, 2.0}) {
        const double expected = 0.5 + 0.5 * std::erf(sigmas / std::sqrt(2.0)) / inside;
        EXPECT_NEAR(fraction_below(normal, 2.0 + 0.5 * sigmas), expected, kFiveSigma);
    }
    EXPECT_EQ(fraction_below(normal, 0.5), 0.0);
    EXPECT_EQ(fraction_below(normal, 3.5 + 1e-12), 1.0);
}

TEST(Distribution, IntegersAndChoicesAreEquallyLikely) {
    const Distribution integers = parse(R"({"integers": [2, 4]})");
    EXPECT_EQ(fraction_below(integers, 2.0), 0.0);
    EXPECT_NEAR(fraction_below(integers, 2.5), 1.0 / 3.0, kFiveSigma);
    EXPECT_NEAR(fraction_below(integers, 3.5), 2.0 / 3.0, kFiveSigma);
    EXPECT_EQ(fraction_below(integers, 4.5), 1.0);
    const Distribution choices = parse(R"({"choices": [[16, 16], "auto", null]})");
    std::multiset<std::string> drawn;
    for (int i = 0; i < kDraws; ++i) {
        core::Rng rng(7, static_cast<std::uint64_t>(i), 5);
        drawn.insert(draw(choices, rng).dump());
    }
    for (const char* text : {"[16,16]", "\"auto\"", "null"}) {
        EXPECT_NEAR(static_cast<double>(drawn.count(text)) / kDraws, 1.0 / 3.0, kFiveSigma);
    }
}

TEST(Distribution, EchoReadsBackAsTheSame) {
    for (const char* text : {R"({"uniform":[-1.0,3.0]})",
                             R"({"log_uniform":[0.01,100.0]})",
                             R"({"normal":[2.0,0.5]})",
                             R"({"integers":[2,4]})",
                             R"({"choices":[[16,16],"auto",null]})",
                             "0.5"}) {
        EXPECT_EQ(write_value(parse(text)).dump(), text);
    }
}

TEST(Distribution, ErrorsNameKeyAndWhatIsAllowed) {
    EXPECT_ERROR_WITH(parse(R"({"uniform": [3, 1]})"), "key.uniform: found [3,1]; must be two");
    EXPECT_ERROR_WITH(parse(R"({"log_uniform": [0, 1]})"), "key.log_uniform[0]: found 0");
    EXPECT_ERROR_WITH(parse(R"({"normal": [0, -1]})"), "key.normal[1]: found -1");
    EXPECT_ERROR_WITH(parse(R"({"integers": [1, 2.5]})"), "must be whole numbers");
    EXPECT_ERROR_WITH(parse(R"({"choices": []})"), "at least one value");
    EXPECT_ERROR_WITH(parse(R"({"gamma": [1, 2]})"), "log_uniform");
    EXPECT_ERROR_WITH(parse(R"({"uniform": [1, 2], "normal": [0, 1]})"), "log_uniform");
    EXPECT_ERROR_WITH(parse(R"({"uniform": [1]})"), "key.uniform");
    EXPECT_ERROR_WITH(check_range(parse(R"({"choices": [1, "x"]})"), core::Range{}, "key"),
                      "a number");
    EXPECT_ERROR_WITH(
        check_range(parse(R"({"normal": [0.5, 0.2]})"), core::between(0, 1, "").range, "key"),
        "key: found -0.1");
}

}  // namespace
