// SPDX-License-Identifier: MIT
#include "tests/support/hard_shift_cases.h"

#include "renderer/core/sampling.h"
#include "tests/support/test_scenes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace test_support {
namespace {

using core::Rng;
using core::Vec2;
using core::Vec3;
using renderer::Chart;
using renderer::FocusPair;

// Any size from 1 down to 1e-13.
double any_smallness(Rng& rng) {
    return std::pow(10.0, -13.0 * rng.uniform());
}

Vec3 above(const renderer::Facet& facet, double size, Rng& rng) {
    const Vec3 direction = random_direction(rng);
    const double side = facet.normal.dot(direction) < 0.0 ? -1.0 : 1.0;
    return size * (0.2 + 2.0 * rng.uniform()) * side * direction;
}

// Foci relative to x.
FocusPair draw_foci(HardShift kind, const renderer::Facet& facet, double size, Rng& rng) {
    FocusPair foci{above(facet, size, rng), above(facet, size, rng)};
    const Vec3& n = facet.normal;
    switch (kind) {
        case HardShift::NearTangentPoint: {
            // The mirrored path crosses the plane at a point; move everything to bring it to x.
            const double za = n.dot(foci.a);
            const double zb = n.dot(foci.b);
            const Vec3 a = foci.a - za * n;
            const Vec3 b = foci.b - zb * n;
            const Vec3 crossing = a + za / (za + zb) * (b - a);
            const Vec3 aside = random_direction(rng);
            const Vec3 near = any_smallness(rng) * size * (aside - n.dot(aside) * n);
            return {foci.a - crossing + near, foci.b - crossing + near};
        }
        case HardShift::NearSegment:
            foci.b = -rng.uniform() * foci.a + any_smallness(rng) * size * random_direction(rng);
            return foci;
        case HardShift::CoincidentFoci:
            foci.b = foci.a;
            if (rng.uniform() < 0.7) foci.b += any_smallness(rng) * size * random_direction(rng);
            return foci;
        case HardShift::EdgeOn:
            foci.a -= n.dot(foci.a) * n;
            if (rng.uniform() < 0.7) foci.a += any_smallness(rng) * size * n;
            if (rng.uniform() < 0.5) foci.b -= (1.0 - any_smallness(rng)) * n.dot(foci.b) * n;
            return foci;
        case HardShift::FocusOnSurface:
            foci.a *= any_smallness(rng);
            return foci;
        case HardShift::FociFarAway:
            foci.a *= std::min(1000.0, 1000.0 / size);  // to 1 km
            if (rng.uniform() < 0.7) foci.b *= std::min(1000.0, 1000.0 / size);
            return foci;
        case HardShift::Generic:
        case HardShift::LargeMove:
        case HardShift::ShortestLength:
            break;
    }
    return foci;
}

// Shortest length over the facet's plane.
double shortest_length(const FocusPair& foci, const Vec3& normal) {
    const double za = normal.dot(foci.a);
    const double zb = normal.dot(foci.b);
    const Vec3 mirrored = za * zb > 0.0 ? Vec3(foci.b - 2.0 * zb * normal) : foci.b;
    return (foci.a - mirrored).norm();
}

ShiftCase draw_case(HardShift kind, const renderer::Scene& scene, double size, Rng& rng) {
    ShiftCase c;
    c.x.facet = static_cast<std::uint32_t>(rng.uniform() * double(scene.facets().size()));
    const renderer::Facet& facet = scene.facet(c.x.facet);
    const Vec2 b = core::sample_triangle({rng.uniform(), rng.uniform()});
    c.x.position = facet.point(b.x(), b.y());
    const FocusPair source = draw_foci(kind, facet, size, rng);
    FocusPair target = source;
    const double move = kind == HardShift::LargeMove ? 0.5 : 0.1 * any_smallness(rng);
    target.a += move * size * random_direction(rng);
    target.b += kind == HardShift::CoincidentFoci ? Vec3(target.a - source.a)
                                                  : Vec3(move * size * random_direction(rng));
    const Vec3 zero = Vec3::Zero();
    double length = target.opl_m(zero);
    if (kind == HardShift::ShortestLength) {
        length = shortest_length(target, facet.normal) *
                 (1.0 + (rng.uniform() - 0.3) * any_smallness(rng));
    } else {
        const double change = kind == HardShift::LargeMove ? 0.5 : any_smallness(rng);
        length *= 1.0 + change * (rng.uniform() - 0.5);
    }
    c.change.ratio = rng.uniform() < 0.5 ? 1.0 : std::pow(5.0, 2.0 * rng.uniform() - 1.0);
    c.change.offset_m = length - c.change.ratio * source.opl_m(zero);
    c.source = {c.x.position + source.a, c.x.position + source.b, random_direction(rng)};
    c.target = {c.x.position + target.a, c.x.position + target.b, c.source.normal_y};
    return c;
}

double length_of(const renderer::ShiftEnd& end, const Vec3& x) {
    return (end.a - x).norm() + (x - end.y).norm();
}

// Whether the source lies, as far as rounding can tell, where shifts begin to be refused or to lead
// elsewhere: one of eight points around it, at 1e-8 segments, fails or ends far from the others.
bool is_at_edge(const renderer::ShiftMapping& mapping,
                const renderer::Facet& facet,
                const ShiftCase& c,
                const renderer::ShiftedPath& there) {
    const double segments = length_of(c.source, c.x.position);
    const Vec3 across = facet.normal.unitOrthogonal();
    const Vec3 along = facet.normal.cross(across);
    const double step = 1e-8 * segments + 1e-15 * c.x.position.cwiseAbs().maxCoeff();
    for (int i = 0; i < 8; ++i) {
        ShiftCase next = c;
        const double angle = i * core::kPi / 4.0;
        next.x.position += step * (std::cos(angle) * across + std::sin(angle) * along);
        renderer::ShiftCounts counts;
        const auto moved = shift(mapping, next, counts);
        if (!moved || (moved->point.position - there.point.position).norm() > 1e-6 * segments) {
            return true;
        }
    }
    return false;
}

constexpr std::string_view kAtEdge = "at edge";

// What is wrong with an accepted shift; empty when nothing is, kAtEdge where the way back is
// refused because of rounding next to the edge of what can be shifted.
std::string fault_of(const renderer::Scene& scene,
                     const renderer::ShiftMapping& mapping,
                     const ShiftCase& c,
                     const renderer::ShiftedPath& there) {
    const Vec3& x = there.point.position;
    if (!x.allFinite() || !std::isfinite(there.jacobian)) return "not finite";
    const double stretch = there.jacobian / c.change.ratio;
    if (!(stretch >= 0.05 * (1 - 1e-12) && stretch <= 20.0 * (1 + 1e-12))) return "jacobian bound";

    const double coordinate = x.cwiseAbs().maxCoeff();
    const double rounding = 8e-16 * coordinate;
    const double wanted = c.change.ratio * length_of(c.source, c.x.position) + c.change.offset_m;
    const double residual = std::abs(length_of(c.target, x) - wanted);
    if (!(residual <= 2e-9 * std::min(1.0, wanted) + 1e-13 * wanted + 4.0 * rounding)) {
        return fmt::format("length off by {} of {}", residual, wanted);
    }
    const renderer::Facet& facet = scene.facet(there.point.facet);
    const double segments = length_of(c.source, c.x.position);
    const double height = std::abs(facet.normal.dot(x - facet.corner));
    const double size = std::sqrt(facet.area_m2);
    if (!(height <= 1e-9 * size + 4.0 * rounding)) {
        return fmt::format("{} off its facet's plane", height);
    }
    const Vec2 b = renderer::barycentric_of(facet, x);
    if (!(std::min({b.x(), b.y(), 1.0 - b.x() - b.y()}) >= -1e-5)) return "outside its facet";

    renderer::ShiftCounts counts;
    const auto back = shift(mapping, c.inverse(there.point), counts);
    if (!back) {
        if (is_at_edge(mapping, scene.facet(c.x.facet), c, there)) return std::string(kAtEdge);
        const auto reason = std::find(counts.rejected.begin(), counts.rejected.end(), 1U);
        return fmt::format(
            "no way back: {}",
            renderer::kShiftRejectionNames[std::size_t(reason - counts.rejected.begin())]);
    }
    const double distance = (back->point.position - c.x.position).norm();
    if (!(distance <= 1e-6 * segments)) return fmt::format("comes back {} away", distance);
    const double product = there.jacobian * back->jacobian;
    const double segment = std::min((c.target.a - x).norm(), (c.target.y - x).norm());
    if (!(std::abs(product - 1.0) <= 1e-6 + 200.0 * rounding / segment))
        return fmt::format("J_f J_r = {}", product);
    return "";
}

}  // namespace

