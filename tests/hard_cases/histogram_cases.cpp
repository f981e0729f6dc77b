// SPDX-License-Identifier: MIT
// The histogram of a triangle whose length and weight are linear.
#include "renderer/core/random.h"
#include "renderer/triangle/triangle_histogram.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/random_geometry.h"
#include "tests/support/single_triangle.h"
#include "tests/support/statistics.h"

#include <algorithm>
#include <array>
#include <vector>

namespace hard_cases {
namespace {

using core::TimeAxis;
using core::Vec3;
using renderer::TriangleKnots;
using truth::Quad;
using truth::QuadVec;

struct Corner {
    Quad u, v;  // barycentric
    Quad opl;
    Quad weight;
};

Corner between(const Corner& a, const Corner& b, Quad fraction) {
    const auto mix = [&](Quad x, Quad y) { return x + fraction * (y - x); };
    return {mix(a.u, b.u), mix(a.v, b.v), mix(a.opl, b.opl), mix(a.weight, b.weight)};
}

// Mean over the triangle of weight * [length < edge]: the polygon below the edge, as a fan of
// triangles whose mean weight is that of their corners.
Quad cumulative(const std::array<Quad, 3>& opl, const std::array<double, 3>& weight, Quad edge) {
    std::vector<Corner> polygon;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const auto corner = [&](std::size_t k) {
            return Corner{k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0, opl[k], weight[k]};
        };
        const Corner from = corner(i);
        const Corner to = corner(j);
        if (from.opl < edge) polygon.push_back(from);
        if ((from.opl < edge) != (to.opl < edge)) {
            polygon.push_back(between(from, to, (edge - from.opl) / (to.opl - from.opl)));
        }
    }
    Quad sum = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const Corner& a = polygon[0];
        const Corner& b = polygon[i];
        const Corner& c = polygon[i + 1];
        const Quad twice_area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
        sum += twice_area * (a.weight + b.weight + c.weight) / 3;
    }
    return sum;
}

// Nodes and weights of Gauss and Legendre's rule on [-1, 1].
std::vector<std::array<Quad, 2>> gauss_legendre() {
    constexpr int kCount = 20;
    std::vector<std::array<Quad, 2>> rule;
    for (int i = 0; i < kCount; ++i) {
        Quad x = std::cos(core::kPi * (i + 0.75) / (kCount + 0.5));
        Quad slope = 1;
        for (int iteration = 0; iteration < 10; ++iteration) {
            Quad before = 0;
            Quad p = 1;
            for (int n = 0; n < kCount; ++n) {
                const Quad next = ((2 * n + 1) * x * p - n * before) / (n + 1);
                before = p;
                p = next;
            }
            slope = kCount * (x * p - before) / (x * x - 1);
            x -= p / slope;
        }
        rule.push_back({x, 2 / ((1 - x * x) * slope * slope)});
    }
    return rule;
}

// The cumulative histogram behind a Gaussian response: that of the sharp triangle convolved, panel
// by panel between knots, in which it is a polynomial.
Quad smeared_cumulative(const std::array<Quad, 3>& opl,
                        const std::array<double, 3>& weight,
                        Quad sigma,
                        Quad edge) {
    static const auto kRule = gauss_legendre();
    std::vector<Quad> cuts;
    for (int panel = 0; panel <= 12; ++panel) cuts.push_back(2 * panel - 12);
    for (const Quad knot : opl) cuts.push_back((edge - knot) / sigma);
    std::sort(cuts.begin(), cuts.end());
    const Quad norm = 1 / truth::sqrtq(2 * truth::pi());
    Quad sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const Quad low = cuts[i] < -12 ? Quad(-12) : cuts[i];
        const Quad high = cuts[i + 1] > 12 ? Quad(12) : cuts[i + 1];
        if (!(high > low)) continue;
        for (const auto& [x, fraction] : kRule) {
            const Quad t = (low + high + (high - low) * x) / 2;
            sum += (high - low) / 2 * fraction * norm * truth::expq(-t * t / 2) *
                   cumulative(opl, weight, edge - sigma * t);
        }
    }
    return sum;
}

std::array<Quad, 3> lengths_of(const TriangleKnots& knots) {
    return {knots.opl_m[0], knots.opl_m[1], knots.opl_m[2]};
}

double mean_weight(const TriangleKnots& knots) {
    return (knots.weight[0] + knots.weight[1] + knots.weight[2]) / 3.0;
}

TriangleKnots random_knots(core::Rng& rng, double start, double spread) {
    TriangleKnots knots;
    for (double& opl : knots.opl_m) opl = start + spread * rng.uniform();
    for (double& weight : knots.weight) weight = rng.uniform();
    const double kind = rng.uniform();
    if (kind < 0.2) knots.opl_m[1] = knots.opl_m[0];
    if (kind > 0.8) knots.opl_m[2] = knots.opl_m[1] + 1e-9 * spread;
    if (kind > 0.5) knots.weight[0] = 0.0;
    return knots;
}

