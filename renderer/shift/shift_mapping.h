// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/planar_patches.h"
#include "renderer/scene/scene.h"
#include "renderer/settings/restir_settings.h"
#include "renderer/shift/plane_shift.h"
#include "renderer/shift/shift_counts.h"
#include "renderer/shift/shift_gauges.h"

#include <optional>

namespace renderer {

/// The quantity that a shift preserves up to the given change.
enum class ShiftQuantity { PathLength, PathVelocity };

struct ShiftSettings {
    Chart chart = Chart::Adaptive;
    Gauge gauge = Gauge::Average;
    /// On planes, with the average gauge and path lengths: keep the angle on the ellipse instead,
    /// in closed form. Off: Newton's method there too.
    bool closed_form_on_planes = true;
    /// Average gauge: gradients of the surface instead of the coordinates. The same on planes.
    bool metric_gauge = true;
    bool reverse_check = true;
};

/// The fixed neighbours of the reconnection vertex x of a path: a -> x -> y.
struct ShiftEnd {
    core::Vec3 a;         ///< the vertex before x, on the sensor's side [m, world]
    core::Vec3 y;         ///< the one after it, on the light's side [m, world]
    core::Vec3 normal_y;  ///< of the surface at y, unit, either side; only for charts by ray
    core::Vec3 velocity_a = core::Vec3::Zero();  ///< of the two vertices' surfaces [m/s]; only for
    core::Vec3 velocity_y = core::Vec3::Zero();  ///< path velocities
};

/// The shifted reconnection vertex.
struct ShiftedPath {
    SurfacePoint point;
    double jacobian = 0.0;  ///< dA'/dA on the surface, positive
};

/// The path-length-aware shift mapping (source [Kim2026]): moves the reconnection vertex x of a
/// path from one pair of neighbours to another so that |a'-x'| + |x'-y'| = S (|a-x| + |x-y|) +
/// offset, one-to-one, with the change of area that goes with it.
///
/// Checked here: both residuals, both determinants, the root, the reverse shift, that x' lies on a
/// surface of the scene, that both directions take the same route, and the bound of the Jacobian;
/// on the hemisphere also that x' is the first surface seen from y'. NOT checked: visibility of x'
/// from a', on the plane also from y', the side of the facet, and the gate. These belong to the
/// caller's target function.
///
/// Charts:
///   plane        within the flat piece of surface (PlanarPatches) around x
///   barycentric  within the facet of x, in its own coordinates
///   hemisphere   directions at y, the surface by ray, on any facet
///   adaptive     plane where that works, else hemisphere. The result of the latter counts only if
///                the reverse shift would use it too, which keeps the map one-to-one.
class ShiftMapping {
 public:
    /// scene      must outlive the mapping
    /// throws     core::Error for the chart `custom`, which needs code (shift_on_charts)
    ShiftMapping(const Scene& scene,
                 const ShiftSettings& settings,
                 ShiftQuantity quantity = ShiftQuantity::PathLength);

    /// x         the vertex on the source path; source, target: its neighbours before and after
    /// change    of the kept quantity: l' = S l + offset [m], or [m/s] for path velocities
    /// counts    receives the outcome
    /// returns   nullopt when the shift is not defined: weight 0 on both sides
    /// throws    nothing
    std::optional<ShiftedPath> shift_path(const SurfacePoint& x,
                                          const ShiftEnd& source,
                                          const ShiftEnd& target,
                                          const ConstraintChange& change,
                                          ShiftCounts& counts) const;

 private:
    class Attempt;

    const Scene* scene_;
    ShiftSettings settings_;
    ShiftQuantity quantity_;
    AnyGauge gauge_;
    double rounding_m_;  ///< of the scene's coordinates
    PlanarPatches patches_;
};

}  // namespace renderer
