// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/scene/scene.h"
#include "renderer/shift/shift_mapping.h"

#include <optional>
#include <vector>

namespace test_support {

/// One shift to try.
struct ShiftCase {
    renderer::SurfacePoint x;
    renderer::ShiftEnd source;
    renderer::ShiftEnd target;
    renderer::ConstraintChange change;

    ShiftCase inverse(const renderer::SurfacePoint& shifted) const {
        return {shifted, target, source, change.inverse()};
    }
};

inline std::optional<renderer::ShiftedPath> shift(const renderer::ShiftMapping& mapping,
                                                  const ShiftCase& c,
                                                  renderer::ShiftCounts& counts) {
    return mapping.shift_path(c.x, c.source, c.target, c.change, counts);
}

/// How random cases are drawn.
struct ShiftCaseSettings {
    double scale_m = 1.0;         ///< size of the wall and of the distance to the surface
    double moved_m = 0.02;        ///< how far each focus moves
    double offset_m = 0.02;       ///< largest change of length
    double ratio = 1.0;           ///< S; the offset then keeps the length on average
    bool confocal = false;        ///< both foci in one place, before and after
    double velocity_m_per_s = 0;  ///< of the foci
};

/// A uniform direction.
core::Vec3 random_direction(core::Rng& rng);

/// A case on a random facet (by index), foci on the wall z = 0 with normal +z around `centre`.
ShiftCase random_shift_case(const renderer::Scene& scene,
                            const core::Vec3& centre,
                            const ShiftCaseSettings& settings,
                            core::Rng& rng);

/// A scene without relay wall, rays around `centre`.
renderer::Scene scene_of(std::vector<renderer::Object> objects,
                         const core::Vec3& centre = core::Vec3::Zero());

/// One large quad of two facets behind the wall's centre, tilted.
renderer::Object tilted_quad(const core::Vec3& centre, double scale_m);

/// A sheet of 2 cells^2 facets over the same place, wavy: bumps of `height_m`.
renderer::Object wavy_sheet(const core::Vec3& centre, double scale_m, int cells, double height_m);

/// Central differences of the mapping on the surfaces at both ends, dA'/dA; nullopt where a
/// neighbouring shift fails or lands on another plane.
///
/// step_m   of the differences, which are of fourth order
std::optional<double> jacobian_by_differences(const renderer::Scene& scene,
                                              const renderer::ShiftMapping& mapping,
                                              const ShiftCase& c,
                                              double step_m);

}  // namespace test_support
