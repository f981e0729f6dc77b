// SPDX-License-Identifier: MIT
#include "nlos/preparation/scatter_fit.h"

#include "renderer/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

using core::Vec3;

constexpr std::size_t kRanges = 16;      // cells to begin with
constexpr std::size_t kDirections = 16;  // per side of the square around the hemisphere
constexpr std::size_t kKeptCells = 600;  // that are halved along each coordinate
constexpr int kStages = 3;
constexpr int kIterations = 6;       // of expectation maximisation per stage
constexpr double kNearest = 0.02;    // of the farthest range; nearer cells see one point alone
constexpr double kStray = 1e-3;      // of the mean value, everywhere: no bin is impossible
constexpr std::size_t kBlock = 256;  // cells at once

/// A cell before the wall: range and the first two components of its direction.
using Cell = Eigen::Vector3d;

struct Cells {
    std::vector<Cell> centers;
    Cell size = Cell::Zero();
    std::vector<double> light;  ///< of each
    std::vector<float> reach;   ///< what each sends to the sample for unit light
};

Vec3 position_of(const Cell& cell, const core::Transform& world_from_wall) {
    const double z = std::sqrt(std::max(1e-4, 1.0 - cell.y() * cell.y() - cell.z() * cell.z()));
    return world_from_wall * Vec3(cell.x() * cell.y(), cell.x() * cell.z(), cell.x() * z);
}

bool is_before_the_wall(const Cell& cell) {
    return cell.y() * cell.y() + cell.z() * cell.z() < 1.0;
}

/// Cells of all directions within two ranges.
Cells coarse_cells(double low_m, double high_m) {
    Cells cells;
    cells.size = {(high_m - low_m) / kRanges, 2.0 / kDirections, 2.0 / kDirections};
    for (std::size_t r = 0; r < kRanges; ++r) {
        for (std::size_t i = 0; i < kDirections * kDirections; ++i) {
            const Cell index(static_cast<double>(r) + 0.5,
                             static_cast<double>(i / kDirections) + 0.5,
                             static_cast<double>(i % kDirections) + 0.5);
            const Cell center = Cell(low_m, -1.0, -1.0) + index.cwiseProduct(cells.size);
            if (is_before_the_wall(center)) cells.centers.push_back(center);
        }
    }
    return cells;
}

