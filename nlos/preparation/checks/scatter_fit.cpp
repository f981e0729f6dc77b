// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/scatter_fit.h"

#include "nlos/preparation/checks/scatter_cells.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

using core::Vec3;

constexpr int kUpdates = 12;  // of the light, each by a subset of pairs
constexpr std::size_t kMostSubsets = 6;
constexpr std::size_t kSmallestSubset = 25;
constexpr double kModelError = 0.1;  // of a value: cells are coarse, angles and shadows left out
constexpr double kNearest = 0.02;    // of the farthest range; nearer cells see one point alone
constexpr double kStray = 1e-3;      // of the mean value, everywhere: no bin is impossible
constexpr float kFaintest = 1e-6F;   // reach of a cell, of the best one's

/// A sample with what a fit needs of it at every step.
class FitData {
 public:
    explicit FitData(const HistogramSample& sample)
        : sample_(sample),
          stray_(kStray * std::accumulate(sample.values.begin(), sample.values.end(), 0.0) /
                 static_cast<double>(std::max<std::size_t>(1, sample.values.size()))) {}

    /// Gains that scale each histogram of `model` to the light of the sample's.
    std::vector<double> gains(const std::vector<float>& model) const {
        std::vector<double> gains(sample_.pairs.size(), 0.0);
        for (std::size_t pair = 0; pair < gains.size(); ++pair) {
            double seen = 0.0;
            double modelled = 0.0;
            for (std::size_t i = pair * sample_.num_bins; i < (pair + 1) * sample_.num_bins; ++i) {
                seen += static_cast<double>(sample_.observed[i] *
                                            (sample_.values[i] - sample_.ambient[pair]));
                modelled += static_cast<double>(model[i]);
            }
            if (modelled > 0.0) gains[pair] = std::max(0.0, seen) / modelled;
        }
        return gains;
    }

    /// Data over model, bin by bin; 0 where nothing was observed.
    std::vector<float> ratios(const std::vector<float>& model,
                              const std::vector<double>& gains) const {
        std::vector<float> ratio(model.size());
        for (std::size_t i = 0; i < model.size(); ++i) {
            ratio[i] = sample_.observed[i] * std::max(0.0F, sample_.values[i]) /
                       static_cast<float>(expected(model, gains, i));
        }
        return ratio;
    }

    /// Squared differences in units of the model's variance, without those of mere noise.
    double misfit(const std::vector<float>& model) const {
        const std::vector<double> gain = gains(model);
        double sum = 0.0;
        for (std::size_t i = 0; i < sample_.values.size(); ++i) {
            if (sample_.observed[i] == 0.0F) continue;
            const double mean = expected(model, gain, i);
            const double difference = static_cast<double>(sample_.values[i]) - mean;
            const double larger = std::max(mean, static_cast<double>(sample_.values[i]));
            const double variance = mean + 1.0 + std::pow(kModelError * larger, 2);
            sum += difference * difference / variance;
            if (sample_.has_poisson_noise) sum -= mean / variance;
        }
        return sum;
    }

    /// The misfit of the mean histogram, the model without a geometry.
    double misfit_of_mean() const {
        std::vector<float> model(sample_.values.size(), 0.0F);
        for (std::size_t bin = 0; bin < sample_.num_bins; ++bin) {
            float sum = 0.0F;
            float count = 0.0F;
            for (std::size_t pair = 0; pair < sample_.pairs.size(); ++pair) {
                const std::size_t i = pair * sample_.num_bins + bin;
                sum += sample_.observed[i] * (sample_.values[i] - sample_.ambient[pair]);
                count += sample_.observed[i];
            }
            if (!(sum > 0.0F)) continue;
            for (std::size_t i = bin; i < model.size(); i += sample_.num_bins) {
                model[i] = sample_.observed[i] * sum / count;
            }
        }
        return misfit(model);
    }

 private:
    double expected(const std::vector<float>& model,
                    const std::vector<double>& gains,
                    std::size_t i) const {
        const std::size_t pair = i / sample_.num_bins;
        return std::max(1e-30,
                        gains[pair] * static_cast<double>(model[i]) +
                            static_cast<double>(sample_.ambient[pair]) + stray_);
    }

