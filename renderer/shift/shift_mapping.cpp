// SPDX-License-Identifier: MIT
#include "renderer/shift/shift_mapping.h"

#include "renderer/core/error.h"
#include "renderer/shift/charts.h"
#include "renderer/shift/path_functional.h"
#include "renderer/shift/shift_flow.h"
#include "renderer/shift/shift_side.h"
#include "renderer/shift/shift_solver.h"

#include <algorithm>
#include <array>
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

// One call of shift_path().
class ShiftMapping::Attempt {
 public:
    using Result = std::optional<ShiftedPath>;

    Attempt(const ShiftMapping& mapping,
            const SurfacePoint& x,
            const ShiftEnd& source,
            const ShiftEnd& target,
            const ConstraintChange& change)
        : mapping_(mapping), x_(x), source_(source), target_(target), change_(change) {}

    Result shift() {
        switch (mapping_.settings_.chart) {
            case Chart::Plane:
                return shift_by_plane();
            case Chart::Barycentric:
                return shift_in_facet();
            case Chart::Hemisphere:
                by_ray_ = true;
                return shift_by_ray();
            case Chart::Adaptive:
            case Chart::Custom:
                break;
        }
        return shift_adaptively();
    }
    const ShiftTrace& trace() const { return trace_; }
    bool by_ray() const { return by_ray_; }

 private:
    // Points from which the plane route has a result take it; its results are the points from which
    // the plane route leads back. All others take the ray, and keep only results from which the
    // plane route does not lead back: two one-to-one maps with disjoint images.
    Result shift_adaptively() {
        if (const Result by_plane = shift_by_plane()) return by_plane;
        const Result result = shift_by_ray();
        if (!result) return std::nullopt;
        Attempt back(mapping_, result->point, target_, source_, change_.inverse());
        if (back.shift_by_plane()) return trace_.reject(ShiftRejection::OtherRoute);
        trace_.iterations += back.trace_.iterations;
        by_ray_ = true;
        return result;
    }

    Result shift_by_plane() {
        const PlanarPatches& patches = mapping_.patches_;
        const std::uint32_t patch = patches.patch_of(x_.facet);
        const bool in_closed_form = mapping_.settings_.closed_form_on_planes &&
                                    mapping_.settings_.gauge == Gauge::Average &&
                                    mapping_.quantity_ == ShiftQuantity::PathLength;
        std::optional<PlaneShift> shift;
        if (in_closed_form) {
            shift = shift_on_plane(patches.plane(patch),
                                   {source_.a - x_.position, source_.y - x_.position},
                                   {target_.a - x_.position, target_.y - x_.position},
                                   change_,
                                   mapping_.rounding_m_,
                                   trace_);
        } else if (const auto solution =
                       solve_on_plane(patches.plane(patch), Vec3::Zero(), Vec2::Zero())) {
            shift = {solution->at_target.position, solution->jacobian};
        }
        if (!shift) return std::nullopt;
        const Vec3 position = x_.position + shift->displacement;
        const auto facet = patches.locate(patch, position, x_.facet);
        if (!facet) return trace_.reject(ShiftRejection::LeftSurface);
        if (in_closed_form && !is_bounded(shift->jacobian, change_.ratio)) {
            return trace_.reject(ShiftRejection::JacobianBound);
        }
        return ShiftedPath{{position, *facet}, shift->jacobian};
    }

    Result shift_in_facet() {
        const Facet& facet = mapping_.scene_->facet(x_.facet);
        const auto solution =
            solve_on_plane(facet, facet.corner - x_.position, barycentric_of(facet, x_.position));
        if (!solution) return std::nullopt;
        if (!is_in_triangle(solution->xi)) return trace_.reject(ShiftRejection::LeftSurface);
        return ShiftedPath{{x_.position + solution->at_target.position, x_.facet},
                           solution->jacobian};
    }

    // In the coordinates that the plane's edges span from `origin`; xi: those of the vertex.
    std::optional<ShiftSolution> solve_on_plane(const Facet& plane,
                                                const Vec3& origin,
                                                const Vec2& xi) {
        const AffineChart chart{origin,
                                plane.edge1,
                                plane.edge2,
                                mapping_.scene_->object_of(x_.facet).velocity_m_per_s,
                                mapping_.rounding_m_};
        return solve<AffineChart>({chart, chart}, xi, *chart.at(xi));
    }

    Result shift_by_ray() {
        const Vec3& x = x_.position;
        const auto chart_of = [&](const ShiftEnd& end) {
            return HemisphereChart(*mapping_.scene_, end.y, end.normal_y, x, mapping_.rounding_m_);
        };
        const std::array charts{chart_of(source_), chart_of(target_)};
        const auto xi = charts[0].coordinates_of(x);
        if (!xi) return trace_.reject(ShiftRejection::LeftChart);
        auto at_x = charts[0].on_facet(*xi, x_.facet);
        if (!at_x) return trace_.reject(ShiftRejection::LeftChart);
        at_x->position.setZero();  // exactly, whatever the coordinates' rounding
        const auto solution = solve(charts, *xi, *at_x);
        if (!solution) return std::nullopt;
        // The reverse shift must use the same hemisphere at the source.
        if (!charts[0].is_above(x + solution->at_target.position)) {
            return trace_.reject(ShiftRejection::LeftChart);
        }
        return ShiftedPath{{x + solution->at_target.position, solution->at_target.facet},
                           solution->jacobian};
    }

    template <class Chart>
    std::optional<ShiftSolution> solve(const std::array<Chart, 2>& charts,
                                       const Vec2& xi,
                                       const ChartPoint& at_x) {
        const auto check = mapping_.settings_.reverse_check ? ReverseCheck::On : ReverseCheck::Off;
        const auto with = [&](const auto& at_source_end, const auto& at_target_end) {
            using Functional = std::remove_cvref_t<decltype(at_source_end)>;
            const ShiftSide<Chart, Functional> source{charts[0], at_source_end, change_.ratio};
            const ShiftSide<Chart, Functional> target{charts[1], at_target_end, 1.0};
            const ShiftProblem problem{source, target, change_.offset_m};
            const ChartExpansion at_source = source.expand(at_x);
            return std::visit(
                [&](const auto& gauge) {
                    return shift_on_charts(gauge, problem, xi, at_source, check, trace_);
                },
                mapping_.gauge_);
        };
        const Vec3& origin = x_.position;
        const auto solution = mapping_.quantity_ == ShiftQuantity::PathVelocity
                                  ? with(velocity_of(source_, origin), velocity_of(target_, origin))
                                  : with(length_of(source_, origin), length_of(target_, origin));
        if (solution && !is_bounded(solution->jacobian, change_.ratio)) {
            return trace_.reject(ShiftRejection::JacobianBound);
        }
        return solution;
    }

    const ShiftMapping& mapping_;
    const SurfacePoint& x_;
    const ShiftEnd& source_;
    const ShiftEnd& target_;
    const ConstraintChange change_;
    ShiftTrace trace_;
    bool by_ray_ = false;
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
    Attempt attempt(*this, x, source, target, change);
    const auto result = attempt.shift();
    counts.iterations += static_cast<std::uint64_t>(attempt.trace().iterations);
    if (!result) {
        ++counts.rejected[static_cast<std::size_t>(attempt.trace().rejection)];
        return std::nullopt;
    }
    ++counts.accepted;
    counts.by_ray += attempt.by_ray() ? 1 : 0;
    return result;
}

}  // namespace renderer
