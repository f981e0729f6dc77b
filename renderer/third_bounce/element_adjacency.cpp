// SPDX-License-Identifier: MIT
#include "renderer/core/random.h"
#include "renderer/third_bounce/element_clusters.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace renderer {
namespace {

using core::Vec3;

// Adding 0.0 turns -0.0 into 0.0.
std::uint64_t key_of(const Vec3& p) {
    constexpr auto mix = core::Rng::mix;
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };
    return mix(mix(mix(bits(p.x())) + bits(p.y())) + bits(p.z()));
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

// A whole edge or half of one, known by its midpoint.
struct Mark {
    std::uint64_t key;
    std::uint32_t element;
    std::uint16_t edge;
    bool of_half;

    bool operator<(const Mark& other) const {
        return key != other.key ? key < other.key : element < other.element;
    }
};

// More elements at one edge than this are paired in a chain: all pairs of thousands of coinciding
// triangles would fill the memory.
constexpr std::ptrdiff_t kMostAtAnEdge = 8;

// Pairs up marks with equal keys; halves match whole edges only. Returns the whole edges that found
// no partner.
std::vector<Mark> pair_up(std::vector<Mark>& marks, Pairs& pairs) {
    std::sort(marks.begin(), marks.end());
    std::vector<Mark> alone;
    for (auto begin = marks.begin(); begin != marks.end();) {
        auto end = begin;
        while (end != marks.end() && end->key == begin->key) ++end;
        if (end - begin == 1 && !begin->of_half) alone.push_back(*begin);
        const std::ptrdiff_t reach = end - begin > kMostAtAnEdge ? 1 : kMostAtAnEdge;
        for (auto a = begin; a != end; ++a) {
            for (auto b = a + 1; b != end && b - a <= reach; ++b) {
                if (a->element != b->element && !(a->of_half && b->of_half)) {
                    pairs.emplace_back(a->element, b->element);
                }
            }
        }
        begin = end;
    }
    return alone;
}

}  // namespace

Pairs adjacent_elements(std::span<const SurfaceElement> elements) {
    Pairs pairs;
    std::vector<Mark> marks;
    marks.reserve(3 * elements.size());
    for (std::uint32_t p = 0; p < elements.size(); ++p) {
        for (std::uint16_t i = 0; i < 3; ++i) {
            marks.push_back({key_of(elements[p].midpoint(i)), p, i, false});
        }
    }
    // What is left borders on nothing or on elements of half the length.
    marks = pair_up(marks, pairs);
    const std::size_t num_alone = marks.size();
    for (std::size_t m = 0; m < num_alone; ++m) {
        const auto [key, p, edge, of_half] = marks[m];
        const Vec3 middle = elements[p].midpoint(edge);
        for (const Vec3& end : {elements[p].corners[edge], elements[p].corners[(edge + 1U) % 3U]}) {
            marks.push_back({key_of(0.5 * (middle + end)), p, edge, true});
        }
    }
    pair_up(marks, pairs);
    return pairs;
}

AdjacencyLists adjacency_lists(std::size_t num_items, const Pairs& pairs) {
    // Counting sort by the first item; then each list for itself.
    std::vector<std::uint32_t> end(num_items, 0);
    for (const auto& [a, b] : pairs) {
        ++end[a];
        ++end[b];
    }
    std::exclusive_scan(end.begin(), end.end(), end.begin(), std::uint32_t{0});
    std::vector<std::uint32_t> begin = end;
    std::vector<std::uint32_t> others(2 * pairs.size());
    for (const auto& [a, b] : pairs) {
        others[end[a]++] = b;
        others[end[b]++] = a;
    }
    AdjacencyLists lists;
    lists.begin.push_back(0);
    for (std::size_t item = 0; item < num_items; ++item) {
        const auto first = others.begin() + begin[item];
        const auto last = others.begin() + end[item];
        std::sort(first, last);
        lists.items.insert(lists.items.end(), first, std::unique(first, last));
        lists.begin.push_back(static_cast<std::uint32_t>(lists.items.size()));
    }
    return lists;
}

}  // namespace renderer
