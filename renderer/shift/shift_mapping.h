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

/// What a shift keeps, up to the given change.
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

/// What stays fixed of a path while its reconnection vertex x moves: a -> x -> y.
struct ShiftEnd {
    core::Vec3 a;         ///< the vertex before x, on the sensor's side [m, world]
    core::Vec3 y;         ///< the one after it, on the light's side [m, world]
    core::Vec3 normal_y;  ///< of the surface at y, unit, either side; only for charts by ray
    core::Vec3 velocity_a = core::Vec3::Zero();  ///< of the two vertices' surfaces [m/s]; only for
    core::Vec3 velocity_y = core::Vec3::Zero();  ///< path velocities
};

/// Where the reconnection vertex goes.
struct ShiftedPath {
    SurfacePoint point;
    double jacobian = 0.0;  ///< dA'/dA on the surface, positive
};

/// The path-length-aware shift mapping (source [Kim2026]): moves the reconnection vertex x of a
/// path from one pair of neighbours to another so that |a'-x'| + |x'-y'| = S (|a-x| + |x-y|) +
/// offset, one-to-one, with the change of area that goes with it.
///
/// Checked inside: both residuals, both determinants, the root, the way back, x' on the scene's
/// surface, the same route from both ends, and the bound of the Jacobian; on the hemisphere also
/// that x' is the first surface seen from y'. NOT checked: whether a' sees x', whether y' sees x'
/// on the plane, the side of the facet, the gate. These belong to the caller's target function.
///
/// Charts:
///   plane        within the planar patch (PlanarPatches) around x
///   barycentric  within the facet of x, in its own coordinates
///   hemisphere   directions at y, the surface by ray, on any facet
///   adaptive     plane where that works, else hemisphere. The ray's result counts only when the
///                way back would take the ray too, which keeps the map one-to-one.
class ShiftMapping {
 public:
    /// scene      must outlive the mapping
    /// throws     core::Error for the chart `custom`, which needs code (shift_on_charts)
    ShiftMapping(const Scene& scene,
                 const ShiftSettings& settings,
                 ShiftQuantity quantity = ShiftQuantity::PathLength);

    /// x         the vertex on the source path; source, target: its neighbours before and after
    /// change    of the kept quantity: l' = S l + offset [m], or [m/s] for path velocities
    /// counts    receives what happened
    /// returns   nullopt when the shift is not defined: weight 0 on both sides
    /// throws    nothing
    std::optional<ShiftedPath> shift_path(const SurfacePoint& x,
                                          const ShiftEnd& source,
                                          const ShiftEnd& target,
                                          const ConstraintChange& change,
                                          ShiftCounts& counts) const;

 private:
    struct Task;

    const Scene* scene_;
    ShiftSettings settings_;
    ShiftQuantity quantity_;
    AnyGauge gauge_;
    double rounding_m_;  ///< of the scene's coordinates
    PlanarPatches patches_;
};

}  // namespace renderer