struct SmearedTriangle {
    TriangleKnots knots;
    double sigma;
    TimeAxis axis;

    Quad bin(const std::array<Quad, 3>& opl, int index) const {
        const auto below = [&](int k) {
            const Quad edge = Quad(axis.opl_start_m) + Quad(k) * Quad(axis.bin_width_m);
            return smeared_cumulative(opl, knots.weight, sigma, edge);
        };
        return below(index + 1) - below(index);
    }
};

// A triangle of 1e-12 to 100 widths of the response, on bins of 0.03 to 30 widths.
SmearedTriangle random_smeared_triangle(core::Rng& rng) {
    const double sigma = test_support::power_of_ten(rng, -6.0, 1.0);
    const double width = sigma * test_support::power_of_ten(rng, -1.5, 1.5);
    const double spread = sigma * test_support::power_of_ten(rng, -12.0, 2.0);
    const double start = 2.0 + width * 10.0 * rng.uniform();
    return {random_knots(rng, start, spread), sigma, {2.0, width, 40}};
}

// Worst error of the box kernel, relative to the whole weight, of triangles whose lengths start
// `start` bins from the axis' origin and spread over 10^from .. 10^to bins.
double box_kernel_error(std::string_view seed, double start, double from, double to) {
    core::Rng rng(test_support::seed_of(seed), 0, 0);
    Worst worst;
    for (int i = 0; i < 2000; ++i) {
        const double width = test_support::power_of_ten(rng, -6.0, 3.0);
        const double spread = test_support::power_of_ten(rng, from, to);
        const TimeAxis axis{width * start, width, 64};
        const TriangleKnots knots =
            random_knots(rng, axis.bin_begin_m(2.0 + rng.uniform()), width * spread);
        std::vector<double> histogram(64, 0.0);
        test_support::add_triangle(knots, 1.0, axis, histogram);
        const double whole = mean_weight(knots);
        for (int bin = 0; bin < 64; ++bin) {
            const auto edge = [&](int k) {
                return Quad(axis.opl_start_m) + Quad(k) * Quad(axis.bin_width_m);
            };
            const auto below = [&](int k) {
                return cumulative(lengths_of(knots), knots.weight, edge(k));
            };
            const Quad expected = below(bin + 1) - below(bin);
            worst.add(
                truth::relative_error(histogram[static_cast<std::size_t>(bin)], expected, whole));
        }
    }
    return worst.value();
}

}  // namespace

double box_kernel_of_small_and_large_triangles() {
    return std::max(box_kernel_error("box_kernel_small", 0.0, -12.0, -2.0),
                    box_kernel_error("box_kernel_large", 0.0, -2.0, 2.5));
}

double box_kernel_a_million_bins_out() {
    return box_kernel_error("box_kernel_a_million_bins_out", 1e6, -2.0, 1.5);
}

double smeared_kernel_at_all_widths() {
    core::Rng rng(test_support::seed_of("smeared_kernel_at_all_widths"), 0, 0);
    Worst worst;
    renderer::TriangleBins bins;
    for (int i = 0; i < 150; ++i) {
        const SmearedTriangle triangle = random_smeared_triangle(rng);
        const auto& [knots, sigma, axis] = triangle;
        renderer::evaluate_triangle(knots, sigma, axis, renderer::Gradients::Without, bins);
        for (int k = 0; k < static_cast<int>(bins.bins.size()); k += 4) {
            worst.add(truth::relative_error(bins.bins[static_cast<std::size_t>(k)].slots[0],
                                            triangle.bin(lengths_of(knots), bins.first_bin + k),
                                            mean_weight(knots)));
        }
    }
    return worst.value(100);
}

double gradients_of_the_smeared_kernel() {
    core::Rng rng(test_support::seed_of("gradients_of_the_smeared_kernel"), 0, 0);
    Worst worst;
    renderer::TriangleBins bins;
    for (int i = 0; i < 100; ++i) {
        const SmearedTriangle triangle = random_smeared_triangle(rng);
        const auto& [knots, sigma, axis] = triangle;
        renderer::evaluate_triangle(knots, sigma, axis, renderer::Gradients::With, bins);
        if (bins.bins.empty()) continue;  // behind the axis
        const auto k = static_cast<std::size_t>(rng.uniform() * double(bins.bins.size()));
        const int bin = bins.first_bin + static_cast<int>(k);
        for (std::size_t j = 0; j < 3; ++j) {
            // Central differences: 1e-6 widths cost 1e-12 of the gradient.
            const Quad step = Quad(1e-6) * Quad(sigma);
            std::array<Quad, 3> before = lengths_of(knots);
            std::array<Quad, 3> after = before;
            before[j] -= step;
            after[j] += step;
            const Quad gradient =
                (triangle.bin(after, bin) - triangle.bin(before, bin)) / (2 * step);
            worst.add(truth::relative_error(
                bins.bins[k].slots[1 + j], gradient, mean_weight(knots) / sigma));
        }
    }
    return worst.value(100);
}

}  // namespace hard_cases
