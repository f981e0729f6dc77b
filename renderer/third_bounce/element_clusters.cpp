// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/element_clusters.h"

#include "renderer/core/random.h"
#include "renderer/geometry/median_split.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace renderer {
namespace {

using core::Vec3;

Vec3 area_vector(const SurfaceElement& element) {
    return core::triangle_area_vector(element.corners[0], element.corners[1], element.corners[2]);
}

// Finds clusters from the top down.
class Clusterer {
 public:
    Clusterer(const Scene& scene,
              std::span<const SurfaceElement> elements,
              const ClusterLimits& limits,
              const std::function<bool(const Vec3& center, double diameter_m)>& may_be_merged)
        : scene_(scene),
          elements_(elements),
          limits_(limits),
          may_be_merged_(may_be_merged),
          clusters_(elements.size()) {
        for (std::uint32_t i = 0; i < elements.size(); ++i)
            items_.push_back({elements[i].center(), i});
    }

    std::vector<std::uint32_t> run() {
        const auto object_of = [&](const Item& item) {
            return scene_.facet(elements_[item.element].facet).object;
        };
        for (auto begin = items_.begin(); begin != items_.end();) {
            const std::uint32_t object = object_of(*begin);
            const auto end = std::find_if(
                begin, items_.end(), [&](const Item& item) { return object_of(item) != object; });
            const Object& common = scene_.object_of(elements_[begin->element].facet);
            const bool is_uniform =
                common.has_one_albedo() && !element_response(make_bsdf(common.material))->glossy;
            if (is_uniform) {
                split({begin, end});
            } else {
                for (auto item = begin; item != end; ++item) make_cluster({item, 1});
            }
            begin = end;
        }
        return std::move(clusters_);
    }

 private:
    struct Item {
        Vec3 center;
        std::uint32_t element;
    };

    void make_cluster(std::span<const Item> items) {
        for (const Item& item : items) clusters_[item.element] = num_clusters_;
        ++num_clusters_;
    }

    void split(std::span<Item> items) {
        Eigen::AlignedBox3d centers;
        for (const Item& item : items) centers.extend(item.center);
        if (items.size() == 1 || is_cluster(items, centers)) return make_cluster(items);
        const std::size_t half = items.size() / 2;
        split_along_longest_side(
            items, half, centers, [](const Item& item) -> const Vec3& { return item.center; });
        split(items.first(half));
        split(items.subspan(half));
    }

    bool is_cluster(std::span<const Item> items, const Eigen::AlignedBox3d& centers) const {
        if (centers.diagonal().norm() > limits_.diameter_m) return false;
        Eigen::AlignedBox3d corners;
        for (const Item& item : items) {
            for (const Vec3& corner : elements_[item.element].corners) corners.extend(corner);
        }
        const double diameter = corners.diagonal().norm();
        if (diameter > limits_.diameter_m) return false;
        Vec3 normals = Vec3::Zero();
        double area = 0.0;
        for (const Item& item : items) {
            const SurfaceElement& element = elements_[item.element];
            const double element_area = area_vector(element).norm();
            normals += element_area * scene_.facet(element.facet).normal;
            area += element_area;
        }
        const double squared_tilt = 1.0 - normals.squaredNorm() / (area * area);
        return squared_tilt <= limits_.squared_tilt && may_be_merged_(corners.center(), diameter);
    }

    const Scene& scene_;
    std::span<const SurfaceElement> elements_;
    ClusterLimits limits_;
    const std::function<bool(const Vec3& center, double diameter_m)>& may_be_merged_;
    std::vector<Item> items_;
    std::vector<std::uint32_t> clusters_;
    std::uint32_t num_clusters_ = 0;
};

// A disjoint-set forest of connected elements; a set is named by its root.
class DisjointSets {
 public:
    explicit DisjointSets(std::size_t size) : parent_(size) {
        std::iota(parent_.begin(), parent_.end(), 0U);
    }

    std::uint32_t find(std::uint32_t item) {
        while (parent_[item] != item) item = parent_[item] = parent_[parent_[item]];
        return item;
    }

    void unite(std::uint32_t a, std::uint32_t b) { parent_[find(a)] = find(b); }

