// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/surface_subdivider.h"

#include "renderer/core/error.h"
#include "renderer/geometry/closed_surface.h"
#include "renderer/scene/coinciding_points.h"
#include "renderer/third_bounce/element_clusters.h"
#include "renderer/third_bounce/element_packer.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

// With kappa = h^2/(8 d w_r), h the longest edge, d the distance and w_r half a bin in range, the
// relative error of a histogram is at most 0.02 kappa for one facet and 0.005 kappa for scenes
// [measured]; weights, linear over an element, err with (h/d)^2.
constexpr double kKappaPerTolerance = 80.0;
constexpr double kSquaredSizePerTolerance = 3.0;
// Keeps the error of the energy below a few 1e-5 at any level.
constexpr double kMaxSquaredSize = 0.05;

// Facets are merged up to this size, squared, in bins: histograms of merged ones err by about 0.001
// times it [measured]. Their weights err with the mean square of the normals' tilts, ...
constexpr double kSquaredBinsPerTolerance = 200.0;
constexpr double kSquaredTiltPerTolerance = 0.3;
// ... and however coarse, a merged triangle has a clear normal and few bins.
constexpr double kMaxSquaredBins = 16.0;
constexpr double kMaxSquaredTilt = 0.03;

// Most bisections of a facet, even where it touches a wall point.
constexpr int kMaxBisections = 28;
constexpr std::size_t kMaxElements = 8'000'000;

struct LongestEdge {
    std::size_t index = 0;
    double squared = 0.0;
};

LongestEdge longest_edge(const SurfaceElement& element) {
    LongestEdge longest;
    for (std::size_t i = 0; i < 3; ++i) {
        const double squared = (element.corners[(i + 1) % 3] - element.corners[i]).squaredNorm();
        if (squared > longest.squared) longest = {i, squared};
    }
    return longest;
}

// All of a triangle lies within this distance from its centroid: two thirds of its longest median.
double reach_of(double squared_edge) {
    return std::sqrt(squared_edge) * 2.0 / 3.0;
}

// The part of a triangle in front of a plane, as up to two triangles. Cuts are computed from the
// lower to the upper corner, so that neighbouring facets share them exactly.
std::vector<SurfaceElement> clip(const SurfaceElement& element,
                                 const std::pair<Vec3, double>& plane) {
    std::vector<Vec3> polygon;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& a = element.corners[i];
        const Vec3& b = element.corners[(i + 1) % 3];
        const double height_a = plane.first.dot(a) - plane.second;
        const double height_b = plane.first.dot(b) - plane.second;
        if (height_a >= 0.0) polygon.push_back(a);
        if (height_a * height_b >= 0.0) continue;
        const bool a_lower = height_a < height_b;
        const double low = a_lower ? height_a : height_b;
        const double high = a_lower ? height_b : height_a;
        const Vec3& from = a_lower ? a : b;
        const Vec3& to = a_lower ? b : a;
        polygon.push_back(from + (low / (low - high)) * (to - from));
    }
    std::vector<SurfaceElement> parts;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        parts.push_back({{polygon[0], polygon[i - 1], polygon[i]}, element.facet});
    }
    return parts;
}

[[noreturn]] void throw_too_many() {
    throw core::Failure("third_bounce", "needs more than 8 million elements of surface");
}

// Squared width of the BSDF's lobe relative to a cosine's.
double lobe_scale(const Material& material) {
    if (material.model != SurfaceModel::Ggx) return 1.0;
    const double alpha = material.roughness * material.roughness;
    return std::min(1.0, 4.0 * alpha * alpha);
}

}  // namespace

SurfaceSubdivider::SurfaceSubdivider(const Scene& scene,
                                     const core::Scan& scan,
                                     const core::TimeAxis& axis,
                                     double laser_spot_m2)
    : scene_(scene),
      scan_(scan),
      axis_(axis),
      laser_spot_m2_(laser_spot_m2),
      origin_(scene.rays().origin()),
      returns_light_(CoincidingPoints(scan).any()),
      boxes_(scan, origin_) {
    for (const Object& object : scene.objects()) {
        visible_sides_.push_back(visible_side(object, scan));
    }
}

bool SurfaceSubdivider::is_small_enough(const LegBounds& legs,
                                        const Vec3& center,
                                        double squared_edge,
                                        double tolerance) const {
    const double relative = std::min(kSquaredSizePerTolerance * tolerance, kMaxSquaredSize);
    const auto holds = [&](double light, double sensor) {
        const double nearest = std::min(light, sensor);
        if (squared_edge > relative * nearest * nearest) return false;
        const double kappa =
            squared_edge * (1.0 / light + 1.0 / sensor) / (8.0 * axis_.bin_width_m);
        return kappa <= kKappaPerTolerance * tolerance;
    };
    const double light = legs.light.min_m;
    const double sensor = legs.sensor.min_m;
    if (holds(light, sensor)) return true;
    if (!holds(light + boxes_.slack_m(), sensor + boxes_.slack_m())) return false;
    const auto [exact_light, exact_sensor] =
        boxes_.nearest_light_and_sensor_m(center, reach_of(squared_edge));
    return holds(exact_light, exact_sensor);
}

