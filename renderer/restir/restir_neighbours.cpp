// SPDX-License-Identifier: MIT
#include "renderer/restir/restir_neighbours.h"

#include "renderer/core/nearest_neighbours.h"

#include <algorithm>
#include <utility>

namespace renderer {
namespace {

constexpr std::size_t kNearPoints = 8;
constexpr std::ptrdiff_t kPixelRadius = 2;

// The nearest other points of each point, (points, count).
std::vector<std::size_t> near_points(const std::vector<core::Vec3>& points, std::size_t count) {
    if (count == 0) return {};
    const core::NearestNeighbours found = core::nearest_neighbours(points, points, count + 1);
    std::vector<std::size_t> near;
    near.reserve(points.size() * count);
    for (std::size_t i = 0; i < points.size(); ++i) {
        // A point is usually its own nearest, but not where points coincide.
        const auto* const begin = found.indices.data() + i * (count + 1);
        const auto* const self = std::find(begin, begin + count, i);
        near.insert(near.end(), begin, self);
        near.insert(near.end(), self + (self == begin + count ? 0 : 1), begin + count + 1);
        near.resize((i + 1) * count);
    }
    return near;
}

}  // namespace

RestirNeighbours::RestirNeighbours(const core::Scan& scan) : scan_(scan) {
    const auto* wall = scan.as<core::WallScan>();
    if (wall == nullptr) return;
    near_sensing_count_ = std::min(kNearPoints, wall->sensing.size() - 1);
    near_sensing_ = near_points(wall->sensing.positions, near_sensing_count_);
    if (!wall->is_exhaustive()) return;
    near_illumination_count_ = std::min(kNearPoints, wall->illumination.size() - 1);
    near_illumination_ = near_points(wall->illumination.positions, near_illumination_count_);
}

void RestirNeighbours::list(const core::ImageScan& image,
                            std::size_t pixel,
                            std::vector<std::size_t>& near) const {
    const auto width = static_cast<std::ptrdiff_t>(image.camera.width());
    const auto height = static_cast<std::ptrdiff_t>(image.camera.height());
    const std::ptrdiff_t x = static_cast<std::ptrdiff_t>(pixel) / height;
    const std::ptrdiff_t y = static_cast<std::ptrdiff_t>(pixel) % height;
    for (std::ptrdiff_t i = x - kPixelRadius; i <= x + kPixelRadius; ++i) {
        for (std::ptrdiff_t j = y - kPixelRadius; j <= y + kPixelRadius; ++j) {
            if (i < 0 || j < 0 || i >= width || j >= height || (i == x && j == y)) continue;
            near.push_back(static_cast<std::size_t>(i * height + j));
        }
    }
}

void RestirNeighbours::list(const core::WallScan& scan,
                            std::size_t pair,
                            std::vector<std::size_t>& near) const {
    const std::size_t sensing = scan.sensing.size();
    const std::size_t sensor = pair % sensing;
    for (std::size_t i = 0; i < near_sensing_count_; ++i) {
        near.push_back(pair - sensor + near_sensing_[sensor * near_sensing_count_ + i]);
    }
    for (std::size_t i = 0; i < near_illumination_count_; ++i) {
        const std::size_t light = pair / sensing;
        near.push_back(near_illumination_[light * near_illumination_count_ + i] * sensing + sensor);
    }
}

void RestirNeighbours::pick(std::size_t pair,
                            int count,
                            core::Rng& rng,
                            std::vector<std::size_t>& picked) const {
    picked.clear();
    scan_.visit([&](const auto& kind) { list(kind, pair, picked); });
    const std::size_t wanted = std::min(picked.size(), static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < wanted; ++i) {
        const auto rest = static_cast<double>(picked.size() - i);
        std::swap(picked[i], picked[i + static_cast<std::size_t>(rng.uniform() * rest)]);
    }
    picked.resize(wanted);
}

}  // namespace renderer