HardShiftBench::Tally& HardShiftBench::Tally::operator+=(const Tally& other) {
    for (std::size_t i = 0; i < tried.size(); ++i) {
        tried[i] += other.tried[i];
        accepted[i] += other.accepted[i];
    }
    at_edge += other.at_edge;
    if (wrong == 0) first_wrong = other.first_wrong;
    wrong += other.wrong;
    return *this;
}

HardShiftBench::HardShiftBench() {
    const auto settings_of = [](Chart chart, bool closed_form) {
        renderer::ShiftSettings settings;
        settings.chart = chart;
        settings.closed_form_on_planes = closed_form;
        return settings;
    };
    for (const double size : {1e-4, 1.0, 100.0}) {
        for (const Vec3& centre : {Vec3(0.0, 0.0, 0.0), Vec3(600.0, -700.0, 400.0)}) {
            Stage stage{size, centre, nullptr, {}};
            std::vector<renderer::Object> objects{
                tilted_quad(centre, size),
                wavy_sheet(centre - 0.5 * size * Vec3::UnitZ(), 0.5 * size, 12, 0.05 * size)};
            stage.scene = std::make_unique<renderer::Scene>(scene_of(std::move(objects), centre));
            for (const auto& settings : {settings_of(Chart::Plane, true),
                                         settings_of(Chart::Plane, false),
                                         settings_of(Chart::Barycentric, false),
                                         settings_of(Chart::Hemisphere, false),
                                         settings_of(Chart::Adaptive, true)}) {
                stage.mappings.emplace_back(*stage.scene, settings);
            }
            stages_.push_back(std::move(stage));
        }
    }
}

