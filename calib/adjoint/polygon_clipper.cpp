// SPDX-License-Identifier: MIT
#include "calib/adjoint/polygon_clipper.h"

#include <algorithm>
#include <cmath>

namespace calib {

using core::Vec3;

void PolygonClipper::start(double margin_m) {
    margin_m_ = margin_m;
    lines_.clear();
    lines_.resize(3);
    // Edge k leads from corner k to the next one.
    for (std::size_t k = 0; k < 3; ++k) {
        lines_[k].height_m = Vec3::Unit(static_cast<Eigen::Index>((k + 2) % 3));
    }
    vertices_ = {{Vec3::UnitX(), 0}, {Vec3::UnitY(), 1}, {Vec3::UnitZ(), 2}};
    ends_ = {3};
}

bool PolygonClipper::is_whole() const {
    return num_polygons() == 1 &&
           std::all_of(vertices_.begin(), vertices_.end(), [&](const PolygonVertex& vertex) {
               return lines_[vertex.line].plane == CutPlane::ElementEdge;
           });
}

void PolygonClipper::measure(std::span<const PolygonVertex> polygon, std::uint32_t line) {
    const Vec3 height_m = lines_[line].height_m;
    heights_.resize(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const double height = height_m.dot(polygon[i].barycentric);
        heights_[i] = std::abs(height) <= margin_m_ ? 0.0 : height;
    }
}

// What lies on one side of a line for which measure() was called.
void PolygonClipper::append_side(std::span<const PolygonVertex> polygon,
                                 std::uint32_t line,
                                 Side side,
                                 Polygon& target) const {
    const double sign = side == Side::Above ? 1.0 : -1.0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::size_t j = i + 1 == polygon.size() ? 0 : i + 1;
        const double here = sign * heights_[i];
        const double there = sign * heights_[j];
        const auto meeting_point = [&] {
            const double t = here / (here - there);
            return Vec3(polygon[i].barycentric +
                        t * (polygon[j].barycentric - polygon[i].barycentric));
        };
        if (here >= 0.0) {
            const bool leaves_here = here == 0.0 && there < 0.0;
            target.push_back({polygon[i].barycentric, leaves_here ? line : polygon[i].line});
            if (here > 0.0 && there < 0.0) target.push_back({meeting_point(), line});
        } else if (there > 0.0) {
            target.push_back({meeting_point(), polygon[i].line});
        }
    }
}

void PolygonClipper::add_next(std::span<const PolygonVertex> polygon) {
    next_vertices_.insert(next_vertices_.end(), polygon.begin(), polygon.end());
    next_ends_.push_back(next_vertices_.size());
}

void PolygonClipper::finish_pass() {
    vertices_.swap(next_vertices_);
    ends_.swap(next_ends_);
    next_vertices_.clear();
    next_ends_.clear();
}

void PolygonClipper::keep_above(const CutLine& line) {
    const auto index = static_cast<std::uint32_t>(lines_.size());
    lines_.push_back(line);
    for (std::size_t i = 0; i < num_polygons(); ++i) {
        measure(polygon(i), index);
        if (*std::max_element(heights_.begin(), heights_.end()) <= 0.0) continue;
        append_side(polygon(i), index, Side::Above, next_vertices_);
        next_ends_.push_back(next_vertices_.size());
    }
    finish_pass();
}

void PolygonClipper::remove(std::span<const CutLine> lines) {
    const auto first = static_cast<std::uint32_t>(lines_.size());
    lines_.insert(lines_.end(), lines.begin(), lines.end());
    for (std::size_t i = 0; i < num_polygons(); ++i) remove_from(polygon(i), first);
    finish_pass();
}

// Cuts off what lies below one line after the other. Where nothing is left in the end, the polygon
// lies beside the region, and stays in one piece.
void PolygonClipper::remove_from(std::span<const PolygonVertex> polygon, std::uint32_t first_line) {
    const std::size_t num_vertices = next_vertices_.size();
    const std::size_t num_polygons = next_ends_.size();
    inside_.assign(polygon.begin(), polygon.end());
    for (std::uint32_t line = first_line; line < lines_.size(); ++line) {
        measure(inside_, line);
        const auto [lowest, highest] = std::minmax_element(heights_.begin(), heights_.end());
        if (*highest <= 0.0) {
            next_vertices_.resize(num_vertices);
            next_ends_.resize(num_polygons);
            add_next(polygon);
            return;
        }
        if (*lowest >= 0.0) continue;
        append_side(inside_, line, Side::Below, next_vertices_);
        next_ends_.push_back(next_vertices_.size());
        rest_.clear();
        append_side(inside_, line, Side::Above, rest_);
        inside_.swap(rest_);
    }
}

}  // namespace calib
