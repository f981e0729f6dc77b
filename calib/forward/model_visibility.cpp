// SPDX-License-Identifier: MIT
#include "calib/forward/model_elements.h"
#include "renderer/core/system/parallel.h"
#include "renderer/scene/scene.h"

#include <cmath>

namespace calib {
namespace {

using core::Vec3;
using renderer::VisibilityMask;

constexpr std::uint32_t kParts = 16;

// An element in the world: the centres of its parts.
struct Target {
    std::array<Vec3, kParts> centers;
    Vec3 normal;
};

std::vector<Target> make_targets(const SceneModel& model,
                                 const SceneState& state,
                                 const std::vector<ModelElement>& elements) {
    std::vector<Target> targets;
    targets.reserve(elements.size());
    for (const ModelElement& element : elements) {
        const auto corners = model.motion(state, element.facet).corners;
        Target& target = targets.emplace_back();
        target.normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
        for (std::uint32_t part = 0; part < kParts; ++part) {
            const auto& center = renderer::centers_of_bits()[part];
            const Vec3 weights = center[0] * element.barycentric[0] +
                                 center[1] * element.barycentric[1] +
                                 center[2] * element.barycentric[2];
            target.centers[part] =
                weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
        }
    }
    return targets;
}

VisibilityMask trace_mask(const renderer::Scene& scene,
                          const core::WallPoints& points,
                          std::size_t point,
                          const Target& target) {
    const auto trace = [&](std::uint32_t part) {
        const bool is_blocked = scene.rays().is_blocked(
            points.positions[point], points.normals[point], target.centers[part], target.normal);
        return is_blocked ? 0U : 1U << part;
    };
    const auto is_quarter_center = [](std::uint32_t part) { return part % 4 == 3; };
    std::uint32_t mask = 0;
    std::uint32_t centers = 0;
    for (std::uint32_t part = 0; part < kParts; ++part) {
        if (!is_quarter_center(part)) continue;
        mask |= trace(part);
        centers |= 1U << part;
    }
    if (mask == 0) return 0;
    if (mask == centers) return renderer::kAllVisible;
    for (std::uint32_t part = 0; part < kParts; ++part) {
        if (!is_quarter_center(part)) mask |= trace(part);
    }
    return static_cast<VisibilityMask>(mask);
}

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

std::vector<VisibilityMask> trace_masks(const SceneModel& model,
                                        const SceneState& state,
                                        const std::vector<ModelElement>& elements,
                                        const core::WallScan& scan,
                                        const core::WallPoints& points) {
    // The wall itself hides nothing from its own points; leaving it out keeps curved walls simple.
    renderer::SceneGeometry geometry = model.posed(state);
    std::erase_if(geometry.objects, [](const renderer::Object& object) {
        return object.role == renderer::Role::RelayWall;
    });
    renderer::RelayWall nowhere;
    nowhere.center_m = Vec3(1e6, 1e6, 1e6);
    const renderer::Scene scene(std::move(geometry), scan, nowhere);
    const std::vector<Target> targets = make_targets(model, state, elements);
    std::vector<VisibilityMask> masks(points.size() * targets.size());
    core::parallel_for(points.size(), [&](std::size_t p) {
        for (std::size_t i = 0; i < targets.size(); ++i) {
            masks[p * targets.size() + i] = trace_mask(scene, points, p, targets[i]);
        }
    });
    return masks;
}

}  // namespace calib
