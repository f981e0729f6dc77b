// SPDX-License-Identifier: MIT
#include "renderer/scene/box_tree.h"

#include <utility>

namespace renderer {
namespace {

constexpr int kBitsPerAxis = 21;

// Spreads bits so that two others fit between each and the next.
std::uint64_t spread(std::uint64_t bits) {
    bits = (bits | bits << 32) & 0x001f00000000ffff;
    bits = (bits | bits << 16) & 0x001f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

// The place along the Morton curve of a point in the unit cube.
std::uint64_t place_on_curve(const core::Vec3& point) {
    constexpr double kCells = std::uint64_t{1} << kBitsPerAxis;
    std::uint64_t place = 0;
    for (const double coordinate : point) {
        const double cell = std::clamp(kCells * coordinate, 0.0, kCells - 1.0);
        place = place << 1 | spread(static_cast<std::uint64_t>(cell));
    }
    return place;
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) {
    Box all;
    for (const Box& box : boxes) all.extend(box);
    const double size = boxes.empty() ? 0.0 : all.sizes().maxCoeff();
    const double per_size = size > 0.0 ? 1.0 / size : 0.0;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    order.reserve(boxes.size());
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
        order.emplace_back(place_on_curve((boxes[i].center() - all.min()) * per_size), i);
    }
    std::sort(order.begin(), order.end());
    std::vector<Box>& leaves = levels_.emplace_back();
    leaves.reserve(boxes.size());
    number_.reserve(boxes.size());
    for (const auto& [place, number] : order) {
        number_.push_back(number);
        leaves.push_back(boxes[number]);
    }
    while (levels_.back().size() > kBranches) {
        std::vector<Box> parents((levels_.back().size() + kBranches - 1) / kBranches);
        for (std::size_t i = 0; i < levels_.back().size(); ++i) {
            parents[i / kBranches].extend(levels_.back()[i]);
        }
        levels_.push_back(std::move(parents));
    }
}

}  // namespace renderer