/// The eighths of the cells that send most light to the sample.
Cells halved_cells(const Cells& cells) {
    std::vector<std::size_t> order(cells.centers.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto is_heavier = [&](std::size_t a, std::size_t b) {
        const double difference = cells.light[a] * static_cast<double>(cells.reach[a]) -
                                  cells.light[b] * static_cast<double>(cells.reach[b]);
        return difference > 0.0 || (difference == 0.0 && a < b);
    };
    const std::size_t kept = std::min(kKeptCells, order.size());
    std::partial_sort(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(), is_heavier);
    Cells halves;
    halves.size = 0.5 * cells.size;
    for (std::size_t i = 0; i < kept; ++i) {
        for (int corner = 0; corner < 8; ++corner) {
            const Cell side(
                corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
            const Cell center = cells.centers[order[i]] + side.cwiseProduct(halves.size);
            if (!is_before_the_wall(center)) continue;
            halves.centers.push_back(center);
            halves.light.push_back(cells.light[order[i]]);
        }
    }
    return halves;
}

/// Sums over all bins that cells reach.
struct Reach {
    std::vector<float> plain;
    std::vector<float> rated;
};

/// How light of cells reaches the bins of a sample: a weight and a position between two bins for
/// each pair and cell.
class Transport {
 public:
    Transport(const HistogramSample& sample, const PathGeometry& geometry, const Cells& cells)
        : num_pairs_(sample.pairs.size()),
          num_bins_(sample.num_bins),
          num_cells_(cells.centers.size()),
          position_(num_pairs_ * num_cells_),
          weight_(num_pairs_ * num_cells_) {
        std::vector<Vec3> at;
        for (const Cell& cell : cells.centers) {
            at.push_back(position_of(cell, geometry.world_from_wall));
        }
        core::parallel_for(num_pairs_, [&](std::size_t pair) { fill(pair, geometry, at); });
    }

    /// Histograms of the cells' light, [pair][bin].
    std::vector<float> forward(const std::vector<double>& light) const {
        std::vector<float> model(num_pairs_ * num_bins_);
        core::parallel_for(num_pairs_, [&](std::size_t pair) {
            std::vector<double> row(num_bins_, 0.0);
            for (std::size_t cell = 0; cell < num_cells_; ++cell) {
                const std::size_t i = pair * num_cells_ + cell;
                const auto bin = static_cast<std::size_t>(position_[i]);
                const double value = light[cell] * static_cast<double>(weight_[i]);
                const double late = static_cast<double>(position_[i]) - static_cast<double>(bin);
                row[bin] += (1.0 - late) * value;
                row[bin + 1] += late * value;
            }
            std::copy(row.begin(),
                      row.end(),
                      model.begin() + static_cast<std::ptrdiff_t>(pair * num_bins_));
        });
        return model;
    }

    /// What each cell sends to the sample's bins for unit light, each pair times its gain, and the
    /// same with every bin times `ratio` [pair][bin].
    Reach backward(const std::vector<float>& ratio, const std::vector<double>& gain) const {
        Reach reach{std::vector<float>(num_cells_), std::vector<float>(num_cells_)};
        core::parallel_blocks(num_cells_, kBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pair = 0; pair < num_pairs_; ++pair) {
                const float* row = ratio.data() + pair * num_bins_;
                const auto pair_gain = static_cast<float>(gain[pair]);
                for (std::size_t cell = begin; cell < end; ++cell) {
                    const std::size_t i = pair * num_cells_ + cell;
                    const auto bin = static_cast<int>(position_[i]);
                    const float late = position_[i] - static_cast<float>(bin);
                    const float weight = pair_gain * weight_[i];
                    reach.plain[cell] += weight;
                    reach.rated[cell] += weight * (row[bin] + late * (row[bin + 1] - row[bin]));
                }
            }
        });
        return reach;
    }

 private:
    void fill(std::size_t pair, const PathGeometry& geometry, const std::vector<Vec3>& at) {
        const Vec3 normal = geometry.world_from_wall.linear().col(2);
        for (std::size_t cell = 0; cell < num_cells_; ++cell) {
            const Vec3 out = at[cell] - geometry.illumination[pair];
            const Vec3 back = at[cell] - geometry.sensing[pair];
            const double out_m = out.norm();
            const double back_m = back.norm();
            const double opl = out_m + back_m + geometry.legs_m[pair] - geometry.opl_start_m;
            const double bin = opl / geometry.bin_width_m - 0.5;
            const std::size_t i = pair * num_cells_ + cell;
            if (!(bin >= 0.0) || !(bin < static_cast<double>(num_bins_ - 1))) continue;
            position_[i] = static_cast<float>(bin);
            // The float may round up to the last bin, from which there is no next one.
            if (position_[i] >= static_cast<float>(num_bins_ - 1)) continue;
            const double cosines = std::abs(out.dot(normal) * back.dot(normal)) / (out_m * back_m);
            weight_[i] = static_cast<float>(cosines / std::pow(out_m * back_m, 2));
        }
    }

    std::size_t num_pairs_;
    std::size_t num_bins_;
    std::size_t num_cells_;
    std::vector<float> position_;  ///< [pair][cell], in bins
    std::vector<float> weight_;    ///< [pair][cell]; 0 outside the sample's bins
};

/// Scales each histogram of `model` to the light of the sample's; returns the gains.
std::vector<double> fit_gains(const HistogramSample& sample, const std::vector<float>& model) {
    std::vector<double> gains(sample.pairs.size(), 0.0);
    for (std::size_t pair = 0; pair < gains.size(); ++pair) {
        double seen = 0.0;
        double modelled = 0.0;
        for (std::size_t bin = 0; bin < sample.num_bins; ++bin) {
            seen += static_cast<double>(sample.histogram(pair)[bin] - sample.ambient[pair]);
            modelled += static_cast<double>(model[pair * sample.num_bins + bin]);
        }
        if (modelled > 0.0) gains[pair] = std::max(0.0, seen) / modelled;
    }
    return gains;
}

double mean_value(const HistogramSample& sample) {
    return std::accumulate(sample.values.begin(), sample.values.end(), 0.0) /
           static_cast<double>(std::max<std::size_t>(1, sample.values.size()));
}

/// Squared differences in units of the model's Poisson variance, without those of mere noise.
double misfit(const HistogramSample& sample,
              const std::vector<float>& model,
              const std::vector<double>& gains) {
    const double stray = kStray * mean_value(sample);
    double sum = 0.0;
    for (std::size_t i = 0; i < sample.values.size(); ++i) {
        const std::size_t pair = i / sample.num_bins;
        const double expected = gains[pair] * static_cast<double>(model[i]) +
                                static_cast<double>(sample.ambient[pair]) + stray;
        const double difference = static_cast<double>(sample.values[i]) - expected;
        sum += difference * difference / (expected + 1.0);
        if (sample.has_poisson_noise) sum -= expected / (expected + 1.0);
    }
    return sum;
}

