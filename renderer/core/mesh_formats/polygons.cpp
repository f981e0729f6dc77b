// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/polygons.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace core {
namespace {

using Polygon = std::span<const std::uint32_t>;

/// A polygon seen along its normal, so that it runs counterclockwise.
std::vector<Vec2> flattened(Polygon polygon, const std::vector<Vec3>& vertices) {
    const Vec3& origin = vertices[polygon[0]];
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        normal += triangle_area_vector(origin, vertices[polygon[i - 1]], vertices[polygon[i]]);
    }
    int axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    int u = (axis + 1) % 3;
    int v = (axis + 2) % 3;
    if (normal[axis] < 0.0) std::swap(u, v);
    std::vector<Vec2> points;
    for (const std::uint32_t corner : polygon) {
        const Vec3 offset = vertices[corner] - origin;
        points.emplace_back(offset[u], offset[v]);
    }
    return points;
}

/// Twice the area of a triangle, negative when it runs clockwise.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Cuts ears off a polygon until a triangle is left: convex corners whose triangle holds no other
/// corner. After each cut only the corners beside it can become ears.
class EarCutter {
 public:
    explicit EarCutter(std::vector<Vec2> points)
        : points_(std::move(points)), before_(points_.size()), after_(points_.size()) {
        const std::size_t count = points_.size();
        for (std::size_t i = 0; i < count; ++i) {
            before_[i] = (i + count - 1) % count;
            after_[i] = (i + 1) % count;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (corner_turn(i) < 0.0) dents_.push_back(i);
        }
    }

    /// The corners that point inwards.
    const std::vector<std::size_t>& dents() const { return dents_; }

    /// Calls add(a, b, c) with the corners of each triangle. A polygon that crosses itself, which
    /// may have no ears, is cut into as many.
    template <class Add>
    void cut(const Add& add) {
        std::vector<std::size_t> candidates(points_.size());
        std::iota(candidates.rbegin(), candidates.rend(), 0);
        std::vector<bool> is_cut(points_.size(), false);
        std::size_t left = points_.size();
        std::size_t any = 0;
        while (left > 2) {
            std::size_t tip = any;
            if (!candidates.empty()) {
                tip = candidates.back();
                candidates.pop_back();
                if (is_cut[tip] || !is_ear(tip)) continue;
            }
            const std::size_t a = before_[tip];
            const std::size_t c = after_[tip];
            add(a, tip, c);
            is_cut[tip] = true;
            after_[a] = c;
            before_[c] = a;
            any = c;
            candidates.push_back(c);
            candidates.push_back(a);
            --left;
        }
    }

 private:
    double corner_turn(std::size_t i) const {
        return turn(points_[before_[i]], points_[i], points_[after_[i]]);
    }

    bool is_ear(std::size_t tip) {
        if (corner_turn(tip) <= 0.0) return false;
        const Vec2& a = points_[before_[tip]];
        const Vec2& b = points_[tip];
        const Vec2& c = points_[after_[tip]];
        std::erase_if(dents_, [&](std::size_t i) { return corner_turn(i) >= 0.0; });
        return std::ranges::none_of(dents_, [&](std::size_t i) {
            const Vec2& p = points_[i];
            return p != a && p != b && p != c && turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 &&
                   turn(c, a, p) >= 0.0;
        });
    }

    std::vector<Vec2> points_;
    std::vector<std::size_t> before_;
    std::vector<std::size_t> after_;
    std::vector<std::size_t> dents_;
};

void add_polygon(const std::string& path, Polygon polygon, TriangleMesh& mesh) {
    for (const std::uint32_t corner : polygon) {
        if (corner < mesh.vertices.size()) continue;
        throw Error(path,
                    fmt::format("has a face with vertex {}, counted from 0", corner),
                    fmt::format("must be below the {} vertices", mesh.vertices.size()));
    }
    const std::size_t count = polygon.size();
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    };
    if (count == 3) add(0, 1, 2);
    if (count <= 3) return;
    EarCutter cutter(flattened(polygon, mesh.vertices));
    const std::size_t num_dents = cutter.dents().size();
    if (num_dents == 0 || count == 4) {
        const std::size_t centre = num_dents == 0 ? 0 : cutter.dents()[0];
        for (std::size_t i = 2; i < count; ++i) {
            add(centre, (centre + i - 1) % count, (centre + i) % count);
        }
        return;
    }
    constexpr std::size_t kMostCorners = 10'000;  // each is compared with each dent
    if (count > kMostCorners) {
        throw Error(path,
                    fmt::format("has a polygon of {} corners that is not convex", count),
                    fmt::format("must have at most {}, or consist of triangles", kMostCorners));
    }
    cutter.cut(add);
}

}  // namespace

void add_triangles(const std::string& path,
                   const Polygons& polygons,
                   std::size_t begin,
                   std::size_t end,
                   TriangleMesh& mesh) {
    std::size_t corner = begin == 0 ? 0 : polygons.ends[begin - 1];
    for (std::size_t i = begin; i < end; ++i) {
        const std::size_t count = polygons.ends[i] - corner;
        add_polygon(path, Polygon(polygons.corners).subspan(corner, count), mesh);
        corner += count;
    }
}

}  // namespace core
