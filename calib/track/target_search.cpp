// SPDX-License-Identifier: MIT
#include "calib/track/target_search.h"

#include "renderer/core/parallel.h"

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
    std::array<double, 3> pitch_m{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double extent_m = box.ranges_m[axis][1] - box.ranges_m[axis][0];
        cells_[axis] = std::max(1, static_cast<int>(std::ceil(extent_m / cell_m)));
        pitch_m[axis] = extent_m / cells_[axis];
    }
    const auto place = [&](std::size_t axis, int i) {
        return box.ranges_m[axis][0] + (i + 0.5) * pitch_m[axis];
    };
    for (int z = 0; z < cells_[2]; ++z) {
        for (int y = 0; y < cells_[1]; ++y) {
            for (int x = 0; x < cells_[0]; ++x) {
                positions_.push_back(box.world_from_wall *
                                     Vec3(place(0, x), place(1, y), place(2, z)));
            }
        }
    }
    struct Cell {
        std::vector<Piece> pieces;
        std::vector<float> values;
    };
    std::vector<Cell> made(positions_.size());
    constexpr std::size_t kBlock = 64;
    core::parallel_blocks(positions_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
        std::vector<double> values(response.size());
        for (std::size_t c = begin; c < end; ++c) {
            const auto windows = response.evaluate(positions_[c], values, {});
            for (std::size_t zone = 0; zone < windows.size(); ++zone) {
                if (windows[zone].begin >= windows[zone].end) continue;
                const std::size_t first =
                    zone * response.num_bins() + static_cast<std::size_t>(windows[zone].begin);
                const auto size = static_cast<std::size_t>(windows[zone].end - windows[zone].begin);
                made[c].pieces.push_back({static_cast<std::uint32_t>(first),
                                          static_cast<std::uint32_t>(size),
                                          static_cast<std::uint32_t>(made[c].values.size())});
                for (std::size_t i = 0; i < size; ++i) {
                    made[c].values.push_back(static_cast<float>(values[first + i]));
                }
            }
        }
    });
    for (const Cell& cell : made) {
        first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
        for (Piece piece : cell.pieces) {
            piece.at += static_cast<std::uint32_t>(values_.size());
            pieces_.push_back(piece);
        }
        values_.insert(values_.end(), cell.values.begin(), cell.values.end());
    }
    first_piece_.push_back(static_cast<std::uint32_t>(pieces_.size()));
}

std::size_t TargetSearch::index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(cells_[1]) +
            static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(cells_[0]) +
           static_cast<std::size_t>(x);
}

std::vector<Candidate> TargetSearch::find(const FrameCounts& frame,
                                          std::size_t most,
                                          const Vec3& offset_m) const {
    // Normal approximation: residuals over variances, and inverse variances. A bin with many more
    // counts than expected has a larger variance than the background alone says.
    const std::size_t size = frame.counts.size();
    std::vector<float> pull(size);
    std::vector<float> precision(size);
    for (std::size_t i = 0; i < size; ++i) {
        const double variance = std::max(frame.background[i], 0.5 * frame.counts[i]);
        precision[i] = static_cast<float>(frame.weights[i] / variance);
        pull[i] = static_cast<float>(frame.counts[i] - frame.background[i]) * precision[i];
    }
    std::vector<float> scores(positions_.size(), 0.0F);
    std::vector<float> strengths(positions_.size(), 0.0F);
    for (std::size_t c = 0; c < positions_.size(); ++c) {
        float slope = 0.0F;
        float curvature = 0.0F;
        for (std::uint32_t p = first_piece_[c]; p < first_piece_[c + 1]; ++p) {
            const Piece& piece = pieces_[p];
            const float* s = values_.data() + piece.at;
            const float* r = pull.data() + piece.first;
            const float* w = precision.data() + piece.first;
            for (std::uint32_t i = 0; i < piece.size; ++i) {
                slope += s[i] * r[i];
                curvature += s[i] * s[i] * w[i];
            }
        }
        if (slope <= 0.0F || curvature <= 0.0F) continue;
        scores[c] = 0.5F * slope * slope / curvature;
        strengths[c] = slope / curvature;
    }
    std::vector<Candidate> found;
    for (int z = 0; z < cells_[2]; ++z) {
        for (int y = 0; y < cells_[1]; ++y) {
            for (int x = 0; x < cells_[0]; ++x) {
                const std::size_t c = index(x, y, z);
                if (scores[c] <= 0.0F) continue;
                const auto beats = [&](int dx, int dy, int dz) {
                    const int i = x + dx, j = y + dy, k = z + dz;
                    if (i < 0 || j < 0 || k < 0 || i >= cells_[0] || j >= cells_[1] ||
                        k >= cells_[2]) {
                        return true;
                    }
                    return scores[c] >= scores[index(i, j, k)];
                };
                if (beats(1, 0, 0) && beats(-1, 0, 0) && beats(0, 1, 0) && beats(0, -1, 0) &&
                    beats(0, 0, 1) && beats(0, 0, -1)) {
                    found.push_back({positions_[c] + offset_m, strengths[c], scores[c]});
                }
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
