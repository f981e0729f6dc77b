// SPDX-License-Identifier: MIT
#include "calib/adjoint/pair_evaluator.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

// Smaller parts of an element are rounding.
constexpr double kSmallestFraction = 1e-14;

// Calls visit(i, barycentrics) for the triangles (0, i, i + 1) of a convex polygon.
template <class Visit>
void for_each_part(std::span<const PolygonVertex> polygon, const Visit& visit) {
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const PartBarycentrics barycentrics{
            polygon[0].barycentric, polygon[i].barycentric, polygon[i + 1].barycentric};
        if (barycentrics[0].dot(barycentrics[1].cross(barycentrics[2])) > kSmallestFraction)
            visit(i, barycentrics);
    }
}

}  // namespace

PairEvaluator::PairEvaluator(const AdjointScene& scene)
    : scene_(scene), views_(2, OccluderViews(scene.mesh, scene.tree)), kernel_(light_) {
    light_.axis = scene.axis;
    light_.sigma_m = scene.sigma_m;
    light_.radiance_factor = scene.radiance_factor;
}

void PairEvaluator::look_at(std::size_t pair) {
    const core::WallScan& scan = scene_.scan;
    const std::size_t sensor = scan.sensing_index(pair);
    const std::size_t light = scan.illumination_index(pair);
    light_.ends[1].position = scan.sensing.positions[sensor];
    light_.ends[1].normal = scan.sensing.normals[sensor];
    light_.is_confocal = scan.pattern == core::ScanPattern::Confocal;
    light_.ends[0].position =
        light_.is_confocal ? light_.ends[1].position : scan.illumination.positions[light];
    light_.ends[0].normal =
        light_.is_confocal ? light_.ends[1].normal : scan.illumination.normals[light];
    light_.device_segments_m = scan.device_segments_m(pair);
    num_ends_ = light_.is_confocal ? 1 : 2;
    for (std::size_t end = 0; end < num_ends_; ++end) {
        views_[end].look_from(light_.ends[end], static_cast<std::uint8_t>(end));
    }
}

// Whether any path by way of the element may have its length within the axis.
bool PairEvaluator::may_be_on_axis(const MeshElement& element) const {
    constexpr double kReach = 7.0;  // of the response, in standard deviations
    const auto& c = element.shape.corners;
    const Vec3 center = (c[0] + c[1] + c[2]) / 3.0;
    const double middle = light_.device_segments_m + (center - light_.ends[0].position).norm() +
                          (center - light_.ends[1].position).norm();
    const double reach = 3.0 * element.radius_m + kReach * light_.sigma_m;
    return middle + reach > light_.axis.opl_start_m && middle - reach < light_.axis.opl_end_m();
}

// How the ends see an element; false where they do not look at the same side of it.
bool PairEvaluator::find_views(const MeshElement& element) {
    for (std::size_t end = 0; end < num_ends_; ++end) {
        seen_[end] = views_[end].view(element.shape);
        if (std::abs(seen_[end].facing_m) <= seen_[end].margin_m) return false;
    }
    return num_ends_ == 1 || seen_[0].facing_m * seen_[1].facing_m > 0.0;
}

// Cuts an element into its visible polygons; false when there are none.
//
// index   among the elements that the views look at
bool PairEvaluator::cut(const MeshElement& element, std::size_t index) {
    if (!may_be_on_axis(element) || !find_views(element)) return false;
    clipper_.start(std::max(seen_[0].margin_m, seen_[num_ends_ - 1].margin_m));
    for (std::size_t end = 0; end < num_ends_; ++end) {
        CutLine tangent;
        tangent.plane = CutPlane::WallTangent;
        tangent.end = static_cast<std::uint8_t>(end);
        for (Eigen::Index i = 0; i < 3; ++i) {
            tangent.height_m[i] =
                light_.ends[end].normal.dot(seen_[end].corners[static_cast<std::size_t>(i)]);
        }
        if (tangent.height_m.maxCoeff() <= 0.0) return false;
        if (tangent.height_m.minCoeff() < 0.0) clipper_.keep_above(tangent);
    }
    for (std::size_t end = 0; end < num_ends_ && !clipper_.empty(); ++end) {
        views_[end].remove_shadows(index, seen_[end], clipper_);
    }
    return !clipper_.empty();
}

