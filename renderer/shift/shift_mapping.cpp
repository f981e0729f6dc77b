// SPDX-License-Identifier: MIT
#include "renderer/shift/shift_mapping.h"

#include "renderer/core/error.h"
#include "renderer/shift/charts.h"
#include "renderer/shift/path_functional.h"
#include "renderer/shift/shift_flow.h"
#include "renderer/shift/shift_side.h"
#include "renderer/shift/shift_solver.h"

#include <algorithm>
#include <limits>
#include <type_traits>
#include <variant>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

// Rounding of the scene's coordinates [m].
double rounding_of(const Scene& scene) {
    double largest = 0.0;
    for (const Facet& facet : scene.facets()) {
        largest = std::max(largest, facet.corner.cwiseAbs().maxCoeff());
    }
    return std::numeric_limits<double>::epsilon() * largest;
}

AnyGauge make_gauge(const ShiftSettings& settings) {
    switch (settings.gauge) {
        case Gauge::Start:
            return StartGauge{};
        case Gauge::Fixed:
            return FixedGauge{};
        case Gauge::Midpoint:
            return MidpointGauge{};
        case Gauge::Symmetric:
            return SymmetricGauge{};
        case Gauge::Flow:
            return FlowGauge{};
        case Gauge::Average:
            break;
    }
    // On planes both are the same, and the plain one is cheaper.
    if (settings.metric_gauge && settings.chart != Chart::Plane) return MetricAverageGauge{};
    return AverageGauge{};
}

// Whether a shift changes areas by at most this factor, either way, beside the ratio S of the
// gates.
bool is_bounded(double jacobian, double ratio) {
    constexpr double kJacobianBound = 20.0;
    const double stretch = jacobian / ratio;
    return stretch * kJacobianBound >= 1.0 && stretch <= kJacobianBound;
}

// The kept quantity at one end, foci relative to `origin`.
OpticalLength length_of(const ShiftEnd& end, const Vec3& origin) {
    return {end.a - origin, end.y - origin};
}
PathVelocity velocity_of(const ShiftEnd& end, const Vec3& origin) {
    return {end.a - origin, end.y - origin, end.velocity_a, end.velocity_y};
}

}  // namespace

// One call of shift_path.
struct ShiftMapping::Task {
    using Result = std::optional<ShiftedPath>;

    const ShiftMapping& mapping;
    const SurfacePoint& x;
    const ShiftEnd& source;
    const ShiftEnd& target;
    ConstraintChange change;
    ShiftTrace& trace;
    bool by_ray = false;

    FocusPair foci_of(const ShiftEnd& end) const {
        return {end.a - x.position, end.y - x.position};
    }

    Result shift_by_route() {
        switch (mapping.settings_.chart) {
            case Chart::Plane:
                return shift_by_plane();
            case Chart::Barycentric:
                return shift_in_facet();
            case Chart::Hemisphere:
                by_ray = true;
                return shift_by_ray();
            case Chart::Adaptive:
            case Chart::Custom:
                break;
        }
        return shift_adaptively();
    }

    // Let P be the points from which the plane route has a result. From P take the plane; its
    // results are the points from which the plane route leads back. From elsewhere take the ray,
    // and keep only results from which the plane route has no way back: two one-to-one maps with
    // separate images.
    Result shift_adaptively() {
        if (const Result by_plane = shift_by_plane()) return by_plane;
        const Result result = shift_by_ray();
        if (!result) return std::nullopt;
        ShiftTrace back_trace;
        Task back{mapping, result->point, target, source, change.inverse(), back_trace};
        if (back.shift_by_plane()) return trace.reject(ShiftRejection::OtherRoute);
        trace.iterations += back_trace.iterations;
        by_ray = true;
        return result;
    }

    Result shift_in_closed_form() {
        const std::uint32_t patch = mapping.patches_.patch_of(x.facet);
        const auto shift = shift_on_plane(mapping.patches_.plane(patch),
                                          foci_of(source),
                                          foci_of(target),
                                          change,
                                          mapping.rounding_m_,
                                          trace);
        if (!shift) return std::nullopt;
        const Vec3 position = x.position + shift->displacement;
        const auto facet = mapping.patches_.locate(patch, position, x.facet);
        if (!facet) return trace.reject(ShiftRejection::LeftSurface);
        if (!is_bounded(shift->jacobian, change.ratio)) {
            return trace.reject(ShiftRejection::JacobianBound);
        }
        return ShiftedPath{{position, *facet}, shift->jacobian};
    }

    Result shift_by_plane() {
        if (mapping.settings_.closed_form_on_planes && mapping.settings_.gauge == Gauge::Average &&
            mapping.quantity_ == ShiftQuantity::PathLength) {
            return shift_in_closed_form();
        }
        const std::uint32_t patch = mapping.patches_.patch_of(x.facet);
        const auto solution =
            solve_on_plane(mapping.patches_.plane(patch), Vec3::Zero(), Vec2::Zero());
        if (!solution) return std::nullopt;
        const Vec3 position = x.position + solution->at_target.position;
        const auto facet = mapping.patches_.locate(patch, position, x.facet);
        if (!facet) return trace.reject(ShiftRejection::LeftSurface);
        return ShiftedPath{{position, *facet}, solution->jacobian};
    }

