// SPDX-License-Identifier: MIT
#include "apps/bench/fit/fit.h"
#include "apps/bench/fit/fit_trials.h"
#include "renderer/core/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {
namespace {

using core::Vec3;

constexpr int kMaxFits = 10;

// A bump of 2 cm with a twist, in the rectangle's coordinates from -1 to 1.
double true_height(double x, double y) {
    return 0.02 * std::cos(1.4 * x) * std::cos(1.1 * y) + 0.008 * x * y;
}

std::vector<double> true_heights(int vertices) {
    std::vector<double> heights;
    for (int j = 0; j < vertices; ++j) {
        for (int i = 0; i < vertices; ++i) {
            heights.push_back(
                true_height(2.0 * i / (vertices - 1.0) - 1.0, 2.0 * j / (vertices - 1.0) - 1.0));
        }
    }
    return heights;
}

// The flat rectangle's mesh raised to the true heights along its normal.
renderer::Object raised(const renderer::Object& flat, const std::vector<double>& heights) {
    renderer::Object object = flat;
    const Vec3 normal = flat.world_from_node.linear().col(2);
    for (std::size_t v = 0; v < heights.size(); ++v) {
        object.mesh.vertices[v] += heights[v] * normal;
    }
    return object;
}

struct HeightErrors {
    std::vector<double> errors_m;  ///< all vertices of all fits
    std::vector<double> bounds_m;
    std::vector<double> corner_errors_m;
    std::vector<double> corner_bounds_m;
    double square_over_bound = 0.0;
};

HeightErrors fit_heights(int vertices, int fits) {
    TrialSetup setup;
    setup.photons = 1e6;
    const renderer::Object flat = trial_rectangle(standard_pose(), vertices - 1, vertices - 1);
    const std::vector<double> truth = true_heights(vertices);
    const core::Capture light = expected_light(raised(flat, truth));
    HeightErrors result;
    const auto n = static_cast<std::size_t>(vertices);
    for (int fit = 0; fit < fits; ++fit) {
        const core::Capture counts =
            counted_capture(setup, light, 0.0, static_cast<std::uint64_t>(fit));
        calib::FitInput input = trial_input(setup, counts, standard_pose());
        input.geometry.objects = {flat};
        input.settings.free.objects = {{"target", {"albedo", "vertices"}}};
        const calib::FittedObject object = calib::fit_scene(input, {}).objects.front();
        for (std::size_t v = 0; v < truth.size(); ++v) {
            const double error = std::abs(object.heights_m[v] - truth[v]);
            const double bound = object.heights_sigma_m[v];
            result.errors_m.push_back(error);
            result.bounds_m.push_back(bound);
            result.square_over_bound += error * error / (bound * bound);
            const bool is_corner = (v % n == 0 || v % n == n - 1) && (v < n || v + n >= n * n);
            if (!is_corner) continue;
            result.corner_errors_m.push_back(error);
            result.corner_bounds_m.push_back(bound);
        }
    }
    result.square_over_bound /= static_cast<double>(result.errors_m.size());
    return result;
}

}  // namespace

void bench_heights(int trials, FitBench& bench) {
    // The median of the size of a normally distributed error, over its standard deviation.
    constexpr double kMedianOverSigma = 0.6745;
    for (const int vertices : {5, 9}) {
        const HeightErrors found = fit_heights(vertices, std::clamp(trials / 3, 1, kMaxFits));
        const double over_bound = std::sqrt(found.square_over_bound);
        bench.rows.push_back(
            {fmt::format("heights of {0} x {0} vertices, 1e6 photons: median, corners, RMS over "
                         "bound",
                         vertices),
             fmt::format("bound {:.2f} mm, {:.2f} mm, <= 1.3",
                         core::median(found.bounds_m) / kMillimetre,
                         core::median(found.corner_bounds_m) / kMillimetre),
             fmt::format("{:.2f} mm, {:.2f} mm, {:.2f}",
                         core::median(found.errors_m) / kMedianOverSigma / kMillimetre,
                         core::median(found.corner_errors_m) / kMedianOverSigma / kMillimetre,
                         over_bound),
             over_bound <= 1.3});
    }
}

}  // namespace apps