 private:
    std::vector<std::uint32_t> parent_;
};

// The triangle with the area, centroid and second moments of several.
//
// The second moments of a triangle about its centroid are a twelfth of the sum of v v^T over its
// corners v. For v = sqrt(8) L e with three unit vectors e 120 degrees apart, whose e e^T sum up to
// 3/2, that is L L^T. A function's mean over the triangle is then that over the elements, up to
// quadratic terms.
ElementCluster merged(const Scene& scene,
                      std::span<const SurfaceElement> elements,
                      std::span<const std::uint32_t> members) {
    ElementCluster result;
    result.triangle.facet = elements[members[0]].facet;
    result.triangle.number = elements[members[0]].number;
    Vec3 center = Vec3::Zero();
    Vec3 normals = Vec3::Zero();
    for (const std::uint32_t i : members) {
        const double area = area_vector(elements[i]).norm();
        center += area * elements[i].center();
        normals += area * scene.facet(elements[i].facet).normal;
        result.area_m2 += area;
    }
    center /= result.area_m2;
    result.normal = normals.normalized();
    const SurfaceElement& first = elements[members[0]];
    const core::Mat3 frame =
        core::frame_from_normal(result.normal, first.corners[1] - first.corners[0]);
    Eigen::Matrix2d moments = Eigen::Matrix2d::Zero();
    for (const std::uint32_t i : members) {
        const Vec3 offset = frame.transpose() * (elements[i].center() - center);
        Eigen::Matrix2d of_element = offset.head<2>() * offset.head<2>().transpose();
        for (const Vec3& corner : elements[i].corners) {
            const Vec3 arm = frame.transpose() * (corner - elements[i].center());
            of_element += arm.head<2>() * arm.head<2>().transpose() / 12.0;
            result.rise_m = std::max(result.rise_m, std::abs(offset.z() + arm.z()));
        }
        moments += area_vector(elements[i]).norm() / result.area_m2 * of_element;
    }
    // moments = L L^T
    const double l00 = std::sqrt(moments(0, 0));
    const double l10 = moments(1, 0) / l00;
    const double l11 = std::sqrt(std::max(0.0, moments(1, 1) - l10 * l10));
    for (std::size_t c = 0; c < 3; ++c) {
        const double angle = 2.0 * core::kPi / 3.0 * static_cast<double>(c);
        const double x = std::sqrt(8.0) * std::cos(angle);
        const double y = std::sqrt(8.0) * std::sin(angle);
        result.triangle.corners[c] =
            center + l00 * x * frame.col(0) + (l10 * x + l11 * y) * frame.col(1);
    }
    return result;
}

ElementCluster alone(const Scene& scene, const SurfaceElement& element) {
    return {element, scene.facet(element.facet).normal, area_vector(element).norm(), 0.0};
}

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

std::vector<std::uint32_t> cluster_elements(
    const Scene& scene,
    std::span<const SurfaceElement> elements,
    const ClusterLimits& limits,
    const std::function<bool(const Vec3& center, double diameter_m)>& may_be_merged) {
    return Clusterer(scene, elements, limits, may_be_merged).run();
}

ElementClusters merge_elements(const Scene& scene,
                               std::span<const SurfaceElement> elements,
                               std::span<const std::uint32_t> clusters,
                               std::span<const std::pair<std::uint32_t, std::uint32_t>> touching) {
    const auto count = static_cast<std::uint32_t>(elements.size());
    DisjointSets sets(count);
    for (const auto& [a, b] : touching) {
        if (clusters[a] == clusters[b]) sets.unite(a, b);
    }
    // Counting sort by set.
    std::vector<std::uint32_t> end(count, 0);
    for (std::uint32_t i = 0; i < count; ++i) ++end[sets.find(i)];
    std::exclusive_scan(end.begin(), end.end(), end.begin(), 0U);
    const std::vector<std::uint32_t> begin = end;
    std::vector<std::uint32_t> sorted(count);
    for (std::uint32_t i = 0; i < count; ++i) sorted[end[sets.find(i)]++] = i;

    ElementClusters result;
    result.merged_of.resize(count);
    std::size_t num_sets = 0;
    for (std::uint32_t root = 0; root < count; ++root) num_sets += end[root] > begin[root];
    result.elements.reserve(num_sets);
    for (std::uint32_t root = 0; root < count; ++root) {
        const auto members = std::span(sorted).subspan(begin[root], end[root] - begin[root]);
        if (members.empty()) continue;
        for (const std::uint32_t i : members) {
            result.merged_of[i] = static_cast<std::uint32_t>(result.elements.size());
        }
        result.elements.push_back(members.size() > 1 ? merged(scene, elements, members)
                                                     : alone(scene, elements[root]));
    }
    return result;
}

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
