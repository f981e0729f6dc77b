// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"
#include "renderer/third_bounce/element_clusters.h"
#include "renderer/third_bounce/surface_elements.h"

#include <span>
#include <vector>

namespace renderer {

/// What arranging depends on.
struct PackingRules {
    double tolerance = 0.01;  ///< relative L2 error aimed at
    double laser_spot_m2 = 1e-4;
};

/// Merges elements and arranges them into blocks of neighbours and groups within blocks.
class ElementPacker {
 public:
    /// visible_side   per object, see closed_surface.h
    ElementPacker(const Scene& scene,
                  const core::Scan& scan,
                  const PackingRules& rules,
                  std::vector<int> visible_side);

    /// Call once.
    ///
    /// clusters   of elements that may be merged, see cluster_elements()
    ElementSet arrange(std::span<const SurfaceElement> elements,
                       std::span<const std::uint32_t> clusters);

 private:
    struct Range {
        std::size_t begin;
        std::size_t end;
    };
    void append_blocks(const std::vector<ElementCluster>& elements, ElementKind kind);
    void fill_lane(ElementBlock& block, std::size_t lane, const ElementCluster& element) const;
    bool may_be_one_group(const ElementBlock& block, Range lanes) const;
    void form_groups(std::size_t block, Range lanes);
    void find_group_neighbours();

    const Scene& scene_;
    PackingRules rules_;
    std::vector<int> visible_side_;
    core::Vec3 scan_center_;
    std::vector<std::uint32_t> element_ids_;  ///< block * kSize + lane of every merged element
    ElementSet set_;
};

}  // namespace renderer
