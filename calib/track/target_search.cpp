// SPDX-License-Identifier: MIT
#include "calib/track/target_search.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace calib {

using core::Vec3;

bool SearchBox::holds(const Vec3& position_m) const {
    const Vec3 p = world_from_wall.inverse() * position_m;
    for (int axis = 0; axis < 3; ++axis) {
        const auto& range = ranges_m[static_cast<std::size_t>(axis)];
        if (!(p[axis] >= range[0]) || !(p[axis] <= range[1])) return false;
    }
    return true;
}

TargetSearch::TargetSearch(const TargetResponse& response, const SearchBox& box, double cell_m) {
    lay_grid(box, cell_m);
    // Cells are computed in parallel and stored in their order.
    std::vector<Cell> cells(positions_.size());
    constexpr std::size_t kBlock = 64;
    core::parallel_blocks(positions_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<double> values(response.size());
        for (std::size_t c = begin; c < end; ++c) {
            const auto windows = response.evaluate(positions_[c], values, {});
            for (std::size_t zone = 0; zone < windows.size(); ++zone) {
                const auto first = zone * response.num_bins();
                cells[c].add(
                    std::span(values).subspan(first, response.num_bins()), first, windows[zone]);
            }
        }
    });
    for (const Cell& cell : cells) append(cell);
    first_run_.push_back(static_cast<std::uint32_t>(runs_.size()));
}

void TargetSearch::lay_grid(const SearchBox& box, double cell_m) {
    std::array<double, 3> pitch_m{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double extent_m = box.ranges_m[axis][1] - box.ranges_m[axis][0];
        cells_[axis] = std::max(1, static_cast<int>(std::ceil(extent_m / cell_m)));
        pitch_m[axis] = extent_m / cells_[axis];
    }
    const auto middle = [&](std::size_t axis, int i) {
        return box.ranges_m[axis][0] + (i + 0.5) * pitch_m[axis];
    };
    for (int z = 0; z < cells_[2]; ++z) {
        for (int y = 0; y < cells_[1]; ++y) {
            for (int x = 0; x < cells_[0]; ++x) {
                positions_.push_back(box.world_from_wall *
                                     Vec3(middle(0, x), middle(1, y), middle(2, z)));
            }
        }
    }
}

// Keeps the bins of a zone that are not 0.
void TargetSearch::Cell::add(std::span<const double> zone,
                             std::size_t first,
                             const TargetResponse::Window& window) {
    if (window.begin >= window.end) return;
    runs.push_back({static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(window.begin),
                    static_cast<std::uint32_t>(window.end - window.begin),
                    static_cast<std::uint32_t>(values.size())});
    for (int b = window.begin; b < window.end; ++b) {
        values.push_back(static_cast<float>(zone[static_cast<std::size_t>(b)]));
    }
}

void TargetSearch::append(const Cell& cell) {
    first_run_.push_back(static_cast<std::uint32_t>(runs_.size()));
    for (Run run : cell.runs) {
        run.at += static_cast<std::uint32_t>(values_.size());
        runs_.push_back(run);
    }
    values_.insert(values_.end(), cell.values.begin(), cell.values.end());
}

std::size_t TargetSearch::index(const std::array<int, 3>& cell) const {
    const auto along = [&](std::size_t axis) { return static_cast<std::size_t>(cells_[axis]); };
    const auto at = [&](std::size_t axis) { return static_cast<std::size_t>(cell[axis]); };
    return (at(2) * along(1) + at(1)) * along(0) + at(0);
}

// Normal approximation: residuals over variances, and inverse variances. A bin with many more
// counts than expected has a larger variance than the background alone says.
std::vector<TargetSearch::Score> TargetSearch::score(const FrameCounts& frame) const {
    const std::size_t size = frame.counts.size();
    std::vector<float> pull(size);
    std::vector<float> precision(size);
    for (std::size_t i = 0; i < size; ++i) {
        const double variance = std::max(frame.background[i], 0.5 * frame.counts[i]);
        precision[i] = static_cast<float>(frame.weights[i] / variance);
        pull[i] = static_cast<float>(frame.counts[i] - frame.background[i]) * precision[i];
    }
    std::vector<Score> scores(positions_.size());
    for (std::size_t c = 0; c < positions_.size(); ++c) {
        float slope = 0.0F;
        float curvature = 0.0F;
        for (std::uint32_t p = first_run_[c]; p < first_run_[c + 1]; ++p) {
            const Run& run = runs_[p];
            const float* s = values_.data() + run.at;
            const float* r = pull.data() + run.first;
            const float* w = precision.data() + run.first;
            for (std::uint32_t i = 0; i < run.size; ++i) {
                slope += s[i] * r[i];
                curvature += s[i] * s[i] * w[i];
            }
        }
        if (slope <= 0.0F || curvature <= 0.0F) continue;
        scores[c] = {0.5F * slope * slope / curvature, slope / curvature};
    }
    return scores;
}

// Whether no cell beside this one is better.
bool TargetSearch::is_peak(const std::vector<Score>& scores, const std::array<int, 3>& cell) const {
    const float own = scores[index(cell)].value;
    if (own <= 0.0F) return false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
            std::array<int, 3> beside = cell;
            beside[axis] += step;
            const bool is_inside = beside[axis] >= 0 && beside[axis] < cells_[axis];
            if (is_inside && scores[index(beside)].value > own) return false;
        }
    }
    return true;
}

std::vector<Candidate> TargetSearch::find(const FrameCounts& frame,
                                          std::size_t most,
                                          const Vec3& offset_m) const {
    const std::vector<Score> scores = score(frame);
    std::vector<Candidate> found;
    for (int z = 0; z < cells_[2]; ++z) {
        for (int y = 0; y < cells_[1]; ++y) {
            for (int x = 0; x < cells_[0]; ++x) {
                if (!is_peak(scores, {x, y, z})) continue;
                const std::size_t c = index({x, y, z});
                found.push_back({positions_[c] + offset_m, scores[c].strength, scores[c].value});
            }
        }
    }
    std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) {
        return a.score > b.score;
    });
    if (found.size() > most) found.resize(most);
    return found;
}

}  // namespace calib