// Calls visit(i) for each element that is seen, once it is cut.
//
// known   per element, or empty
template <class Visit>
void PairEvaluator::for_each_visible(std::span<const ElementVisibility> known, const Visit& visit) {
    constexpr std::size_t kTogether = 8;
    const std::span<const MeshElement> elements = scene_.elements;
    const auto knowledge = [&](std::size_t i) {
        return known.empty() ? ElementVisibility::Unknown : known[i];
    };
    for (std::size_t begin = 0; begin < elements.size(); begin += kTogether) {
        const std::size_t count = std::min(kTogether, elements.size() - begin);
        bool has_looked = false;
        for (std::size_t i = 0; i < count; ++i) {
            const ElementVisibility seen = knowledge(begin + i);
            if (seen == ElementVisibility::Hidden) continue;
            if (seen == ElementVisibility::Whole) {
                clipper_.start(0.0);
                visit(begin + i);
                continue;
            }
            for (std::size_t end = 0; end < num_ends_ && !has_looked; ++end) {
                views_[end].look_at(elements.subspan(begin, count));
            }
            has_looked = true;
            if (cut(elements[begin + i], i)) visit(begin + i);
        }
    }
}

void PairEvaluator::add(std::size_t pair,
                        std::span<double> histogram,
                        std::span<ElementVisibility> seen) {
    look_at(pair);
    std::fill(seen.begin(), seen.end(), ElementVisibility::Hidden);
    for_each_visible({}, [&](std::size_t index) {
        if (!seen.empty()) {
            seen[index] = clipper_.is_whole() ? ElementVisibility::Whole : ElementVisibility::Part;
        }
        const MeshElement& element = scene_.elements[index];
        const double albedo = scene_.albedo[element.facet];
        for (std::size_t i = 0; i < clipper_.num_polygons(); ++i) {
            for_each_part(clipper_.polygon(i),
                          [&](std::size_t, const PartBarycentrics& barycentrics) {
                              kernel_.add(element.shape, barycentrics, albedo, histogram);
                          });
        }
    });
}

void PairEvaluator::pull(std::size_t pair,
                         std::span<const double> by_value,
                         std::span<const ElementVisibility> seen,
                         MeshGradients& gradients) {
    look_at(pair);
    for_each_visible(seen, [&](std::size_t index) {
        pull_element(scene_.elements[index], by_value, gradients);
    });
}

void PairEvaluator::pull_element(const MeshElement& element,
                                 std::span<const double> by_value,
                                 MeshGradients& gradients) {
    const double albedo = scene_.albedo[element.facet];
    ShapeGradients by_shape;
    PartBarycentrics by_part;
    cuts_.start(clipper_.lines());
    for (std::size_t i = 0; i < clipper_.num_polygons(); ++i) {
        const auto polygon = clipper_.polygon(i);
        by_barycentrics_.assign(polygon.size(), Vec3::Zero());
        for_each_part(polygon, [&](std::size_t k, const PartBarycentrics& barycentrics) {
            gradients.albedo[element.facet] +=
                kernel_.pull(element.shape, barycentrics, albedo, by_value, by_shape, by_part);
            by_barycentrics_[0] += by_part[0];
            by_barycentrics_[k] += by_part[1];
            by_barycentrics_[k + 1] += by_part[2];
        });
        cuts_.add_polygon(polygon, by_barycentrics_);
    }
    std::array<Vec3, 3> by_corners = by_shape.by_corners(element.shape);
    cuts_.finish(
        light_.ends, element.shape.corners, scene_.mesh.vertices, by_corners, gradients.vertices);
    const auto& triangle = scene_.mesh.triangles[element.facet];
    for (std::size_t j = 0; j < 3; ++j) {
        for (Eigen::Index i = 0; i < 3; ++i) {
            gradients.vertices[triangle[static_cast<std::size_t>(i)]] +=
                element.barycentric[j][i] * by_corners[j];
        }
    }
}

std::vector<double> PairEvaluator::visible_areas(std::size_t pair) {
    look_at(pair);
    std::vector<double> areas(scene_.mesh.triangles.size(), 0.0);
    for_each_visible({}, [&](std::size_t index) {
        const MeshElement& element = scene_.elements[index];
        for (std::size_t i = 0; i < clipper_.num_polygons(); ++i) {
            for_each_part(clipper_.polygon(i), [&](std::size_t, const PartBarycentrics& s) {
                areas[element.facet] += element.shape.area_m2 * s[0].dot(s[1].cross(s[2]));
            });
        }
    });
    return areas;
}

}  // namespace calib
