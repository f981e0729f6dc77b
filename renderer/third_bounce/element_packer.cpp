// SPDX-License-Identifier: MIT
#include "renderer/core/random.h"
#include "renderer/geometry/median_split.h"
#include "renderer/third_bounce/element_clusters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace renderer {
namespace {

using core::Vec3;

// A group spans at most this times sqrt(tolerance) times its distance, ...
constexpr double kGroupSizePerDistance = 0.8;
// ... and its normals differ by about 30 degrees at most.
constexpr double kMinGroupCosine = 0.85;

// Schlick's term alone reflects this much of light from all sides, where the albedo is 0.
constexpr double kSchlickMean = 1.0 / 21.0;

struct ElementCenter {
    Vec3 position;
    std::size_t element;
};

// Median splits along the longest side of the centres' box, at whole blocks where there are
// several.
void sort_into_blocks(std::span<ElementCenter> centers) {
    const std::size_t count = centers.size();
    if (count < 2) return;
    Eigen::AlignedBox3d box;
    for (const ElementCenter& center : centers) box.extend(center.position);
    std::size_t half = (count + 1) / 2;
    if (count > ElementBlock::kSize)
        half = (half + ElementBlock::kSize - 1) / ElementBlock::kSize * ElementBlock::kSize;
    split_along_longest_side(
        centers, half, box, [](const ElementCenter& c) -> const Vec3& { return c.position; });
    sort_into_blocks(centers.first(half));
    sort_into_blocks(centers.subspan(half));
}

void find_simd_group_spheres(ElementBlock& block) {
    for_each_simd_group(kAllSimdGroups, [&](std::size_t begin) {
        Eigen::AlignedBox3d box;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = begin; i < begin + ElementBlock::kSimdWidth; ++i) {
                box.extend(block.corners[c][i]);
            }
        }
        const std::size_t simd_group = begin / ElementBlock::kSimdWidth;
        block.simd_group_center.set(simd_group, box.center());
        block.simd_group_radius_m[simd_group] = 0.5 * box.diagonal().norm();
    });
}

class ElementPacker {
 public:
    ElementPacker(const Scene& scene, const core::WallScan& scan, const PackingRules& rules)
        : scene_(scene), rules_(rules) {
        set_.origin = scene.rays().origin();
        Vec3 sum = Vec3::Zero();
        for (const Vec3& point : scan.sensing.positions) sum += point - set_.origin;
        scan_center_ = sum / static_cast<double>(scan.sensing.size());
        for (const Object& object : scene.objects()) {
            responses_.push_back(
                element_response(make_bsdf(object.material)).value_or(ElementResponse{}));
        }
    }

    ElementSet pack(std::vector<SurfaceElement> elements, std::vector<std::uint32_t> clusters);

 private:
    struct Range {
        std::size_t begin;
        std::size_t end;
    };
    const ElementResponse& response_of(const ElementCluster& element) const {
        return responses_[scene_.facet(element.triangle.facet).object];
    }
    std::size_t num_blocks(const std::vector<ElementCluster>& elements) const;
    void append_blocks(const std::vector<ElementCluster>& elements,
                       const ElementResponse& response);
    void fill_lane(ElementBlock& block, std::size_t lane, const ElementCluster& element) const;
    bool may_be_one_group(const ElementBlock& block, Range lanes) const;
    bool hangs_together(std::size_t block, Range lanes) const;
    void form_groups(std::size_t block, Range lanes);
    void find_group_neighbours();

    const Scene& scene_;
    const PackingRules& rules_;
    Vec3 scan_center_;
    std::vector<ElementResponse> responses_;  ///< per object
    std::vector<std::uint32_t> element_ids_;  ///< block * kSize + lane of every merged element
    ElementSet set_;
};

