// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/scene/scene.h"

#include <concepts>
#include <cstdint>
#include <optional>

namespace renderer {

/// A surface near one of its points, in a chart X(xi), xi in R^2, to second order.
struct ChartPoint {
    core::Vec3 position;  ///< X [m], relative to the chart's origin
    core::Vec3 tangent1;  ///< dX/dxi_1
    core::Vec3 tangent2;
    core::Vec3 second11 = core::Vec3::Zero();  ///< d2X/dxi_1 dxi_1; second derivatives are ignored
                                               ///< where the chart is affine
    core::Vec3 second12 = core::Vec3::Zero();
    core::Vec3 second22 = core::Vec3::Zero();
    double area_density = 0.0;  ///< |dX/dxi_1 x dX/dxi_2|
    double rounding_m = 0.0;    ///< bound of the rounding error of the position
    core::Vec3 velocity;        ///< of the surface [m/s]
    std::uint32_t facet = 0;    ///< where the surface is a mesh
};

/// Coordinates on a surface. To add a chart: a type with these members, then `shift_on_charts`
/// (shift_solver.h) takes it for either end of a shift; tests/support/sdf_chart.h is an example
/// on an implicit surface. Charts with a name in the settings have a route in shift_mapping.cpp.
template <class C>
concept SurfaceChart = requires(const C& chart, const core::Vec2& xi) {
    { chart.at(xi) } -> std::same_as<std::optional<ChartPoint>>;  // nullopt outside the chart
    { C::kAffine } -> std::convertible_to<bool>;                  // no second derivatives
    { C::kPeriodic } -> std::convertible_to<bool>;                // xi_2 repeats with period 1
};

/// Plane and barycentric charts: X = origin + xi_1 tangent1 + xi_2 tangent2. The chart extends
/// beyond the facet; whether a point lies on the surface is checked afterwards.
class AffineChart {
 public:
    static constexpr bool kAffine = true;
    static constexpr bool kPeriodic = false;

    AffineChart(const core::Vec3& origin,
                const core::Vec3& tangent1,
                const core::Vec3& tangent2,
                const core::Vec3& velocity,
                double rounding_m) {
        at_origin_.position = origin;
        at_origin_.tangent1 = tangent1;
        at_origin_.tangent2 = tangent2;
        at_origin_.area_density = tangent1.cross(tangent2).norm();
        at_origin_.velocity = velocity;
        at_origin_.rounding_m = rounding_m;
    }

    std::optional<ChartPoint> at(const core::Vec2& xi) const {
        ChartPoint point = at_origin_;
        point.position += xi.x() * point.tangent1 + xi.y() * point.tangent2;
        return point;
    }

 private:
    ChartPoint at_origin_;
};

/// The surface seen from a point y: mu = cosine to the normal at y, psi = azimuth/(2 pi) from an
/// axis fixed in the world; the surface point is found by a ray. An element dmu dpsi covers 2 pi
/// dmu dpsi steradians. The chart ends near the pole (mu > 1 - 1e-4) and near the horizon.
class HemisphereChart {
 public:
    static constexpr bool kAffine = false;
    static constexpr bool kPeriodic = true;

    /// y        where rays start [m, world]
    /// normal   at y, unit; its side is chosen so that `seen` lies above the horizon
    /// seen     a point of the surface [m, world]; also the origin of the chart's positions
    /// rounding_m   of world coordinates
    HemisphereChart(const Scene& scene,
                    const core::Vec3& y,
                    const core::Vec3& normal,
                    const core::Vec3& seen,
                    double rounding_m);

    /// The first surface along the direction of xi.
    std::optional<ChartPoint> at(const core::Vec2& xi) const;

    /// The plane of `facet` along the direction of xi; no ray.
    std::optional<ChartPoint> on_facet(const core::Vec2& xi, std::uint32_t facet) const;

    /// Whether a world point lies in the hemisphere of the chart.
    bool is_above(const core::Vec3& position) const {
        return world_from_local_.col(2).dot(position - y_) > 0.0;
    }

    /// Coordinates of a world point; nullopt near pole and horizon.
    std::optional<core::Vec2> coordinates_of(const core::Vec3& position) const;

 private:
    const Scene* scene_;
    core::Vec3 y_;
    core::Vec3 origin_;
    double rounding_m_;
    core::Mat3 world_from_local_;
};

}  // namespace renderer
