// SPDX-License-Identifier: MIT
#include "nlos/preparation/scatter_cells.h"

#include "renderer/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

using core::Vec3;
using Cell = ScatterCells::Cell;

constexpr std::size_t kRanges = 16;      // cells to begin with
constexpr std::size_t kDirections = 16;  // per side of the square around the hemisphere
constexpr double kKeptLight = 0.98;      // of all, in cells that are halved
constexpr std::size_t kMostKept = 600;
constexpr std::size_t kBlock = 256;  // cells at once

Vec3 position_of(const Cell& cell, const core::Transform& world_from_wall) {
    const double z = std::sqrt(std::max(1e-4, 1.0 - cell.y() * cell.y() - cell.z() * cell.z()));
    return world_from_wall * Vec3(cell.x() * cell.y(), cell.x() * cell.z(), cell.x() * z);
}

bool is_before_the_wall(const Cell& cell) {
    return cell.y() * cell.y() + cell.z() * cell.z() < 1.0;
}

/// The cells that hold nearly all light, heaviest first.
std::vector<std::size_t> heaviest_cells(const ScatterCells& cells) {
    std::vector<double> sent(cells.centers.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
        sent[i] = cells.light[i] * static_cast<double>(cells.reach[i]);
    }
    std::vector<std::size_t> order(sent.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return sent[i]; });
    double missing = kKeptLight * std::accumulate(sent.begin(), sent.end(), 0.0);
    std::size_t kept = 0;
    while (kept < std::min(kMostKept, order.size()) && missing > 0.0)
        missing -= sent[order[kept++]];
    order.resize(kept);
    return order;
}

}  // namespace

ScatterCells coarse_cells(double low_m, double high_m) {
    ScatterCells cells;
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

ScatterCells halved_cells(const ScatterCells& cells) {
    ScatterCells halves;
    halves.size = 0.5 * cells.size;
    for (const std::size_t i : heaviest_cells(cells)) {
        for (int corner = 0; corner < 8; ++corner) {
            const Cell side(
                corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
            const Cell center = cells.centers[i] + side.cwiseProduct(halves.size);
            if (!is_before_the_wall(center)) continue;
            halves.centers.push_back(center);
            halves.light.push_back(cells.light[i]);
        }
    }
    return halves;
}

ScatterTransport::ScatterTransport(const HistogramSample& sample,
                                   const PathGeometry& geometry,
                                   const ScatterCells& cells)
    : num_pairs_(sample.pairs.size()),
      num_bins_(sample.num_bins),
      num_cells_(cells.centers.size()),
      observed_(sample.observed),
      position_(num_pairs_ * num_cells_),
      weight_(num_pairs_ * num_cells_) {
    std::vector<Vec3> positions;
    for (const Cell& cell : cells.centers) {
        positions.push_back(position_of(cell, geometry.world_from_wall));
    }
    core::parallel_for(num_pairs_, [&](std::size_t pair) { fill(pair, geometry, positions); });
}

void ScatterTransport::fill(std::size_t pair,
                            const PathGeometry& geometry,
                            const std::vector<Vec3>& positions) {
    const Vec3 normal = geometry.world_from_wall.linear().col(2);
    const auto last_bin = static_cast<float>(num_bins_ - 1);
    for (std::size_t cell = 0; cell < num_cells_; ++cell) {
        const Vec3 out = positions[cell] - geometry.illumination[pair];
        const Vec3 back = positions[cell] - geometry.sensing[pair];
        const double out_m = out.norm();
        const double back_m = back.norm();
        const double opl = out_m + back_m + geometry.legs_m[pair] - geometry.opl_start_m;
        const auto bin = static_cast<float>(opl / geometry.bin_width_m - 0.5);
        if (!(bin >= 0.0F) || !(bin < last_bin)) continue;
        const double cosines = std::abs(out.dot(normal) * back.dot(normal)) / (out_m * back_m);
        const std::size_t i = pair * num_cells_ + cell;
        position_[i] = bin;
        weight_[i] = static_cast<float>(cosines / std::pow(out_m * back_m, 2));
    }
}

std::vector<float> ScatterTransport::forward(const std::vector<double>& light) const {
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
        for (std::size_t bin = 0; bin < num_bins_; ++bin) {
            const std::size_t i = pair * num_bins_ + bin;
            model[i] = observed_[i] * static_cast<float>(row[bin]);
        }
    });
    return model;
}

CellReach ScatterTransport::backward(const std::vector<float>& ratio,
                                     const std::vector<double>& gain) const {
    CellReach reach{std::vector<float>(num_cells_), std::vector<float>(num_cells_)};
    core::parallel_blocks(num_cells_, kBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t pair = 0; pair < num_pairs_; ++pair) {
            const float* seen = observed_.data() + pair * num_bins_;
            const float* rated = ratio.data() + pair * num_bins_;
            const auto pair_gain = static_cast<float>(gain[pair]);
            for (std::size_t cell = begin; cell < end; ++cell) {
                const std::size_t i = pair * num_cells_ + cell;
                const auto bin = static_cast<int>(position_[i]);
                const float late = position_[i] - static_cast<float>(bin);
                const float weight = pair_gain * weight_[i];
                reach.plain[cell] += weight * (seen[bin] + late * (seen[bin + 1] - seen[bin]));
                reach.rated[cell] += weight * (rated[bin] + late * (rated[bin + 1] - rated[bin]));
            }
        }
    });
    return reach;
}

}  // namespace nlos