double SurfaceSubdivider::least_parts(const SurfaceElement& element,
                                      const LegBounds& legs,
                                      double tolerance) const {
    const double light = legs.light.max_m;
    const double sensor = legs.sensor.max_m;
    const double nearest = std::min(light, sensor);
    const double by_size =
        std::min(kSquaredSizePerTolerance * tolerance, kMaxSquaredSize) * nearest * nearest;
    const double by_kappa =
        kKappaPerTolerance * tolerance * 8.0 * axis_.bin_width_m / (1.0 / light + 1.0 / sensor);
    const double largest_area = std::sqrt(3.0) / 4.0 * std::min(by_size, by_kappa);
    const auto& [a, b, c] = element.corners;
    return core::triangle_area_vector(a, b, c).norm() / largest_area;
}

void SurfaceSubdivider::bisect(const SurfaceElement& facet,
                               double tolerance,
                               std::vector<SurfaceElement>& elements) const {
    const double begin = axis_.opl_start_m - boxes_.device_legs().max_m;
    const double end = axis_.opl_end_m() - boxes_.device_legs().min_m;
    std::vector<std::pair<SurfaceElement, int>> stack{{facet, 0}};
    while (!stack.empty()) {
        const auto [element, depth] = stack.back();
        stack.pop_back();
        const LongestEdge longest = longest_edge(element);
        const Vec3 center = element.center();
        const double reach = reach_of(longest.squared);
        const LegBounds legs = boxes_.legs(center, reach);
        if (legs.light.max_m + legs.sensor.max_m < begin) continue;
        if (legs.light.min_m + legs.sensor.min_m > end) continue;
        if (boxes_.is_behind(center, reach)) continue;
        if (depth == kMaxBisections || is_small_enough(legs, center, longest.squared, tolerance)) {
            elements.push_back(element);
            if (elements.size() > kMaxElements) throw_too_many();
            continue;
        }
        const bool is_whole =  // none of its parts will be left out
            boxes_.common_plane() && legs.light.min_m + legs.sensor.min_m >= begin &&
            legs.light.max_m + legs.sensor.max_m <= end;
        if (is_whole && least_parts(element, legs, tolerance) > double{kMaxElements})
            throw_too_many();
        const std::size_t i = longest.index;
        SurfaceElement first = element;
        SurfaceElement second = element;
        first.corners[(i + 1) % 3] = second.corners[i] = element.midpoint(i);
        stack.emplace_back(second, depth + 1);
        stack.emplace_back(first, depth + 1);
    }
}

std::vector<SurfaceElement> SurfaceSubdivider::cut_all(double tolerance) const {
    std::vector<SurfaceElement> elements;
    for (std::uint32_t i = 0; i < scene_.facets().size(); ++i) {
        const Object& object = scene_.object_of(i);
        const Material& material = object.material;
        if (!scene_.is_hidden(i) || !is_integrable(material) || material.albedo == 0.0) continue;
        if (kind_of(material) == ElementKind::Retroreflective && !returns_light_) continue;
        SurfaceElement whole;
        whole.facet = i;
        const auto& triangle = object.mesh.triangles[scene_.facet(i).triangle];
        for (std::size_t c = 0; c < 3; ++c) {
            whole.corners[c] = object.mesh.vertices[triangle[c]] - origin_;
        }
        const double facet_tolerance = tolerance * lobe_scale(material);
        if (!boxes_.common_plane()) {
            bisect(whole, facet_tolerance, elements);
            continue;
        }
        for (const SurfaceElement& part : clip(whole, *boxes_.common_plane())) {
            bisect(part, facet_tolerance, elements);
        }
    }
    std::erase_if(elements, [](const SurfaceElement& element) {
        const auto& [a, b, c] = element.corners;
        return !(core::triangle_area_vector(a, b, c).squaredNorm() > 0.0);
    });
    for (std::uint32_t i = 0; i < elements.size(); ++i) elements[i].number = i;
    return elements;
}

// Numbers of clusters of elements that may be merged.
std::vector<std::uint32_t> SurfaceSubdivider::cluster(std::span<const SurfaceElement> elements,
                                                      double tolerance) const {
    const double max_bins =
        std::sqrt(std::min(kSquaredBinsPerTolerance * tolerance, kMaxSquaredBins));
    const double max_tilt = std::min(kSquaredTiltPerTolerance * tolerance, kMaxSquaredTilt);
    return cluster_elements(
        scene_,
        elements,
        {max_bins * axis_.bin_width_m, max_tilt},
        [&](const Vec3& center, double diameter_m) {
            return is_small_enough(
                boxes_.legs(center, 0.5 * diameter_m), center, diameter_m * diameter_m, tolerance);
        });
}

ElementSet SurfaceSubdivider::cut(double tolerance) const {
    std::vector<SurfaceElement> elements = cut_all(tolerance);
    std::vector<std::uint32_t> clusters = cluster(elements, tolerance);
    return pack_elements(
        scene_, scan_, {tolerance, laser_spot_m2_, visible_sides_}, elements, clusters);
}

std::size_t SurfaceSubdivider::min_elements(double tolerance) const {
    const std::vector<std::uint32_t> clusters = cluster(cut_all(tolerance), tolerance);
    return clusters.empty() ? 0 : 1 + *std::max_element(clusters.begin(), clusters.end());
}

}  // namespace renderer