/// The mean histogram, the model without a geometry.
std::vector<float> mean_histograms(const HistogramSample& sample) {
    std::vector<float> model(sample.values.size(), 0.0F);
    for (std::size_t bin = 0; bin < sample.num_bins; ++bin) {
        float sum = 0.0F;
        for (std::size_t pair = 0; pair < sample.pairs.size(); ++pair) {
            sum += sample.histogram(pair)[bin] - sample.ambient[pair];
        }
        for (std::size_t pair = 0; pair < sample.pairs.size(); ++pair) {
            model[pair * sample.num_bins + bin] = std::max(0.0F, sum);
        }
    }
    return model;
}

double misfit_without_geometry(const HistogramSample& sample) {
    const std::vector<float> model = mean_histograms(sample);
    return misfit(sample, model, fit_gains(sample, model));
}

/// Data over model, bin by bin.
std::vector<float> ratios(const HistogramSample& sample,
                          const std::vector<float>& model,
                          const std::vector<double>& gains) {
    const double stray = kStray * mean_value(sample);
    std::vector<float> ratio(model.size());
    for (std::size_t i = 0; i < model.size(); ++i) {
        const std::size_t pair = i / sample.num_bins;
        const double expected = gains[pair] * static_cast<double>(model[i]) +
                                static_cast<double>(sample.ambient[pair]) + stray;
        ratio[i] = static_cast<float>(std::max(0.0, static_cast<double>(sample.values[i])) /
                                      std::max(expected, 1e-30));
    }
    return ratio;
}

/// The ranges between which the sample's light lies, device legs taken off.
std::array<double, 2> range_limits(const HistogramSample& sample, const PathGeometry& geometry) {
    double legs_m = 0.0;
    Vec3 apart = Vec3::Zero();
    for (std::size_t i = 0; i < sample.pairs.size(); ++i) {
        const double share = 1.0 / static_cast<double>(sample.pairs.size());
        legs_m += share * geometry.legs_m[i];
        apart += share * (geometry.illumination[i] - geometry.sensing[i]);
    }
    const double end_m =
        geometry.opl_start_m + geometry.bin_width_m * static_cast<double>(sample.num_bins);
    const double low = 0.5 * (std::min(geometry.opl_start_m, end_m) - legs_m - apart.norm());
    const double high = 0.5 * (std::max(geometry.opl_start_m, end_m) - legs_m + apart.norm());
    return {std::max(low, kNearest * high), high};
}

/// Fits the light of cells to a sample; returns what it leaves over.
double fit_light(const HistogramSample& sample, const Transport& transport, Cells& cells) {
    const std::vector<float> ones(sample.values.size(), 1.0F);
    cells.reach = transport.backward(ones, std::vector<double>(sample.pairs.size(), 1.0)).plain;
    if (cells.light.empty()) {
        for (const float reach : cells.reach) {
            cells.light.push_back(reach > 0.0F ? 1.0 / static_cast<double>(reach) : 0.0);
        }
    }
    std::vector<float> model = transport.forward(cells.light);
    std::vector<double> gains = fit_gains(sample, model);
    for (int i = 0; i < kIterations; ++i) {
        const Reach reach = transport.backward(ratios(sample, model, gains), gains);
        for (std::size_t c = 0; c < cells.light.size(); ++c) {
            cells.light[c] *=
                reach.plain[c] > 0.0F ? static_cast<double>(reach.rated[c] / reach.plain[c]) : 0.0;
        }
        model = transport.forward(cells.light);
        gains = fit_gains(sample, model);
    }
    return misfit(sample, model, gains);
}

}  // namespace

bool has_structure(const HistogramSample& sample) {
    constexpr double kSignificance = 10.0;
    const double noise = std::sqrt(2.0 * static_cast<double>(sample.values.size()));
    return misfit_without_geometry(sample) > kSignificance * noise;
}

double unexplained_share(const HistogramSample& sample, const PathGeometry& geometry) {
    const auto [low_m, high_m] = range_limits(sample, geometry);
    if (!(high_m > low_m)) return 1.0;
    const double structure = std::max(misfit_without_geometry(sample), 1e-30);
    Cells cells = coarse_cells(low_m, high_m);
    double left_over = 0.0;
    for (int stage = 0; stage < kStages; ++stage) {
        if (stage > 0) cells = halved_cells(cells);
        const Transport transport(sample, geometry, cells);
        left_over = fit_light(sample, transport, cells);
    }
    return std::max(0.0, left_over) / structure;
}

}  // namespace nlos
