// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/scatter_cells.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

namespace nlos {
namespace {

using core::Vec3;
using Cell = ScatterCells::Cell;

constexpr std::size_t kRanges = 16;      // cells to begin with
constexpr std::size_t kDirections = 16;  // per side of the square around the hemisphere
constexpr double kKeptLight = 0.98;      // of all
constexpr std::size_t kMostHalved = 600;
constexpr std::size_t kBlock = 256;      // cells at once
constexpr std::size_t kPairsAtOnce = 8;  // pairs at once: sums of one would wait for each other

Vec3 position_of(const Cell& cell) {
    const double z = std::sqrt(std::max(1e-4, 1.0 - cell.y() * cell.y() - cell.z() * cell.z()));
    return Vec3(cell.x() * cell.y(), cell.x() * cell.z(), cell.x() * z);
}

double farthest_m(const ScatterCells& cells) {
    double farthest = 0.0;
    for (const Cell& center : cells.centers) farthest = std::max(farthest, center.x());
    return farthest;
}

/// Ways between a point of the wall and all cells, in the unit of `positions`.
struct PathSegments {
    Eigen::ArrayXf length;
    Eigen::ArrayXf weight;  ///< cosine with the wall's normal over the squared length

    PathSegments(const Eigen::ArrayX3f& positions, const Vec3& point)
        : length(positions.rows()), weight(positions.rows()) {
        const Eigen::Vector3f from = point.cast<float>();
        for (Eigen::Index i = 0; i < length.size(); ++i) {
            const float dx = positions(i, 0) - from.x();
            const float dy = positions(i, 1) - from.y();
            const float dz = positions(i, 2) - from.z();
            const float squared = dx * dx + dy * dy + dz * dz;
            length[i] = std::sqrt(squared);
            weight[i] = std::abs(dz) / (squared * length[i]);
        }
    }
};

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
    while (kept < order.size() && missing > 0.0) missing -= sent[order[kept++]];
    order.resize(kept);
    return order;
}

}  // namespace

ScatterCells coarse_cells(double low_m, double high_m) {
    ScatterCells cells;
    const Cell size((high_m - low_m) / kRanges, 2.0 / kDirections, 2.0 / kDirections);
    for (std::size_t r = 0; r < kRanges; ++r) {
        for (std::size_t i = 0; i < kDirections * kDirections; ++i) {
            const Cell index(static_cast<double>(r) + 0.5,
                             static_cast<double>(i / kDirections) + 0.5,
                             static_cast<double>(i % kDirections) + 0.5);
            const Cell center = Cell(low_m, -1.0, -1.0) + index.cwiseProduct(size);
            if (!is_before_the_wall(center)) continue;
            cells.centers.push_back(center);
            cells.sizes.push_back(size);
        }
    }
    return cells;
}

