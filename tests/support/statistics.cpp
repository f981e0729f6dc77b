// SPDX-License-Identifier: MIT
#include "tests/support/statistics.h"

#include <cmath>
#include <numeric>

namespace test_support {
namespace {

// Regularised upper incomplete gamma function Q(a, x): series below a + 1, continued fraction above
// (source [Press2007], section 6.2).
double upper_gamma(double a, double x) {
    if (x <= 0.0) return 1.0;
    const double log_front = a * std::log(x) - x - std::lgamma(a);
    if (x < a + 1.0) {
        double term = 1.0 / a;
        double sum = term;
        for (double n = a + 1.0; term > sum * 1e-16; n += 1.0) sum += term *= x / n;
        return 1.0 - sum * std::exp(log_front);
    }
    constexpr double kTiny = 1e-300;
    double b = x + 1.0 - a;
    double c = 1.0 / kTiny;
    double d = 1.0 / b;
    double h = d;
    for (int i = 1; i < 10000; ++i) {
        const double an = -i * (i - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        const double step = d * c;
        h *= step;
        if (std::abs(step - 1.0) < 1e-15) break;
    }
    return h * std::exp(log_front);
}

}  // namespace

std::uint64_t seed_of(std::string_view test_name) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
    for (const char c : test_name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    return hash;
}

double chi_square_tail(double value, double degrees) {
    return upper_gamma(0.5 * degrees, 0.5 * value);
}

double normal_tail(double value) {
    return std::erfc(std::abs(value) / std::sqrt(2.0));
}

double sidak_level(double level, std::size_t num_tests) {
    return -std::expm1(std::log1p(-level) / static_cast<double>(num_tests));
}

double chi_square_p_value(std::span<const double> observed, std::span<const double> expected) {
    double statistic = 0.0;
    double pooled_observed = 0.0;
    double pooled_expected = 0.0;
    int cells = 0;
    const auto add = [&](double o, double e) {
        statistic += (o - e) * (o - e) / e;
        ++cells;
    };
    for (std::size_t i = 0; i < observed.size(); ++i) {
        if (expected[i] >= 5.0) {
            add(observed[i], expected[i]);
            continue;
        }
        pooled_observed += observed[i];
        pooled_expected += expected[i];
    }
    if (pooled_expected > 0.0) {
        add(pooled_observed, pooled_expected);
    } else if (pooled_observed > 0.0) {
        return 0.0;  // samples where the density is 0
    }
    return cells < 2 ? 1.0 : chi_square_tail(statistic, cells - 1);
}

double sum_of(std::span<const float> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double sum_of(std::span<const double> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double relative_l2(std::span<const float> a, std::span<const float> b) {
    const std::vector<double> doubles(a.begin(), a.end());
    return relative_l2(doubles, std::vector<double>(b.begin(), b.end()));
}

double relative_l2(std::span<const double> a, std::span<const double> b) {
    double difference = 0.0;
    double reference = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference += (a[i] - b[i]) * (a[i] - b[i]);
        reference += b[i] * b[i];
    }
    return std::sqrt(difference / reference);
}

}  // namespace test_support
