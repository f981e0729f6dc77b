// SPDX-License-Identifier: MIT
#include "renderer/piece_neighbours.h"

#include <algorithm>
#include <bit>

namespace renderer {
namespace {

using core::Vec3;

std::uint64_t mix(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9ULL;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebULL;
    return bits ^ (bits >> 31);
}

// Adding 0.0 turns -0.0 into 0.0.
std::uint64_t key_of(const Vec3& p) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };
    return mix(mix(mix(bits(p.x())) + bits(p.y())) + bits(p.z()));
}

struct Mark {
    std::uint64_t key;
    std::uint32_t piece;
    bool of_half;  // of half an edge: touches whole edges only

    bool operator<(const Mark& other) const {
        return key != other.key ? key < other.key : piece < other.piece;
    }
};

}  // namespace

std::vector<std::pair<std::uint32_t, std::uint32_t>> touching_pieces(
    std::span<const Piece> pieces) {
    std::vector<Mark> marks;
    marks.reserve(9 * pieces.size());
    for (std::uint32_t p = 0; p < pieces.size(); ++p) {
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 middle = pieces[p].midpoint(i);
            const Vec3& a = pieces[p].corners[i];
            const Vec3& b = pieces[p].corners[(i + 1) % 3];
            marks.push_back({key_of(middle), p, false});
            marks.push_back({key_of(0.5 * (a + middle)), p, true});
            marks.push_back({key_of(0.5 * (middle + b)), p, true});
        }
    }
    std::sort(marks.begin(), marks.end());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (auto begin = marks.begin(); begin != marks.end();) {
        auto end = begin;
        while (end != marks.end() && end->key == begin->key) ++end;
        for (auto a = begin; a != end; ++a) {
            for (auto b = a + 1; b != end; ++b) {
                if (a->piece != b->piece && !(a->of_half && b->of_half)) {
                    pairs.emplace_back(a->piece, b->piece);
                }
            }
        }
        begin = end;
    }
    return pairs;
}

NeighbourLists neighbour_lists(std::size_t num_items,
                               std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs) {
    const std::size_t count = pairs.size();
    for (std::size_t i = 0; i < count; ++i) pairs.emplace_back(pairs[i].second, pairs[i].first);
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    NeighbourLists lists;
    lists.begin.assign(num_items + 1, 0);
    for (const auto& [from, to] : pairs) {
        ++lists.begin[from + 1];
        lists.items.push_back(to);
    }
    for (std::size_t i = 0; i < num_items; ++i) lists.begin[i + 1] += lists.begin[i];
    return lists;
}

}  // namespace renderer
