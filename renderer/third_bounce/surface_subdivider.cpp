// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/surface_subdivider.h"

#include "renderer/core/error.h"
#include "renderer/geometry/closed_surface.h"
#include "renderer/scene/coinciding_points.h"
#include "renderer/third_bounce/element_clusters.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

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

struct LongestEdge {
    std::size_t index = 0;
    double squared = 0.0;
};

// Of edges that are equal but for rounding the first: which one rounding makes longer would depend
// on where in the world a triangle is.
LongestEdge longest_edge(const SurfaceElement& element) {
    constexpr double kTie = 1e-9;
    LongestEdge longest;
    for (std::size_t i = 0; i < 3; ++i) {
        const double squared = (element.corners[(i + 1) % 3] - element.corners[i]).squaredNorm();
        if (squared > (1.0 + kTie) * longest.squared) longest = {i, squared};
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

[[noreturn]] void throw_too_many(std::size_t most) {
    throw core::Failure("third_bounce",
                        fmt::format("needs more than {:g} million elements of surface",
                                    1e-6 * static_cast<double>(most)));
}

// Squared width of the BSDF's lobe relative to a cosine's.
double lobe_scale(const Material& material) {
    const auto lobe = lobe_of(make_bsdf(material), 1.0);
    return lobe ? std::min(1.0, 4.0 * lobe->alpha * lobe->alpha) : 1.0;
}

}  // namespace

SurfaceSubdivider::SurfaceSubdivider(const Scene& scene,
                                     const core::WallScan& scan,
                                     const core::TimeAxis& axis,
                                     double laser_spot_m2,
                                     const CutLimits& limits)
    : scene_(scene),
      scan_(scan),
      axis_(axis),
      laser_spot_m2_(laser_spot_m2),
      limits_(limits),
      origin_(scene.rays().origin()),
      returns_light_(CoincidingPoints(scan).any()),
      boxes_(scan, origin_, scene.stated_rounding_m()),
      visible_sides_(visible_sides(scene.objects(), scan.path_ends())) {}

bool SurfaceSubdivider::is_small_enough(const SegmentBounds& segments,
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
    const double light = segments.light.min_m;
    const double sensor = segments.sensor.min_m;
    if (holds(light, sensor)) return true;
    if (!holds(light + boxes_.slack_m(), sensor + boxes_.slack_m())) return false;
    const auto [exact_light, exact_sensor] =
        boxes_.nearest_light_and_sensor_m(center, reach_of(squared_edge));
    return holds(exact_light, exact_sensor);
}

bool SurfaceSubdivider::are_within_axis(const SegmentBounds& segments) const {
    return segments.light.min_m + segments.sensor.min_m >=
               axis_.opl_start_m - boxes_.device_segments().max_m &&
           segments.light.max_m + segments.sensor.max_m <=
               axis_.opl_end_m() - boxes_.device_segments().min_m;
}

double SurfaceSubdivider::least_parts(const SurfaceElement& element,
                                      const SegmentBounds& segments,
                                      double tolerance) const {
    const bool is_whole = boxes_.common_plane() && are_within_axis(segments);
    if (!is_whole) return 0.0;
    const double light = segments.light.max_m;
    const double sensor = segments.sensor.max_m;
    const double nearest = std::min(light, sensor);
    const double by_size =
        std::min(kSquaredSizePerTolerance * tolerance, kMaxSquaredSize) * nearest * nearest;
    const double by_kappa =
        kKappaPerTolerance * tolerance * 8.0 * axis_.bin_width_m / (1.0 / light + 1.0 / sensor);
    const double largest_area = std::sqrt(3.0) / 4.0 * std::min(by_size, by_kappa);
    const auto& [a, b, c] = element.corners;
    return core::triangle_area_vector(a, b, c).norm() / largest_area;
}

// Leaves no parts where the facet adds nothing.
void SurfaceSubdivider::begin_facet(Cutting& cutting) const {
    const std::uint32_t i = cutting.next_facet++;
    const Object& object = scene_.object_of(i);
    const Material& material = object.material;
    const auto response = element_response(make_bsdf(material));
    if (!scene_.is_hidden(i) || !response || !reflects(material)) return;
    if (response->towards_source && !returns_light_) return;
    SurfaceElement whole;
    whole.facet = i;
    const auto& triangle = object.mesh.triangles[scene_.facet(i).triangle];
    for (std::size_t c = 0; c < 3; ++c) {
        whole.corners[c] = object.mesh.vertices[triangle[c]] - origin_;
    }
    cutting.facet_tolerance = cutting.tolerance * lobe_scale(material);
    if (!boxes_.common_plane()) {
        cutting.parts.push_back({whole, 0});
        return;
    }
    const std::vector<SurfaceElement> in_front = clip(whole, *boxes_.common_plane());
    for (auto part = in_front.rbegin(); part != in_front.rend(); ++part) {
        cutting.parts.push_back({*part, 0});
    }
}

// Appends the next element; false: there is none.
bool SurfaceSubdivider::cut_next(Cutting& cutting, std::vector<SurfaceElement>& elements) const {
    const double begin = axis_.opl_start_m - boxes_.device_segments().max_m;
    const double end = axis_.opl_end_m() - boxes_.device_segments().min_m;
    const auto most = static_cast<double>(limits_.in_all);
    for (;;) {
        if (cutting.parts.empty()) {
            if (cutting.next_facet == scene_.facets().size()) return false;
            begin_facet(cutting);
            continue;
        }
        const auto [element, depth] = cutting.parts.back();
        cutting.parts.pop_back();
        const LongestEdge longest = longest_edge(element);
        const Vec3 center = element.center();
        const double reach = reach_of(longest.squared);
        const SegmentBounds segments = boxes_.segments(center, reach);
        if (segments.light.max_m + segments.sensor.max_m < begin) continue;
        if (segments.light.min_m + segments.sensor.min_m > end) continue;
        if (boxes_.is_behind(center, reach)) continue;
        const double tolerance = cutting.facet_tolerance;
        if (depth == kMaxBisections ||
            is_small_enough(segments, center, longest.squared, tolerance)) {
            const auto& [a, b, c] = element.corners;
            if (!(core::triangle_area_vector(a, b, c).squaredNorm() > 0.0)) continue;
            if (cutting.num_elements == limits_.in_all) throw_too_many(limits_.in_all);
            elements.push_back(element);
            elements.back().number = cutting.num_elements++;
            return true;
        }
        if (cutting.num_elements + least_parts(element, segments, tolerance) > most) {
            throw_too_many(limits_.in_all);
        }
        const std::size_t i = longest.index;
        SurfaceElement first = element;
        SurfaceElement second = element;
        first.corners[(i + 1) % 3] = second.corners[i] = element.midpoint(i);
        cutting.parts.push_back({second, depth + 1});
        cutting.parts.push_back({first, depth + 1});
    }
}

// A cut has at least this many elements; far fewer than it has, but known at once.
double SurfaceSubdivider::least_elements(double tolerance) const {
    Cutting cutting{tolerance};
    double sum = 0.0;
    while (cutting.next_facet < scene_.facets().size()) {
        begin_facet(cutting);
        for (const auto& [triangle, depth] : cutting.parts) {
            const double reach = reach_of(longest_edge(triangle).squared);
            sum += least_parts(
                triangle, boxes_.segments(triangle.center(), reach), cutting.facet_tolerance);
        }
        cutting.parts.clear();
    }
    return sum;
}

// Counts all elements before any work where there is more than one batch.
void SurfaceSubdivider::cut_batches(
    double tolerance, const std::function<bool(Batch& batch, std::size_t num_all)>& work) const {
    const std::size_t most = std::max(limits_.in_a_batch, scene_.facets().size());
    Cutting cutting{tolerance};
    std::optional<std::size_t> num_all;
    bool is_more = true;
    while (is_more) {
        Batch batch;
        while (batch.size() < most && is_more) is_more = cut_next(cutting, batch);
        if (batch.empty() && num_all) return;
        if (!num_all) {
            if (is_more && least_elements(tolerance) > static_cast<double>(limits_.in_all)) {
                throw_too_many(limits_.in_all);
            }
            Cutting ahead = cutting;
            Batch counted;
            while (is_more && cut_next(ahead, counted)) counted.clear();
            num_all = ahead.num_elements;
        }
        if (!work(batch, *num_all)) return;
    }
}

// Numbers of clusters of elements that may be merged.
std::vector<std::uint32_t> SurfaceSubdivider::cluster(std::span<const SurfaceElement> elements,
                                                      double tolerance) const {
    const double max_bins =
        std::sqrt(std::min(kSquaredBinsPerTolerance * tolerance, kMaxSquaredBins));
    const double max_tilt = std::min(kSquaredTiltPerTolerance * tolerance, kMaxSquaredTilt);
    return cluster_elements(scene_,
                            elements,
                            {max_bins * axis_.bin_width_m, max_tilt},
                            [&](const Vec3& center, double diameter_m) {
                                return is_small_enough(boxes_.segments(center, 0.5 * diameter_m),
                                                       center,
                                                       diameter_m * diameter_m,
                                                       tolerance);
                            });
}

void SurfaceSubdivider::cut(double tolerance,
                            const std::function<bool(ElementSet&& batch)>& work) const {
    const PackingRules rules{tolerance, laser_spot_m2_, visible_sides_};
    cut_batches(tolerance, [&](Batch& elements, std::size_t num_all) {
        const std::uint32_t first_number = elements.empty() ? 0 : elements[0].number;
        const double fraction =
            num_all > 0 ? static_cast<double>(elements.size()) / static_cast<double>(num_all) : 1.0;
        std::vector<std::uint32_t> clusters = cluster(elements, tolerance);
        ElementSet set =
            pack_elements(scene_, scan_, rules, std::move(elements), std::move(clusters));
        set.first_number = first_number;
        set.fraction = fraction;
        return work(std::move(set));
    });
}

std::size_t SurfaceSubdivider::min_elements(double tolerance) const {
    std::size_t sum = 0;
    cut_batches(tolerance, [&](const Batch& elements, std::size_t) {
        const std::vector<std::uint32_t> clusters = cluster(elements, tolerance);
        if (!clusters.empty()) sum += 1 + *std::max_element(clusters.begin(), clusters.end());
        return true;
    });
    return sum;
}

}  // namespace renderer
