// SPDX-License-Identifier: MIT
#include "renderer/geometry/visibility_mask.h"

#include <algorithm>
#include <cstddef>

namespace renderer {
namespace {

using Barycentric = std::array<double, 3>;
using Triangle = std::array<Barycentric, 3>;

// Child 0-2 (at that corner) or 3 (the middle one) of quartering.
constexpr Triangle child_of(const Triangle& parent, std::size_t child) {
    const auto middle = [&](std::size_t i, std::size_t j) {
        Barycentric m{};
        for (std::size_t k = 0; k < 3; ++k) m[k] = 0.5 * (parent[i][k] + parent[j][k]);
        return m;
    };
    if (child == 3) return {middle(0, 1), middle(1, 2), middle(2, 0)};
    return {parent[child], middle(child, (child + 1) % 3), middle(child, (child + 2) % 3)};
}

constexpr std::array<Barycentric, 16> make_centers() {
    std::array<Barycentric, 16> centers{};
    const Triangle whole{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (std::size_t bit = 0; bit < 16; ++bit) {
        const Triangle triangle = child_of(child_of(whole, bit / 4), bit % 4);
        for (std::size_t k = 0; k < 3; ++k) {
            centers[bit][k] = (triangle[0][k] + triangle[1][k] + triangle[2][k]) / 3.0;
        }
    }
    return centers;
}

constexpr std::array<Barycentric, 16> kCenters = make_centers();

// With M_j the mean over the triangle of [visible] b_j, f = M_0 + M_1 + M_2 the visible fraction,
// and mean(b_i b_j) = (1 + delta_ij)/12, the linear function with these moments is v_j = 12 M_j - 3
// f. Every bit contributes its part to the sum; the table holds four bits at a time.
using NibbleTable = std::array<std::array<Barycentric, 16>, 4>;

constexpr NibbleTable make_table() {
    NibbleTable table{};
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
        for (std::size_t nibble = 0; nibble < 16; ++nibble) {
            for (std::size_t bit = 0; bit < 4; ++bit) {
                if ((nibble >> bit & 1U) == 0) continue;
                const Barycentric& center = kCenters[4 * quarter + bit];
                for (std::size_t k = 0; k < 3; ++k) {
                    table[quarter][nibble][k] += (12.0 * center[k] - 3.0) / 16.0;
                }
            }
        }
    }
    return table;
}

constexpr NibbleTable kTable = make_table();

}  // namespace

const std::array<Barycentric, 16>& centers_of_bits() {
    return kCenters;
}

Barycentric visible_fraction(VisibilityMask mask) {
    Barycentric fraction{};
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
        const Barycentric& part = kTable[quarter][mask >> (4 * quarter) & 15U];
        for (std::size_t k = 0; k < 3; ++k) fraction[k] += part[k];
    }
    const double mean = (fraction[0] + fraction[1] + fraction[2]) / 3.0;
    const double lowest = std::min({fraction[0], fraction[1], fraction[2]});
    if (lowest < 0.0) {
        for (double& value : fraction) value = mean + mean / (mean - lowest) * (value - mean);
    }
    return fraction;
}

}  // namespace renderer
