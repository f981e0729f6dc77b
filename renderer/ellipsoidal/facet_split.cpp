// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/facet_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kNumBins = 16;
constexpr int kNumKeys = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What differs by less is equal, and the first of equals is taken: rounding, which differs from one
// place of the world to another, decides nothing.
constexpr double kTie = 1e-6;

bool is_above(double value, double other) {
    return value > (1.0 + kTie) * other;
}

struct Part {
    std::span<std::uint32_t> set;
    double cost = 0.0;
};

// What a cut needs to know of some facets.
struct Bin {
    Eigen::AlignedBox3d box;
    double area_m2 = 0.0;
    bool empty = true;

    void add(const Facet& facet) {
        for (const Vec3& corner : facet.corners()) box.extend(corner);
        area_m2 += facet.area_m2;
        empty = false;
    }
    void add(const Bin& other) {
        box.extend(other.box);
        area_m2 += other.area_m2;
        empty = empty && other.empty;
    }
    double cost() const {
        const Vec3 d = box.sizes();
        return area_m2 * (d.x() * d.y() + d.y() * d.z() + d.z() * d.x());
    }
};

// What facets are sorted by: x, y, z of the centroid, or the logarithm of the area.
double key_of(const Facet& facet, int key) {
    if (key == 3) return std::log(facet.area_m2);
    return facet.point(1.0 / 3.0, 1.0 / 3.0)[key];
}

// Longest side of the box of the facets' centroids [m].
double size_of(std::span<const std::uint32_t> set, std::span<const Facet> facets) {
    Eigen::AlignedBox3d box;
    for (const std::uint32_t f : set) box.extend(facets[f].point(1.0 / 3.0, 1.0 / 3.0));
    return box.sizes().maxCoeff();
}

// Range of a key over a set, in bins of equal width.
struct KeyBins {
    int key = 0;
    double low = 0.0;
    double bins_per_unit = 0.0;  ///< 0: all facets have the same key

    KeyBins() = default;
    KeyBins(std::span<const std::uint32_t> set, std::span<const Facet> facets, int key_asked)
        : key(key_asked), low(kInfinity) {
        double high = -kInfinity;
        for (const std::uint32_t f : set) {
            const double value = key_of(facets[f], key);
            low = std::min(low, value);
            high = std::max(high, value);
        }
        // Logarithms of areas are compared as they are, positions beside the size of what is cut.
        const double unit = key == 3 ? 1.0 : size_of(set, facets);
        if (high - low > kTie * unit) bins_per_unit = kNumBins / (high - low);
    }
    std::size_t bin_of(const Facet& facet) const {
        const double bin = (key_of(facet, key) - low) * bins_per_unit + kNumBins * kTie;
        return std::min(static_cast<std::size_t>(bin), kNumBins - 1);
    }
};

struct Cut {
    KeyBins bins;
    std::size_t first_above = 0;  ///< bin; 0: no cut
    double cost_below = 0.0;
    double cost_above = kInfinity;

    double cost() const { return cost_below + cost_above; }
};

Cut best_cut(std::span<const std::uint32_t> set, std::span<const Facet> facets) {
    Cut best;
    for (int key = 0; key < kNumKeys; ++key) {
        const KeyBins bins(set, facets, key);
        if (!(bins.bins_per_unit > 0.0)) continue;
        std::array<Bin, kNumBins> from;  // at first of one bin, then of all from it on
        for (const std::uint32_t f : set) from[bins.bin_of(facets[f])].add(facets[f]);
        std::array<Bin, kNumBins> below;
        for (std::size_t i = 1; i < kNumBins; ++i) {
            below[i] = below[i - 1];
            below[i].add(from[i - 1]);
        }
        for (std::size_t i = kNumBins - 1; i-- > 0;) from[i].add(from[i + 1]);
        for (std::size_t i = 1; i < kNumBins; ++i) {
            if (below[i].empty || from[i].empty) continue;
            const Cut cut{bins, i, below[i].cost(), from[i].cost()};
            if (is_above(best.cost(), cut.cost())) best = cut;
        }
    }
    return best;
}

std::pair<Part, Part> cut_in_two(std::span<std::uint32_t> set,
                                 std::span<const Facet> facets,
                                 bool halve) {
    const Cut cut = halve ? Cut() : best_cut(set, facets);
    std::size_t num_below = set.size() / 2;
    if (cut.first_above > 0) {
        const auto end = std::stable_partition(set.begin(), set.end(), [&](std::uint32_t f) {
            return cut.bins.bin_of(facets[f]) < cut.first_above;
        });
        num_below = static_cast<std::size_t>(end - set.begin());
    }
    return {{set.first(num_below), cut.cost_below}, {set.subspan(num_below), cut.cost_above}};
}

}  // namespace

std::vector<std::span<std::uint32_t>> split_facets(std::span<std::uint32_t> set,
                                                   std::span<const Facet> facets,
                                                   std::size_t max_parts,
                                                   bool halve) {
    std::vector<Part> parts{{set, 0.0}};
    // Only sets of several facets can be cut.
    const auto cost_of = [](const Part& part) { return part.set.size() > 1 ? part.cost : -1.0; };
    while (parts.size() < max_parts) {
        const auto costliest =
            std::max_element(parts.begin(), parts.end(), [&](const Part& p, const Part& q) {
                return is_above(cost_of(q), cost_of(p));
            });
        if (costliest->set.size() < 2) break;
        const auto [below, above] = cut_in_two(costliest->set, facets, halve);
        *costliest = below;
        parts.insert(costliest + 1, above);
    }
    std::vector<std::span<std::uint32_t>> sets;
    for (const Part& part : parts) sets.push_back(part.set);
    return sets;
}

}  // namespace renderer