    const HistogramSample& sample_;
    double stray_;
};

/// The ranges between which the sample's light lies, device segments taken off.
std::array<double, 2> range_limits(const HistogramSample& sample, const PathGeometry& geometry) {
    double segments_m = 0.0;
    Vec3 apart = Vec3::Zero();
    for (std::size_t i = 0; i < sample.pairs.size(); ++i) {
        const double fraction = 1.0 / static_cast<double>(sample.pairs.size());
        segments_m += fraction * geometry.segments_m[i];
        apart += fraction * (geometry.illumination[i] - geometry.sensing[i]);
    }
    const double end_m =
        geometry.opl_start_m + geometry.bin_width_m * static_cast<double>(sample.num_bins);
    const double low = 0.5 * (std::min(geometry.opl_start_m, end_m) - segments_m - apart.norm());
    const double high = 0.5 * (std::max(geometry.opl_start_m, end_m) - segments_m + apart.norm());
    return {std::max(low, kNearest * high), high};
}

/// Light for cells that have none yet: each sends as much to the sample, but for those that it
/// hardly sees.
std::vector<double> even_light(const std::vector<float>& reach) {
    const float least = kFaintest * *std::ranges::max_element(reach);
    std::vector<double> light;
    for (const float value : reach) {
        light.push_back(value > least ? 1.0 / static_cast<double>(value) : 0.0);
    }
    return light;
}

/// Improves the light of cells by what a subset of pairs saw.
void improve(const FitData& data,
             const ScatterTransport& transport,
             const PairSubset& subset,
             std::vector<double>& light) {
    const std::vector<float> model = transport.forward(light, subset);
    const std::vector<double> gains = data.gains(model);
    const CellReach reach = transport.backward(data.ratios(model, gains), gains, subset);
    for (std::size_t c = 0; c < light.size(); ++c) {
        light[c] *=
            reach.plain[c] > 0.0F ? static_cast<double>(reach.rated[c] / reach.plain[c]) : 1.0;
    }
}

/// Fits the light of cells to a sample, in ordered subsets [Hudson1994].
void fit_light(const HistogramSample& sample,
               const FitData& data,
               const ScatterTransport& transport,
               ScatterCells& cells) {
    cells.reach = transport.reach();
    if (cells.light.empty()) cells.light = even_light(cells.reach);
    const std::size_t subsets =
        std::clamp<std::size_t>(sample.pairs.size() / kSmallestSubset, 1, kMostSubsets);
    for (std::size_t i = 0; i < kUpdates; ++i) {
        improve(data, transport, {i % subsets, subsets}, cells.light);
    }
}

}  // namespace

bool has_structure(const HistogramSample& sample) {
    constexpr double kSignificance = 10.0;
    const double noise = std::sqrt(2.0 * static_cast<double>(sample.values.size()));
    return FitData(sample).misfit_of_mean() > kSignificance * noise;
}

ScatterFit::ScatterFit(const HistogramSample& sample, PathGeometry geometry, int refinements)
    : sample_(&sample), geometry_(std::move(geometry)) {
    const auto [low_m, high_m] = range_limits(sample, geometry_);
    if (high_m > low_m) cells_ = coarse_cells(low_m, high_m);
    for (int i = 0; i < refinements; ++i) {
        fit(false);
        cells_ = refined_cells(cells_);
    }
    fit(true);
}

void ScatterFit::refine() {
    cells_ = refined_cells(cells_);
    fit(true);
}

void ScatterFit::fit(bool is_last) {
    unexplained_ = 1.0;
    if (cells_.centers.empty()) return;
    const FitData data(*sample_);
    const ScatterTransport transport(*sample_, geometry_, cells_);
    fit_light(*sample_, data, transport, cells_);
    if (!is_last) return;
    const double fraction =
        data.misfit(transport.forward(cells_.light, {})) / std::max(data.misfit_of_mean(), 1e-30);
    if (std::isfinite(fraction)) unexplained_ = std::max(0.0, fraction);
}

double unexplained_fraction(const HistogramSample& sample, const PathGeometry& geometry) {
    return ScatterFit(sample, geometry, ScatterFit::kRefinements).unexplained();
}

}  // namespace nlos
