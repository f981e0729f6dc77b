// SPDX-License-Identifier: MIT
#include "renderer/third_bounce_pieces.h"

#include "renderer/closed_surface.h"
#include "renderer/core/error.h"
#include "renderer/third_bounce_blocks.h"
#include "renderer/wall_boxes.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

// GGX lobes narrower than this are left to Monte Carlo.
constexpr double kSmallestGlossyAlpha = 0.03;

// With kappa = h^2/(8 d w_r), h the longest edge, d the distance and w_r half a bin in range, the
// relative error of a histogram is at most 0.1 kappa [measured]; weights behave likewise in h/d.
constexpr double kKappaPerTolerance = 10.0;
constexpr double kSquaredSizePerTolerance = 6.0;

// A facet is bisected at most this often, even where it touches a wall point.
constexpr int kMostBisections = 28;
constexpr std::size_t kMostPieces = 8'000'000;

struct LongestEdge {
    std::size_t index = 0;
    double squared = 0.0;
};

LongestEdge longest_edge(const Piece& piece) {
    LongestEdge longest;
    for (std::size_t i = 0; i < 3; ++i) {
        const double squared = (piece.corners[(i + 1) % 3] - piece.corners[i]).squaredNorm();
        if (squared > longest.squared) longest = {i, squared};
    }
    return longest;
}

// The part of a triangle in front of a plane, as up to two triangles. Cuts are computed from the
// lower to the upper corner, so that neighbouring facets share them exactly.
std::vector<Piece> clip(const Piece& piece, const std::pair<Vec3, double>& plane) {
    std::vector<Vec3> polygon;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3& a = piece.corners[i];
        const Vec3& b = piece.corners[(i + 1) % 3];
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
    std::vector<Piece> parts;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        parts.push_back({{polygon[0], polygon[i - 1], polygon[i]}, piece.facet});
    }
    return parts;
}

// Cuts facets of one kind into pieces.
class Cutter {
 public:
    Cutter(const Scene& scene,
           const core::Scan& scan,
           const core::TimeAxis& axis,
           const PieceRules& rules)
        : scene_(scene),
          axis_(axis),
          tolerance_(rules.tolerance),
          origin_(scene.rays().origin()),
          boxes_(scan, origin_) {}

    std::vector<Piece> cut(PieceKind kind, bool confocal);

 private:
    bool is_small_enough(const Vec3& center, double radius, double edge2, double lobe) const;
    void bisect(const Piece& facet, double lobe, std::vector<Piece>& pieces) const;

    const Scene& scene_;
    core::TimeAxis axis_;
    double tolerance_;
    Vec3 origin_;
    WallBoxes boxes_;
};

PieceKind kind_of(const Material& material) {
    switch (material.model) {
        case SurfaceModel::Ggx:
            return PieceKind::Glossy;
        case SurfaceModel::Retroreflective:
            return PieceKind::Retroreflective;
        case SurfaceModel::Lambertian:
            break;
    }
    return PieceKind::Lambertian;
}

// Length scale of the BSDF's lobe relative to a cosine's, squared.
double lobe_scale(const Material& material) {
    if (material.model != SurfaceModel::Ggx) return 1.0;
    const double alpha = material.roughness * material.roughness;
    return std::min(1.0, 4.0 * alpha * alpha);
}

bool Cutter::is_small_enough(const Vec3& center, double radius, double edge2, double lobe) const {
    const auto holds = [&](double light, double sensor) {
        const double nearest = std::min(light, sensor);
        if (edge2 > kSquaredSizePerTolerance * tolerance_ * lobe * nearest * nearest) return false;
        const double kappa = edge2 * (1.0 / light + 1.0 / sensor) / (8.0 * axis_.bin_width_m);
        return kappa <= kKappaPerTolerance * tolerance_;
    };
    if (holds(boxes_.light_legs(center, radius).least_m,
              boxes_.sensor_legs(center, radius).least_m)) {
        return true;
    }
    const auto [light, sensor] = boxes_.nearest_m(center, radius);
    return holds(light, sensor);
}

void Cutter::bisect(const Piece& facet, double lobe, std::vector<Piece>& pieces) const {
    std::vector<std::pair<Piece, int>> stack{{facet, 0}};
    while (!stack.empty()) {
        const auto [piece, depth] = stack.back();
        stack.pop_back();
        const LongestEdge longest = longest_edge(piece);
        const Vec3 center = piece.center();
        const double radius = std::sqrt(longest.squared / 3.0);  // Jung's theorem, about the middle
        const double reach = 2.0 * radius;                       // and about the centroid
        const LengthBounds lengths = boxes_.path_lengths(center, reach);
        if (lengths.most_m < axis_.opl_start_m || lengths.least_m > axis_.opl_end_m()) continue;
        if (boxes_.is_behind(center, reach)) continue;
        if (depth == kMostBisections || is_small_enough(center, radius, longest.squared, lobe)) {
            pieces.push_back(piece);
            if (pieces.size() > kMostPieces) {
                throw core::Failure("third_bounce", "needs more than 8 million pieces of surface");
            }
            continue;
        }
        const std::size_t i = longest.index;
        Piece first = piece;
        Piece second = piece;
        first.corners[(i + 1) % 3] = second.corners[i] = piece.midpoint(i);
        stack.emplace_back(second, depth + 1);
        stack.emplace_back(first, depth + 1);
    }
}

std::vector<Piece> Cutter::cut(PieceKind kind, bool confocal) {
    std::vector<Piece> pieces;
    if (kind == PieceKind::Retroreflective && !confocal) return pieces;
    for (std::uint32_t i = 0; i < scene_.facets().size(); ++i) {
        const Object& object = scene_.object_of(i);
        const Material& material = object.material;
        if (!scene_.is_hidden(i) || !is_integrable(material) || kind_of(material) != kind) continue;
        if (material.albedo == 0.0) continue;
        Piece whole;
        whole.facet = i;
        const auto& triangle = object.mesh.triangles[scene_.facet(i).triangle];
        for (std::size_t c = 0; c < 3; ++c) {
            whole.corners[c] = object.mesh.vertices[triangle[c]] - origin_;
        }
        if (!boxes_.common_plane()) {
            bisect(whole, lobe_scale(material), pieces);
            continue;
        }
        for (const Piece& part : clip(whole, *boxes_.common_plane())) {
            bisect(part, lobe_scale(material), pieces);
        }
    }
    return pieces;
}

std::vector<double> visible_sides(const Scene& scene, const core::Scan& scan) {
    std::vector<double> sides;
    for (const Object& object : scene.objects()) sides.push_back(visible_side(object, scan));
    return sides;
}

}  // namespace

bool is_integrable(const Material& material) {
    return material.model != SurfaceModel::Ggx ||
           material.roughness * material.roughness >= kSmallestGlossyAlpha;
}

PieceSet cut_pieces(const Scene& scene,
                    const core::Scan& scan,
                    const core::TimeAxis& axis,
                    const PieceRules& rules) {
    Cutter cutter(scene, scan, axis, rules);
    PieceArranger arranger(scene, scan, rules, visible_sides(scene, scan));
    for (const PieceKind kind :
         {PieceKind::Lambertian, PieceKind::Retroreflective, PieceKind::Glossy}) {
        arranger.add(cutter.cut(kind, scan.pattern == core::ScanPattern::Confocal), kind);
    }
    return arranger.finish();
}

}  // namespace renderer