ScatterCells refined_cells(const ScatterCells& cells) {
    const std::vector<std::size_t> kept = heaviest_cells(cells);
    ScatterCells refined;
    const auto add = [&](const Cell& center, const Cell& size, double light) {
        if (!is_before_the_wall(center)) return;
        refined.centers.push_back(center);
        refined.sizes.push_back(size);
        refined.light.push_back(light);
    };
    for (std::size_t k = 0; k < kept.size(); ++k) {
        const std::size_t i = kept[k];
        if (k >= kMostHalved) {
            add(cells.centers[i], cells.sizes[i], cells.light[i]);
            continue;
        }
        const Cell half = 0.5 * cells.sizes[i];
        for (int corner = 0; corner < 8; ++corner) {
            const Cell side(
                corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
            add(cells.centers[i] + side.cwiseProduct(half), half, cells.light[i]);
        }
    }
    return refined;
}

ScatterTransport::ScatterTransport(const HistogramSample& sample,
                                   const PathGeometry& geometry,
                                   const ScatterCells& cells)
    : num_pairs_(sample.pairs.size()),
      num_bins_(sample.num_bins),
      num_cells_(cells.centers.size()),
      unit_m_(farthest_m(cells)),
      observed_(sample.observed),
      arrivals_(num_pairs_),
      block_starts_(num_pairs_),
      reach_(num_cells_) {
    Eigen::ArrayX3f positions(num_cells_, 3);
    for (std::size_t i = 0; i < num_cells_; ++i) {
        const Vec3 position = position_of(cells.centers[i]) / unit_m_;
        positions.row(static_cast<Eigen::Index>(i)) = position.transpose().array().cast<float>();
    }
    const auto size = static_cast<Eigen::Index>(num_cells_);
    std::vector<Eigen::ArrayXf> reach((num_pairs_ + kPairsAtOnce - 1) / kPairsAtOnce);
    core::parallel_blocks(num_pairs_, kPairsAtOnce, [&](std::size_t begin, std::size_t end) {
        Eigen::ArrayXf& own = reach[begin / kPairsAtOnce];
        own.setZero(size);
        for (std::size_t pair = begin; pair < end; ++pair) fill(pair, geometry, positions, own);
    });
    Eigen::Map<Eigen::ArrayXf> sum(reach_.data(), size);
    for (const Eigen::ArrayXf& part : reach) sum += part;
}

void ScatterTransport::fill(std::size_t pair,
                            const PathGeometry& geometry,
                            const Eigen::ArrayX3f& positions,
                            Eigen::ArrayXf& reach) {
    const PathSegments out(positions, geometry.illumination[pair] / unit_m_);
    std::optional<PathSegments> other;
    if (geometry.illumination[pair] != geometry.sensing[pair]) {
        other.emplace(positions, geometry.sensing[pair] / unit_m_);
    }
    const PathSegments& back = other ? *other : out;
    const auto before =
        static_cast<float>((geometry.segments_m[pair] - geometry.opl_start_m) / unit_m_);
    const auto per_bin = static_cast<float>(unit_m_ / geometry.bin_width_m);
    const auto last = static_cast<float>(num_bins_ - 1);
    // Where each cell's light falls; that outside the sample has no weight.
    Eigen::ArrayXf bin_positions = (out.length + back.length + before) * per_bin - 0.5F;
    Eigen::ArrayXf weights = out.weight * back.weight;
    weights = (bin_positions >= 0.0F && bin_positions < last).select(weights, 0.0F);
    bin_positions = (bin_positions >= 0.0F && bin_positions < last).select(bin_positions, 0.0F);
    add_reach(pair, bin_positions, weights, reach);
    const auto arrivals = std::make_unique_for_overwrite<Arrival[]>(num_cells_);
    std::vector<std::size_t>& starts = block_starts_[pair];
    std::size_t count = 0;
    for (std::size_t begin = 0; begin < num_cells_; begin += kBlock) {
        starts.push_back(count);
        const std::size_t end = std::min(begin + kBlock, num_cells_);
        for (std::size_t cell = begin; cell < end; ++cell) {
            const auto i = static_cast<Eigen::Index>(cell);
            arrivals[count] = {static_cast<std::uint32_t>(cell), bin_positions[i], weights[i]};
            count += weights[i] > 0.0F ? 1 : 0;  // the next one takes its place unless it counts
        }
    }
    starts.push_back(count);
    arrivals_[pair].assign(arrivals.get(), arrivals.get() + count);
}

void ScatterTransport::add_reach(std::size_t pair,
                                 const Eigen::ArrayXf& bin_positions,
                                 const Eigen::ArrayXf& weights,
                                 Eigen::ArrayXf& reach) const {
    const auto observed = std::span(observed_).subspan(pair * num_bins_, num_bins_);
    if (std::ranges::count(observed, 1.0F) == std::ssize(observed)) {
        reach += weights;
        return;
    }
    for (Eigen::Index i = 0; i < reach.size(); ++i) {
        const auto bin = static_cast<std::size_t>(bin_positions[i]);
        const float late = bin_positions[i] - static_cast<float>(bin);
        reach[i] += weights[i] * ((1.0F - late) * observed[bin] + late * observed[bin + 1]);
    }
}

std::vector<float> ScatterTransport::forward(const std::vector<double>& light,
                                             const PairSubset& subset) const {
    /// Light that arrives in a bin, and the same times its positions: the mean position, up to 48
    /// in single precision, says to some 1e-5 how much of it falls into the next bin.
    struct alignas(8) Moments {
        float light = 0.0F, positions = 0.0F;
    };
    const std::vector<float> sent(light.begin(), light.end());
    std::vector<float> model(num_pairs_ * num_bins_);
    const std::size_t count = (num_pairs_ - subset.first + subset.step - 1) / subset.step;
    core::parallel_blocks(count, kPairsAtOnce, [&](std::size_t begin, std::size_t end) {
        const auto pair_of = [&](std::size_t lane) {
            return subset.first + (begin + lane) * subset.step;
        };
        std::vector<Moments> rows(kPairsAtOnce * num_bins_);
        const auto add = [&](std::size_t lane, const Arrival& arrival) {
            const float value = sent[arrival.cell] * arrival.weight;
            Moments& bin = rows[lane * num_bins_ + static_cast<std::size_t>(arrival.bin())];
            bin.light += value;
            bin.positions += arrival.position * value;
        };
        std::array<std::span<const Arrival>, kPairsAtOnce> lanes;
        for (std::size_t lane = 0; lane < end - begin; ++lane) {
            lanes[lane] = arrivals_[pair_of(lane)];
        }
        const std::size_t shared =
            std::ranges::min(lanes, {}, &std::span<const Arrival>::size).size();
        for (std::size_t k = 0; k < shared; ++k) {
            for (std::size_t lane = 0; lane < kPairsAtOnce; ++lane) add(lane, lanes[lane][k]);
        }
        for (std::size_t lane = 0; lane < end - begin; ++lane) {
            for (const Arrival& arrival : lanes[lane].subspan(shared)) add(lane, arrival);
        }
        for (std::size_t lane = 0; lane < end - begin; ++lane) {
            const std::size_t first = pair_of(lane) * num_bins_;
            float late = 0.0F;  // from the bin before
            for (std::size_t bin = 0; bin < num_bins_; ++bin) {
                const Moments& sum = rows[lane * num_bins_ + bin];
                const float later = sum.positions - static_cast<float>(bin) * sum.light;
                model[first + bin] = observed_[first + bin] * (sum.light - later + late);
                late = later;
            }
        }
    });
    return model;
}

CellReach ScatterTransport::backward(const std::vector<float>& ratio,
                                     const std::vector<double>& gain,
                                     const PairSubset& subset) const {
    using Sums = std::array<float, 2>;  // plain and rated
    struct Bin {
        Sums start, step;  // from here to the next bin: start + position * step
    };
    std::vector<Bin> bins(num_pairs_ * num_bins_);
    for (std::size_t pair = subset.first; pair < num_pairs_; pair += subset.step) {
        const auto pair_gain = static_cast<float>(gain[pair]);
        for (std::size_t bin = 0; bin + 1 < num_bins_; ++bin) {
            const std::size_t i = pair * num_bins_ + bin;
            const auto position = static_cast<float>(bin);
            const Sums step{pair_gain * (observed_[i + 1] - observed_[i]),
                            pair_gain * (ratio[i + 1] - ratio[i])};
            bins[i] = {{pair_gain * observed_[i] - position * step[0],
                        pair_gain * ratio[i] - position * step[1]},
                       step};
        }
    }
    CellReach reach{std::vector<float>(num_cells_), std::vector<float>(num_cells_)};
    core::parallel_blocks(num_cells_, kBlock, [&](std::size_t begin, std::size_t end) {
        std::array<Sums, kBlock> sums{};
        const std::size_t block = begin / kBlock;
        for (std::size_t pair = subset.first; pair < num_pairs_; pair += subset.step) {
            const Bin* const row = bins.data() + pair * num_bins_;
            const std::size_t last = block_starts_[pair][block + 1];
            for (std::size_t k = block_starts_[pair][block]; k < last; ++k) {
                const Arrival& arrival = arrivals_[pair][k];
                const Bin& bin = row[arrival.bin()];
                Sums& sum = sums[arrival.cell - begin];
                for (std::size_t i = 0; i < sum.size(); ++i) {
                    sum[i] += arrival.weight * (bin.start[i] + arrival.position * bin.step[i]);
                }
            }
        }
        for (std::size_t cell = begin; cell < end; ++cell) {
            reach.plain[cell] = sums[cell - begin][0];
            reach.rated[cell] = sums[cell - begin][1];
        }
    });
    return reach;
}

}  // namespace nlos