void ElementPacker::fill_lane(ElementBlock& block,
                              std::size_t lane,
                              const ElementCluster& merged) const {
    const SurfaceElement& element = merged.triangle;
    for (std::size_t i = 0; i < 3; ++i) {
        block.corners[i].set(lane, element.corners[i]);
        block.squared_edge[i][lane] =
            (element.corners[(i + 2) % 3] - element.corners[(i + 1) % 3]).squaredNorm();
    }
    block.normal.set(lane, merged.normal);
    const Vec3 center = element.center();
    block.center.set(lane, center);
    block.area_m2[lane] = merged.area_m2;
    block.rise_m[lane] = merged.rise_m;
    block.one_sided[lane] = rules_.visible_side[scene_.facet(element.facet).object];
    block.facet[lane] = element.facet;
    block.random_bits[lane] =
        static_cast<std::uint32_t>(core::Rng(0, element.number, /*sample=*/1).next_bits());
    block.mean_reflectance[lane] = 0.0;
    for (std::size_t node = 0; node < ElementBlock::kNodes; ++node) {
        const Vec3 position = node < 3   ? element.corners[node]
                              : node < 6 ? element.midpoint(node - 3)
                                         : center;
        const double fraction = node < 3   ? kFractionOfCorner
                                : node < 6 ? kFractionOfMiddle
                                           : kFractionOfCenter;
        const Bsdf bsdf = scene_.bsdf_at({position + set_.origin, element.facet});
        const double per = block.response.towards_source ? rules_.laser_spot_m2 : core::kPi;
        double albedo = albedo_of(bsdf);
        block.reflectance[node][lane] = albedo / per;
        if (block.response.glossy) {
            albedo = std::max(albedo, kSchlickMean);
            block.glossy_alpha[lane] = lobe_of(bsdf, 1.0)->alpha;
        }
        block.mean_reflectance[lane] += fraction * (albedo / per);
    }
}

std::size_t ElementPacker::num_blocks(const std::vector<ElementCluster>& elements) const {
    std::size_t sum = 0;
    for (const ElementResponse& response : kElementResponses) {
        const auto count = std::ranges::count_if(
            elements, [&](const auto& element) { return response_of(element) == response; });
        sum += (static_cast<std::size_t>(count) + ElementBlock::kSize - 1) / ElementBlock::kSize;
    }
    return sum;
}

void ElementPacker::append_blocks(const std::vector<ElementCluster>& elements,
                                  const ElementResponse& response) {
    std::vector<ElementCenter> sorted;
    for (std::size_t i = 0; i < elements.size(); ++i) {
        if (response_of(elements[i]) == response) {
            sorted.push_back({elements[i].triangle.center(), i});
        }
    }
    sort_into_blocks(sorted);
    for (std::size_t begin = 0; begin < sorted.size(); begin += ElementBlock::kSize) {
        ElementBlock& block = set_.blocks.emplace_back();
        block.response = response;
        block.count = std::min(ElementBlock::kSize, sorted.size() - begin);
        Eigen::AlignedBox3d box;
        for (std::size_t lane = 0; lane < ElementBlock::kSize; ++lane) {
            const std::size_t index = sorted[begin + (lane < block.count ? lane : 0)].element;
            fill_lane(block, lane, elements[index]);
            if (lane >= block.count) {
                block.area_m2[lane] = 0.0;
                continue;
            }
            element_ids_[index] =
                static_cast<std::uint32_t>((set_.blocks.size() - 1) * ElementBlock::kSize + lane);
            const auto& corners = elements[index].triangle.corners;
            for (std::size_t i = 0; i < 3; ++i) {
                box.extend(corners[i]);
                const double edge = (corners[(i + 1) % 3] - corners[i]).norm();
                block.longest_edge_m = std::max(block.longest_edge_m, edge);
            }
        }
        set_.spheres.push_back({box.center(), 0.5 * box.diagonal().norm()});
        find_simd_group_spheres(block);
    }
}

bool ElementPacker::may_be_one_group(const ElementBlock& block, Range lanes) const {
    Eigen::AlignedBox3d box;
    for (std::size_t i = lanes.begin; i < lanes.end; ++i) {
        if (std::abs(block.normal[i].dot(block.normal[lanes.begin])) < kMinGroupCosine)
            return false;
        if (scene_.facet(block.facet[i]).object != scene_.facet(block.facet[lanes.begin]).object) {
            return false;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            box.extend(block.corners[c][i]);
        }
    }
    const double distance = (box.center() - scan_center_).norm();
    return box.diagonal().norm() <= kGroupSizePerDistance * std::sqrt(rules_.tolerance) * distance;
}