HardShiftBench::Tally HardShiftBench::run(std::uint64_t begin, std::uint64_t end) const {
    Tally tally;
    for (std::uint64_t i = begin; i < end; ++i) {
        Rng rng(0x68617264, i, 0);
        const std::size_t kind = i % kHardShiftNames.size();
        const Stage& stage = stages_[i / kHardShiftNames.size() % stages_.size()];
        // Half of all shifts by the fast path; rays cost ten times as much.
        const double pick = rng.uniform();
        const std::size_t chart =
            pick < 0.5 ? 0 : (pick < 0.7 ? 1 : (pick < 0.85 ? 2 : (pick < 0.925 ? 3 : 4)));
        const ShiftCase c =
            draw_case(static_cast<HardShift>(kind), *stage.scene, stage.size_m, rng);
        const renderer::ShiftMapping& mapping = stage.mappings[chart];
        renderer::ShiftCounts counts;
        const auto there = shift(mapping, c, counts);
        ++tally.tried[kind];
        if (!there) continue;
        ++tally.accepted[kind];
        const std::string fault = fault_of(*stage.scene, mapping, c, *there);
        if (fault == kAtEdge) ++tally.at_edge;
        if (fault.empty() || fault == kAtEdge) continue;
        if (tally.wrong++ == 0) {
            tally.first_wrong = fmt::format("shift {} ({}, size {} m, centre x {} m, chart {}): {}",
                                            i,
                                            kHardShiftNames[kind],
                                            stage.size_m,
                                            stage.centre.x(),
                                            chart,
                                            fault);
        }
    }
    return tally;
}

}  // namespace test_support
