// SPDX-License-Identifier: MIT
#include "renderer/scene/weld.h"

#include "renderer/core/random.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace renderer {
namespace {

using core::Vec3;

// Finds vertices within a distance of earlier ones by the cells of a grid.
class VertexGrid {
 public:
    VertexGrid(const Vec3& corner, double distance_m, std::size_t num_vertices)
        : corner_(corner), distance_m_(distance_m) {
        vertices_.reserve(num_vertices);
    }

    /// The position of an earlier vertex nearby; else that of this one, which is remembered.
    Vec3 first_near(const Vec3& vertex) {
        const Vec3 low = cell_of(vertex - Vec3::Constant(distance_m_));
        const Vec3 high = cell_of(vertex + Vec3::Constant(distance_m_));
        for (double x = low.x(); x <= high.x(); ++x) {
            for (double y = low.y(); y <= high.y(); ++y) {
                for (double z = low.z(); z <= high.z(); ++z) {
                    const auto [begin, end] = vertices_.equal_range(key_of({x, y, z}));
                    for (auto it = begin; it != end; ++it) {
                        const double apart_m = (it->second - vertex).cwiseAbs().maxCoeff();
                        if (apart_m <= distance_m_) return it->second;
                    }
                }
            }
        }
        vertices_.emplace(key_of(cell_of(vertex)), vertex);
        return vertex;
    }

 private:
    Vec3 cell_of(const Vec3& point) const {
        constexpr double kDistancesPerCell = 64.0;  // so that most look into one cell alone
        return ((point - corner_) / (kDistancesPerCell * distance_m_)).array().floor();
    }

    static std::uint64_t key_of(const Vec3& cell) {
        std::uint64_t key = 0;
        for (const double number : cell) {
            key =
                core::Rng::mix(key + static_cast<std::uint64_t>(static_cast<std::int64_t>(number)));
        }
        return key;
    }

    Vec3 corner_;
    double distance_m_;
    std::unordered_multimap<std::uint64_t, Vec3> vertices_;
};

}  // namespace

void weld_vertices(core::TriangleMesh& mesh) {
    constexpr double kOfLongestSide = 1e-7;
    constexpr double kRoundings = 4.0;
    if (mesh.vertices.empty()) return;
    Eigen::AlignedBox3d box;
    for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
    const double largest_m =
        std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
    const double rounding_m = std::numeric_limits<double>::epsilon() * largest_m;
    VertexGrid grid(box.min(),
                    std::max(kOfLongestSide * box.sizes().maxCoeff(), kRoundings * rounding_m),
                    mesh.vertices.size());
    std::vector<Vec3> welded;
    welded.reserve(mesh.vertices.size());
    for (const Vec3& vertex : mesh.vertices) welded.push_back(grid.first_near(vertex));
    const bool all_have_area = std::ranges::all_of(mesh.triangles, [&](const auto& triangle) {
        const auto& [a, b, c] = triangle;
        return core::has_area(welded[b] - welded[a], welded[c] - welded[a]);
    });
    if (all_have_area) mesh.vertices = std::move(welded);
}

}  // namespace renderer
