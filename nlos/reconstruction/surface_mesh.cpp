// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nlos {
namespace {

constexpr double kSteepest = 4.0;
constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// A column of the depth map.
struct Column {
    std::size_t ix, iy;
};

/// Columns that carry a vertex, and that vertex' number.
class MeshBuilder {
 public:
    explicit MeshBuilder(const core::DepthMap& depth)
        : depth_(depth), number_(depth.depth_m.size(), kNoVertex) {}

    /// Adds the triangle unless a corner is background or the corners are on different surfaces.
    void add(const Column& a, const Column& b, const Column& c) {
        if (!are_joined(a, b) || !are_joined(b, c) || !are_joined(c, a)) return;
        mesh_.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    }

    core::TriangleMesh take() { return std::move(mesh_); }

    bool are_joined(const Column& a, const Column& b) const {
        const double za = depth_.depth_m[depth_.index(a.ix, a.iy)];
        const double zb = depth_.depth_m[depth_.index(b.ix, b.iy)];
        const double distance =
            std::hypot(depth_.x_m[a.ix] - depth_.x_m[b.ix], depth_.y_m[a.iy] - depth_.y_m[b.iy]);
        return std::abs(za - zb) <= kSteepest * distance;  // false for NaN
    }

 private:
    std::uint32_t vertex(const Column& column) {
        const std::size_t i = depth_.index(column.ix, column.iy);
        if (number_[i] == kNoVertex) {
            number_[i] = static_cast<std::uint32_t>(mesh_.vertices.size());
            mesh_.vertices.push_back(depth_.point_world(column.ix, column.iy));
            if (!depth_.normals.empty()) mesh_.normals.push_back(depth_.normals[i]);
        }
        return number_[i];
    }

    const core::DepthMap& depth_;
    core::TriangleMesh mesh_;
    std::vector<std::uint32_t> number_;
};

}  // namespace

core::TriangleMesh surface_mesh(const core::DepthMap& depth) {
    MeshBuilder builder(depth);
    for (std::size_t ix = 0; ix + 1 < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy + 1 < depth.y_m.size(); ++iy) {
            const Column a{ix, iy}, b{ix + 1, iy}, c{ix + 1, iy + 1}, d{ix, iy + 1};
            // Counter-clockwise seen from the wall, which looks along +z. The diagonal that exists
            // splits the cell; where both do, the first.
            if (builder.are_joined(a, c)) {
                builder.add(a, c, b);
                builder.add(a, d, c);
            } else {
                builder.add(a, d, b);
                builder.add(b, d, c);
            }
        }
    }
    return builder.take();
}

}  // namespace nlos
