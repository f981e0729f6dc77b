// SPDX-License-Identifier: MIT
#include "calib/model_visibility.h"

#include "renderer/core/parallel.h"
#include "renderer/scene.h"
#include "renderer/visibility_mask.h"

#include <cmath>

namespace calib {
namespace {

using core::Vec3;

}  // namespace

bool is_planar(const SceneModel& model, const SceneState& state) {
    constexpr double kFlatness_m = 1e-9;
    if (model.facets().empty()) return true;
    const auto first = model.motion(state, 0).corners;
    const Vec3 normal = (first[1] - first[0]).cross(first[2] - first[0]).normalized();
    for (std::size_t f = 0; f < model.facets().size(); ++f) {
        for (const Vec3& corner : model.motion(state, f).corners) {
            if (std::abs(normal.dot(corner - first[0])) > kFlatness_m) return false;
        }
    }
    return true;
}

std::vector<std::uint8_t> trace_masks(const SceneModel& model,
                                      const SceneState& state,
                                      const std::vector<ModelPiece>& pieces,
                                      const core::Scan& scan,
                                      const core::WallPoints& points) {
    // The wall itself hides nothing from its own points; leaving it out keeps curved walls simple.
    renderer::SceneGeometry geometry = model.posed(state);
    std::erase_if(geometry.objects, [](const renderer::Object& object) {
        return object.role == renderer::Role::RelayWall;
    });
    renderer::RelayWall nowhere;
    nowhere.center_m = Vec3(1e6, 1e6, 1e6);
    const renderer::Scene scene(std::move(geometry), scan, nowhere);

    struct Target {
        std::array<Vec3, kVisibilityRays> positions;
        Vec3 normal;
    };
    std::vector<Target> targets;
    for (const ModelPiece& piece : pieces) {
        const auto corners = model.motion(state, piece.facet).corners;
        Target& target = targets.emplace_back();
        target.normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
        for (std::size_t ray = 0; ray < kVisibilityRays; ++ray) {
            const auto& share = renderer::center_of_bit(static_cast<std::uint32_t>(4 * ray + 3));
            const Vec3 weights = share[0] * piece.barycentric[0] + share[1] * piece.barycentric[1] +
                                 share[2] * piece.barycentric[2];
            target.positions[ray] =
                weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
        }
    }
    std::vector<std::uint8_t> masks(points.size() * pieces.size());
    core::parallel_for(points.size(), [&](std::size_t p) {
        for (std::size_t i = 0; i < targets.size(); ++i) {
            for (std::size_t ray = 0; ray < kVisibilityRays; ++ray) {
                const bool blocked = scene.rays().is_blocked(points.positions[p],
                                                             points.normals[p],
                                                             targets[i].positions[ray],
                                                             targets[i].normal);
                if (blocked) continue;
                std::uint8_t& mask = masks[p * pieces.size() + i];
                mask = static_cast<std::uint8_t>(mask | 1U << ray);
            }
        }
    });
    return masks;
}

}  // namespace calib