// Whether elements of one block are connected. Of two separate sheets, one may hide the other.
bool ElementPacker::hangs_together(std::size_t block, Range lanes) const {
    const auto base = static_cast<std::uint32_t>(block * ElementBlock::kSize);
    std::vector<std::uint32_t> reached{base + static_cast<std::uint32_t>(lanes.begin)};
    std::array<bool, ElementBlock::kSize> seen{};
    seen[lanes.begin] = true;
    for (std::size_t next = 0; next < reached.size(); ++next) {
        for (const std::uint32_t neighbour : set_.element_neighbours.of(reached[next])) {
            const std::uint32_t lane = neighbour - base;  // wraps for earlier blocks
            if (lane < lanes.begin || lane >= lanes.end || seen[lane]) continue;
            seen[lane] = true;
            reached.push_back(neighbour);
        }
    }
    return reached.size() == lanes.end - lanes.begin;
}

// Splits lanes in halves, as sort_into_blocks() did, until each part may be one group.
void ElementPacker::form_groups(std::size_t block, Range lanes) {
    const std::size_t count = lanes.end - lanes.begin;
    const bool is_group =
        count == 1 || (may_be_one_group(set_.blocks[block], lanes) && hangs_together(block, lanes));
    if (is_group) {
        set_.groups.push_back(
            {static_cast<std::uint32_t>(block),
             (~std::uint64_t{0} >> (ElementBlock::kSize - count)) << lanes.begin});
        return;
    }
    const std::size_t middle = lanes.begin + (count + 1) / 2;
    form_groups(block, {lanes.begin, middle});
    form_groups(block, {middle, lanes.end});
}

void ElementPacker::find_group_neighbours() {
    std::vector<std::uint32_t> group_of(set_.blocks.size() * ElementBlock::kSize);
    for (std::uint32_t g = 0; g < set_.groups.size(); ++g) {
        const VisibilityGroup& group = set_.groups[g];
        for_each_bit(group.lanes, [&](std::size_t lane) {
            group_of[group.block * ElementBlock::kSize + lane] = g;
        });
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const std::uint32_t element : element_ids_) {
        for (const std::uint32_t neighbour : set_.element_neighbours.of(element)) {
            const std::uint32_t other = group_of[neighbour];
            if (group_of[element] < other) pairs.emplace_back(group_of[element], other);
        }
    }
    set_.group_neighbours = adjacency_lists(set_.groups.size(), pairs);
}

ElementSet ElementPacker::pack(std::vector<SurfaceElement> elements,
                               std::vector<std::uint32_t> clusters) {
    auto pairs = adjacent_elements(elements);
    ElementClusters merged = merge_elements(scene_, elements, clusters, pairs);
    elements = {};
    clusters = {};
    set_.num_elements = merged.elements.size();
    element_ids_.resize(set_.num_elements);
    set_.blocks.reserve(num_blocks(merged.elements));
    for (const ElementResponse& response : kElementResponses) {
        append_blocks(merged.elements, response);
    }
    merged.elements = {};
    for (auto& [a, b] : pairs) {
        a = element_ids_[merged.merged_of[a]];
        b = element_ids_[merged.merged_of[b]];
    }
    std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
    set_.element_neighbours = adjacency_lists(set_.blocks.size() * ElementBlock::kSize, pairs);
    for (std::size_t block = 0; block < set_.blocks.size(); ++block) {
        set_.first_group.push_back(static_cast<std::uint32_t>(set_.groups.size()));
        form_groups(block, {0, set_.blocks[block].count});
    }
    set_.first_group.push_back(static_cast<std::uint32_t>(set_.groups.size()));
    find_group_neighbours();
    return std::move(set_);
}

}  // namespace

ElementSet pack_elements(const Scene& scene,
                         const core::WallScan& scan,
                         const PackingRules& rules,
                         std::vector<SurfaceElement>&& elements,
                         std::vector<std::uint32_t>&& clusters) {
    return ElementPacker(scene, scan, rules).pack(std::move(elements), std::move(clusters));
}

}  // namespace renderer
