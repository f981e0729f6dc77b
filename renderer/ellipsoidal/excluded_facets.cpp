// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/excluded_facets.h"

namespace renderer {
namespace {

// Per object, whether it is wider than a time axis is long.
std::vector<bool> wider_than(const core::TimeAxis& axis, const Scene& scene) {
    std::vector<Eigen::AlignedBox3d> boxes(scene.objects().size());
    for (const Facet& facet : scene.facets()) {
        for (const core::Vec3& corner : facet.corners()) boxes[facet.object].extend(corner);
    }
    std::vector<bool> is_wider;
    for (const Eigen::AlignedBox3d& box : boxes) {
        is_wider.push_back(box.diagonal().norm() > axis.opl_end_m() - axis.opl_start_m);
    }
    return is_wider;
}

}  // namespace

ExcludedFacets ExcludedFacets::of(const Scene& scene,
                                  const core::TimeAxis& axis,
                                  const RenderSettings& settings) {
    ExcludedFacets excluded;
    excluded.facets.resize(scene.facets().size());
    if (settings.exclude == Exclusion::None) return excluded;
    const std::vector<bool> is_wide = wider_than(axis, scene);
    std::vector<bool> touched(scene.objects().size());
    const auto is_connected = [&](std::size_t object) {
        return settings.exclude == Exclusion::Mis &&
               scene.objects()[object].role != Role::RelayWall && is_wide[object];
    };
    for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
        const Object& object = scene.object_of(i);
        const bool too_large = settings.exclude_area_above_m2 &&
                               scene.facet(i).area_m2 > *settings.exclude_area_above_m2;
        if (object.role == Role::Hidden && !object.ellipsoidal_exclude && !too_large) continue;
        touched[scene.facet(i).object] = true;
        excluded.facets[i] = !is_connected(scene.facet(i).object);
    }
    for (std::size_t o = 0; o < touched.size(); ++o) {
        if (!touched[o]) continue;
        excluded.objects.names.push_back(scene.objects()[o].name);
        if (is_connected(o)) excluded.objects.connected.push_back(scene.objects()[o].name);
    }
    return excluded;
}

}  // namespace renderer