    Result shift_in_facet() {
        const Facet& facet = mapping.scene_->facet(x.facet);
        const auto solution =
            solve_on_plane(facet, facet.corner - x.position, barycentric_of(facet, x.position));
        if (!solution) return std::nullopt;
        if (!is_in_triangle(solution->xi)) return trace.reject(ShiftRejection::LeftSurface);
        return ShiftedPath{{x.position + solution->at_target.position, x.facet},
                           solution->jacobian};
    }

    std::optional<ShiftSolution> solve_on_plane(const Facet& plane,
                                                const Vec3& origin,
                                                const Vec2& xi) {
        const AffineChart chart{origin,
                                plane.edge1,
                                plane.edge2,
                                mapping.scene_->object_of(x.facet).velocity_m_per_s,
                                mapping.rounding_m_};
        return solve<AffineChart>({chart, chart}, xi, *chart.at(xi));
    }

    Result shift_by_ray() {
        const Vec3& origin = x.position;
        const auto chart_of = [&](const ShiftEnd& end) {
            return HemisphereChart(
                *mapping.scene_, end.y, end.normal_y, origin, mapping.rounding_m_);
        };
        const std::array charts{chart_of(source), chart_of(target)};
        const auto xi = charts[0].coordinates_of(origin);
        if (!xi) return trace.reject(ShiftRejection::LeftChart);
        auto at_x = charts[0].on_facet(*xi, x.facet);
        if (!at_x) return trace.reject(ShiftRejection::LeftChart);
        at_x->position.setZero();  // exactly, whatever the coordinates' rounding
        const auto solution = solve(charts, *xi, *at_x);
        if (!solution) return std::nullopt;
        // From the far end the source's chart must show the same side of y.
        if (!charts[0].is_above(origin + solution->at_target.position)) {
            return trace.reject(ShiftRejection::LeftChart);
        }
        return ShiftedPath{{origin + solution->at_target.position, solution->at_target.facet},
                           solution->jacobian};
    }

    template <class Chart>
    std::optional<ShiftSolution> solve(const std::array<Chart, 2>& charts,
                                       const Vec2& xi,
                                       const ChartPoint& at_x) {
        const auto check = mapping.settings_.reverse_check ? ReverseCheck::On : ReverseCheck::Off;
        const auto with = [&](const auto& functional_of) {
            using Functional = std::remove_cvref_t<decltype(functional_of(source))>;
            const ShiftSide<Chart, Functional> from{charts[0], functional_of(source), change.ratio};
            const ShiftSide<Chart, Functional> to{charts[1], functional_of(target), 1.0};
            const ShiftProblem<ShiftSide<Chart, Functional>, ShiftSide<Chart, Functional>> problem{
                from, to, change.offset_m};
            const ChartExpansion at_source = from.expand(at_x);
            return std::visit(
                [&](const auto& gauge) {
                    return shift_on_charts(gauge, problem, xi, at_source, check, trace);
                },
                mapping.gauge_);
        };
        const Vec3& origin = x.position;
        const auto solution =
            mapping.quantity_ == ShiftQuantity::PathVelocity
                ? with([&](const ShiftEnd& end) { return velocity_of(end, origin); })
                : with([&](const ShiftEnd& end) { return length_of(end, origin); });
        if (solution && !is_bounded(solution->jacobian, change.ratio)) {
            return trace.reject(ShiftRejection::JacobianBound);
        }
        return solution;
    }
};

ShiftMapping::ShiftMapping(const Scene& scene,
                           const ShiftSettings& settings,
                           ShiftQuantity quantity)
    : scene_(&scene),
      settings_(settings),
      quantity_(quantity),
      gauge_(make_gauge(settings)),
      rounding_m_(rounding_of(scene)),
      patches_(scene) {
    if (settings.chart == Chart::Custom) {
        throw core::Error("chart",
                          "custom",
                          "must be plane, hemisphere, barycentric or adaptive for triangle meshes; "
                          "custom charts are written in C++");
    }
}

std::optional<ShiftedPath> ShiftMapping::shift_path(const SurfacePoint& x,
                                                    const ShiftEnd& source,
                                                    const ShiftEnd& target,
                                                    const ConstraintChange& change,
                                                    ShiftCounts& counts) const {
    ShiftTrace trace;
    Task task{*this, x, source, target, change, trace};
    const auto result = task.shift_by_route();
    counts.iterations += static_cast<std::uint64_t>(trace.iterations);
    if (!result) {
        ++counts.rejected[static_cast<std::size_t>(trace.rejection)];
        return std::nullopt;
    }
    ++counts.accepted;
    counts.by_ray += task.by_ray ? 1 : 0;
    return result;
}

}  // namespace renderer
