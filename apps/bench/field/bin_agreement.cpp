// SPDX-License-Identifier: MIT
#include "apps/bench/field/bin_agreement.h"

#include "apps/bench/statistics.h"
#include "renderer/core/settings/json_file.h"

#include <cmath>
#include <numeric>

namespace apps {
namespace {

constexpr double kAgreementLevel = 0.01;  // that chance alone calls a table inconsistent
// Scores of cells that are only nearly normal are a little wide.
constexpr double kWideScores = 0.05;

double normal_score(double difference, double standard_error, std::size_t num_values) {
    if (difference == 0.0) return 0.0;
    const double freedom = static_cast<double>(num_values) - 1.0;
    const double t = difference / standard_error;
    const double scale = std::isinf(t) ? 0.0 : std::sqrt(1.0 + t * t / (2.0 * freedom));
    return scale > 0.0 ? t * (1.0 - 0.25 / freedom) / scale : t;
}

// Histograms of a block of wall points, added up.
std::vector<double> light_of_block(const core::Transient& transient,
                                   std::array<std::size_t, 2> grid,
                                   std::array<std::size_t, 2> first,
                                   std::size_t block) {
    std::vector<double> light(transient.num_bins());
    const auto values = transient.values();
    for (std::size_t x = first[0]; x < first[0] + block; ++x) {
        for (std::size_t y = first[1]; y < first[1] + block; ++y) {
            const std::size_t begin = (x * grid[1] + y) * light.size();
            for (std::size_t b = 0; b < light.size(); ++b) light[b] += double{values[begin + b]};
        }
    }
    return light;
}

// Ends of cells: each has at least `least` of the light, and the last takes what is left.
std::vector<std::size_t> cell_ends(const std::vector<double>& light, double least) {
    std::vector<std::size_t> ends;
    double sum = 0.0;
    for (std::size_t b = 0; b < light.size(); ++b) {
        sum += light[b];
        if (sum < least) continue;
        ends.push_back(b + 1);
        sum = 0.0;
    }
    if (ends.empty()) ends.push_back(light.size());
    ends.back() = light.size();
    return ends;
}

double sum_of(const std::vector<double>& light, std::size_t begin, std::size_t end) {
    return std::accumulate(light.begin() + static_cast<std::ptrdiff_t>(begin),
                           light.begin() + static_cast<std::ptrdiff_t>(end),
                           0.0);
}

double energy_of(const core::Transient& transient) {
    const auto values = transient.values();
    return std::accumulate(values.begin(), values.end(), 0.0);
}

}  // namespace

BinAgreement bin_agreement_of(const core::Transient& truth,
                              const std::vector<core::Transient>& runs,
                              std::array<std::size_t, 2> grid,
                              std::size_t block,
                              double least_fraction,
                              double systematic) {
    BinAgreement result;
    std::vector<double> of_runs;
    const double true_energy = energy_of(truth);
    for (const core::Transient& run : runs) of_runs.push_back(energy_of(run) / true_energy);
    const Estimate energy = estimate_of(of_runs);
    result.energy_ratio = energy.mean;
    result.energy_z =
        normal_score(energy.mean - 1.0, std::hypot(energy.standard_error, systematic), runs.size());

    double squares = 0.0;
    for (std::size_t x = 0; x + block <= grid[0]; x += block) {
        for (std::size_t y = 0; y + block <= grid[1]; y += block) {
            const std::vector<double> expected = light_of_block(truth, grid, {x, y}, block);
            std::vector<std::vector<double>> found;
            for (const core::Transient& run : runs) {
                found.push_back(light_of_block(run, grid, {x, y}, block));
            }
            const double all = sum_of(expected, 0, expected.size());
            std::size_t begin = 0;
            for (const std::size_t end : cell_ends(expected, least_fraction * all)) {
                for (std::size_t r = 0; r < runs.size(); ++r) {
                    of_runs[r] = sum_of(found[r], begin, end);
                }
                const Estimate cell = estimate_of(of_runs);
                const double difference = cell.mean - sum_of(expected, begin, end);
                begin = end;
                if (difference == 0.0) continue;
                const double z = normal_score(difference, cell.standard_error, runs.size());
                ++result.num_cells;
                squares += z * z;
                if (std::abs(z) > std::abs(result.worst_z)) result.worst_z = z;
            }
        }
    }
    result.rms_z = result.num_cells > 0 ? std::sqrt(squares / result.num_cells) : 0.0;
    return result;
}

double largest_score_by_chance(int num_scores, double level) {
    // The tail probability of one score at which the largest of all exceeds it with `level`.
    const double tail = -std::expm1(std::log1p(-level) / num_scores);
    double low = 0.0;
    double high = 40.0;
    for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (low + high);
        (std::erfc(middle / std::sqrt(2.0)) > tail ? low : high) = middle;
    }
    return low;
}

void judge_agreement(std::vector<core::Json>& rows) {
    int num_scores = 0;
    for (const core::Json& row : rows) {
        if (!row["worst_z"].is_null()) num_scores += row["cells"].get<int>() + 1;
    }
    if (num_scores == 0) return;
    const double most = largest_score_by_chance(num_scores, kAgreementLevel);
    for (core::Json& row : rows) {
        if (row["worst_z"].is_null()) continue;
        const auto size = [&](const char* score) { return std::abs(row[score].get<double>()); };
        const double widest = 1.0 + kWideScores + 4.0 / std::sqrt(2.0 * row["cells"].get<int>());
        row["worst_by_chance"] = most;
        row["consistent"] =
            size("worst_z") <= most && size("energy_z") <= most && size("rms_z") <= widest;
    }
}

}  // namespace apps
