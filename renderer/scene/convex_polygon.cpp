// SPDX-License-Identifier: MIT
#include "renderer/scene/convex_polygon.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace renderer {
namespace {

using core::Vec2;
using Triangle2 = std::array<Vec2, 3>;

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// The line through two points; heights are above 0 to its left.
class Line {
 public:
    Line(const Vec2& from, const Vec2& to) : from_(from), along_((to - from).normalized()) {}
    double height(const Vec2& point) const { return cross(along_, point - from_); }

 private:
    Vec2 from_;
    Vec2 along_;
};

// Whether an edge of `a` has all of `b` on its outer side.
bool has_edge_between(std::span<const Vec2> a, std::span<const Vec2> b, double slack) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Vec2& next = a[(i + 1) % a.size()];
        if ((next - a[i]).norm() <= slack) continue;  // too short to have a direction
        const Line line(a[i], next);
        const bool all_outside = std::all_of(
            b.begin(), b.end(), [&](const Vec2& point) { return line.height(point) <= slack; });
        if (all_outside) return true;
    }
    return false;
}

struct Halves {
    ConvexPolygon left;
    ConvexPolygon right;
};

// Both are empty or reach farther from the line than `slack`, unless all of the polygon is as near.
Halves split(const ConvexPolygon& polygon, const Line& line, double slack) {
    std::vector<double> heights;
    for (const Vec2& corner : polygon) heights.push_back(line.height(corner));
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    if (*low >= -slack) return {polygon, {}};
    if (*high <= slack) return {{}, polygon};
    Halves halves;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t j = (i + 1) % polygon.size();
        if (heights[i] >= -slack) halves.left.push_back(polygon[i]);
        if (heights[i] <= slack) halves.right.push_back(polygon[i]);
        const bool crosses =
            std::min(heights[i], heights[j]) < -slack && std::max(heights[i], heights[j]) > slack;
        if (!crosses) continue;
        const Vec2 corner =
            polygon[i] + heights[i] / (heights[i] - heights[j]) * (polygon[j] - polygon[i]);
        halves.left.push_back(corner);
        halves.right.push_back(corner);
    }
    return halves;
}

bool is_strip(const ConvexPolygon& polygon, double slack) {
    double longest = 0.0;
    for (const Vec2& corner : polygon) longest = std::max(longest, (corner - polygon[0]).norm());
    return area_of(polygon) <= slack * longest;
}

void add_rest(ConvexPolygon polygon,
              std::span<const Triangle2> triangles,
              double slack,
              std::vector<ConvexPolygon>& rest) {
    if (is_strip(polygon, slack)) return;
    std::vector<Triangle2> overlapping;
    for (const Triangle2& triangle : triangles) {
        if (!are_apart(polygon, triangle, slack)) overlapping.push_back(triangle);
    }
    if (overlapping.empty()) {
        rest.push_back(std::move(polygon));
        return;
    }
    // One of the middle leaves others on all its sides, so that the lists soon grow short.
    const auto middle = overlapping.begin() + static_cast<std::ptrdiff_t>(overlapping.size() / 2);
    const Triangle2 triangle = *middle;
    overlapping.erase(middle);
    for (std::size_t i = 0; i < 3 && !polygon.empty(); ++i) {
        Halves halves = split(polygon, Line(triangle[i], triangle[(i + 1) % 3]), slack);
        if (!halves.right.empty()) add_rest(std::move(halves.right), overlapping, slack, rest);
        polygon = std::move(halves.left);
    }
}

}  // namespace

double area_of(const ConvexPolygon& polygon) {
    double twice = 0.0;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        twice += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    }
    return 0.5 * twice;
}

bool are_apart(std::span<const Vec2> a, std::span<const Vec2> b, double slack) {
    return has_edge_between(a, b, slack) || has_edge_between(b, a, slack);
}

ConvexPolygon intersection(const Triangle2& a, const Triangle2& b) {
    ConvexPolygon polygon(a.begin(), a.end());
    for (std::size_t i = 0; i < 3 && !polygon.empty(); ++i) {
        polygon = split(polygon, Line(b[i], b[(i + 1) % 3]), 0.0).left;
    }
    return polygon;
}

std::vector<ConvexPolygon> subtract(const ConvexPolygon& polygon,
                                    std::span<const Triangle2> triangles,
                                    double slack) {
    std::vector<ConvexPolygon> rest;
    add_rest(polygon, triangles, slack, rest);
    return rest;
}

}  // namespace renderer
