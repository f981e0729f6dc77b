// SPDX-License-Identifier: MIT
#include "renderer/restir/restir_frame.h"

namespace renderer {
namespace {

using core::Vec3;

std::optional<ShiftMapping> make_shift(const Scene& scene,
                                       const RestirSettings& settings,
                                       const core::HistogramAxes& axes) {
    if (settings.reuse != Reuse::PathLength) return std::nullopt;
    return ShiftMapping(
        scene,
        {.chart = settings.chart, .gauge = settings.gauge, .reverse_check = settings.reverse_check},
        axes.velocity ? ShiftQuantity::PathVelocity : ShiftQuantity::PathLength);
}

// Displacement of a facet between two scenes.
Vec3 motion(const RestirScene& from, const RestirScene& to, std::uint32_t facet) {
    if (&from == &to) return Vec3::Zero();
    return to.scene->facet(facet).corner - from.scene->facet(facet).corner;
}

// The optical path without the two segments of its first vertex.
OpticalPath rest_of(const ReservoirDomain& side, const ReusablePath& path) {
    const Scene& scene = *side.scene->scene;
    OpticalPath rest = side.domain->extra();
    if (path.num_vertices == 1) return rest;
    for (int i = 2; i < path.num_vertices; ++i) {
        rest.add_segment(path.at(i).position - path.at(i - 1).position,
                         scene.velocity_m_per_s(path.at(i - 1).facet),
                         scene.velocity_m_per_s(path.at(i).facet));
    }
    const PathEndpoint& light = side.domain->ends.light;
    rest.add_segment(light.position - path.last().position,
                     scene.velocity_m_per_s(path.last().facet),
                     light.velocity_m_per_s);
    return rest;
}

// How the two segments of the first vertex must change for a path to fit its new domain. All
// velocity bins have the same width.
ConstraintChange change_between(const ReservoirDomain& from,
                                const ReusablePath& path_from,
                                const ReservoirDomain& to,
                                const ReusablePath& path_to) {
    const OpticalPath rest_from = rest_of(from, path_from);
    const OpticalPath rest_to = rest_of(to, path_to);
    ConstraintChange change;
    if (from.gate.velocity) {
        change.offset_m = to.gate.velocity->start_m_per_s() - rest_to.velocity_m_per_s -
                          (from.gate.velocity->start_m_per_s() - rest_from.velocity_m_per_s);
        return change;
    }
    change.ratio = to.gate.time.width_m / from.gate.time.width_m;
    change.offset_m = to.gate.time.start_m - rest_to.opl_m -
                      change.ratio * (from.gate.time.start_m - rest_from.opl_m);
    return change;
}

// Neighbours of the first vertex, moved along with it.
ShiftEnd shift_end(const ReservoirDomain& side, const ReusablePath& path, const Vec3& moved) {
    ShiftEnd end;
    const Scene& scene = *side.scene->scene;
    end.a = side.domain->start() + moved;
    end.velocity_a = side.domain->start_velocity(scene);
    if (path.num_vertices == 1) {
        end.y = side.domain->ends.light.position + moved;
        end.normal_y = side.domain->ends.light.normal;
        end.velocity_y = side.domain->ends.light.velocity_m_per_s;
    } else {
        end.y = path.at(1).position + moved;
        end.normal_y = scene.facet(path.at(1).facet).normal;
        end.velocity_y = scene.velocity_m_per_s(path.at(1).facet);
    }
    return end;
}

bool is_same(const ShiftEnd& a, const ShiftEnd& b) {
    return a.a == b.a && a.y == b.y && a.velocity_a == b.velocity_a && a.velocity_y == b.velocity_y;
}

// Whether the path velocity of the two segments is 0 wherever the vertex lies on its surface.
bool is_at_rest(const ShiftEnd& end, const Vec3& surface_velocity) {
    return end.velocity_a == surface_velocity && end.velocity_y == surface_velocity;
}

// Moves the first vertex of `path`, whose other vertices are in place already.
// returns   the Jacobian; nothing when the shift is not defined
std::optional<double> shift_first(const PathReservoir& reservoir,
                                  const ReservoirDomain& from,
                                  const ReservoirDomain& to,
                                  const RestirScene& current,
                                  ReusablePath& path,
                                  ShiftCounts& counts) {
    const std::uint32_t facet = path.first().facet;
    const Vec3 from_moved = motion(*from.scene, current, facet);
    const Vec3 to_moved = motion(*to.scene, current, facet);
    const ShiftEnd source = shift_end(from, reservoir.sample, from_moved);
    const ShiftEnd target = shift_end(to, path, to_moved);
    const ConstraintChange change = change_between(from, reservoir.sample, to, path);
    SurfacePoint& x = path.at(0);
    const Vec3& velocity = current.scene->velocity_m_per_s(facet);
    // Where nothing moves there is no velocity to change: the vertex stays, in both directions.
    const bool stays =
        from.gate.velocity && is_at_rest(source, velocity) && is_at_rest(target, velocity);
    if (stays || (change.ratio == 1.0 && change.offset_m == 0.0 && is_same(source, target))) {
        x.position = reservoir.sample.first().position + from_moved - to_moved;
        return 1.0;
    }
    const SurfacePoint start{reservoir.sample.first().position + from_moved, facet};
    const auto shifted = current.shift->shift_path(start, source, target, change, counts);
    if (!shifted) return std::nullopt;
    // The vertex may have reached an object with another motion, from where it would be brought to
    // another place on the way back.
    const std::uint32_t reached = shifted->point.facet;
    if (motion(*from.scene, current, reached) != from_moved) return std::nullopt;
    if (motion(*to.scene, current, reached) != to_moved) return std::nullopt;
    x = shifted->point;
    x.position -= to_moved;
    return shifted->jacobian;
}

// Whether the segments changed by a shift are unoccluded.
bool is_unoccluded(const ReservoirDomain& from,
                   const ReservoirDomain& to,
                   const ReusablePath& path,
                   std::uint64_t& num_rays) {
    const PathIntegrand& integrand = to.scene->candidates.integrand();
    if (from.scene != to.scene) return !integrand.is_any_blocked(*to.domain, path, num_rays);
    const bool there_and_back = to.domain->ends.coincide && path.num_vertices == 1;
    const bool light_moved =
        path.num_vertices > 1 && from.domain->ends.light.position != to.domain->ends.light.position;
    for (const int segment : {0, 1, path.num_vertices}) {
        if (segment == 1 && there_and_back) break;
        if (segment > 1 && !light_moved) break;
        ++num_rays;
        if (integrand.is_blocked(*to.domain, path, segment)) return false;
        if (segment == 1 && path.num_vertices == 1) break;
    }
    return true;
}

}  // namespace

std::optional<std::size_t> ReservoirBins::bin_of(const OpticalPath& path) const {
    // A shaped gate reaches beyond its bin.
    const auto time = axes_.time.num_bins == 1 ? 0 : axes_.time.bin_of(path.opl_m);
    if (!time) return std::nullopt;
    if (!axes_.velocity) return static_cast<std::size_t>(*time);
    const auto velocity = axes_.velocity->bin_of(path.velocity_m_per_s);
    if (!velocity) return num_velocity_values();
    const std::size_t first = static_cast<std::size_t>(*velocity) * stride();
    return first + (axes_.velocity->with_time ? static_cast<std::size_t>(*time) : 0);
}

PathGate ReservoirBins::gate(std::size_t bin) const {
    if (!axes_.velocity) {
        return {TimeGate::of_bin(axes_.time, static_cast<int>(bin), shape_), std::nullopt};
    }
    const VelocityGate velocity{*axes_.velocity, static_cast<int>(bin / stride())};
    if (!axes_.velocity->with_time) return {lengths(), velocity};
    return {TimeGate::of_bin(axes_.time, static_cast<int>(bin % stride()), shape_), velocity};
}

std::optional<std::size_t> ReservoirBins::beside(std::size_t bin, int step) const {
    const std::size_t last = axes_.velocity ? num_velocity_values() : count();
    if (step < 0) return bin >= stride() ? std::optional(bin - stride()) : std::nullopt;
    return bin + stride() < last ? std::optional(bin + stride()) : std::nullopt;
}

std::optional<int> ReservoirBins::time_bin(std::size_t bin) const {
    if (axes_.time.num_bins == 1) return 0;
    if (!axes_.velocity) return static_cast<int>(bin);
    if (!axes_.velocity->with_time || is_left_out(bin)) return std::nullopt;
    return static_cast<int>(bin % stride());
}

std::optional<int> ReservoirBins::velocity_bin(std::size_t bin) const {
    if (!axes_.velocity || is_left_out(bin)) return std::nullopt;
    return static_cast<int>(bin / stride());
}

RestirScene::RestirScene(std::shared_ptr<const Scene> scene_of_frames,
                         const core::Scan& scan,
                         const core::HistogramAxes& axes,
                         const RenderSettings& settings)
    : scene(std::move(scene_of_frames)),
      sensor_pairs(*scene, scan),
      walk(*scene, settings.laser_spot_m2),
      candidates(*scene, scan, sensor_pairs, walk, axes.time, settings),
      shift(make_shift(*scene, settings.restir, axes)) {
    if (sensor_pairs.is_image()) pixel_positions.emplace(sensor_pairs, sensor_pairs.camera());
}

PathDomain pixel_domain(const SensorPairs& sensor_pairs,
                        std::size_t pixel,
                        const core::Vec2& pixel_u) {
    PathDomain domain;
    domain.ends = sensor_pairs.ends(pixel);
    domain.pixel_u = pixel_u;
    domain.seen = sensor_pairs.first_vertex(pixel, pixel_u);
    domain.is_dark = !domain.seen;
    return domain;
}

ShiftedSample shift_sample(const PathReservoir& reservoir,
                           ReservoirDomain from,
                           ReservoirDomain to,
                           const RestirScene& current,
                           RestirCounts& counts) {
    if (reservoir.empty()) return std::nullopt;
    Carried<ReusablePath> carried{reservoir.sample, 0.0, 1.0};
    if (from.is_same_as(to)) {
        carried.target_value = reservoir.target_value;
        return carried;
    }
    PathDomain seen_from;
    PathDomain seen_to;
    if (current.sensor_pairs.is_image()) {
        const core::Vec2& pixel_u = reservoir.sample.pixel_u;
        seen_from = pixel_domain(from.scene->sensor_pairs, from.pair, pixel_u);
        seen_to = pixel_domain(to.scene->sensor_pairs, to.pair, pixel_u);
        counts.num_rays += 2;
        from.domain = &seen_from;
        to.domain = &seen_to;
    }
    if (from.domain->is_dark || to.domain->is_dark) return std::nullopt;
    if (from.scene != to.scene) {
        for (int i = 0; i < carried.sample.num_vertices; ++i) {
            SurfacePoint& vertex = carried.sample.at(i);
            vertex.position += motion(*from.scene, *to.scene, vertex.facet);
        }
    }
    if (current.shift) {
        const auto jacobian =
            shift_first(reservoir, from, to, current, carried.sample, counts.shifts);
        if (!jacobian) return std::nullopt;
        carried.jacobian = *jacobian;
    }
    const PathValue value = to.scene->candidates.integrand().evaluate(*to.domain, carried.sample);
    carried.target_value = value.radiance * to.gate.weight(value.optical_path);
    if (!(carried.target_value > 0.0) ||
        !is_unoccluded(from, to, carried.sample, counts.num_rays)) {
        carried.target_value = 0.0;
    }
    return carried;
}

}  // namespace renderer
