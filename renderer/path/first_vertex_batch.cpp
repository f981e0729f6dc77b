// SPDX-License-Identifier: MIT
#include "renderer/path/first_vertex_batch.h"

#include "renderer/core/sampling.h"
#include "renderer/path/systematic_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace renderer {
namespace {

using core::kPi;
using core::Vec3;

// A path end as plain numbers; its factor towards a direction is the maximum of two products.
struct End {
    explicit End(const PathEndpoint& end)
        : x(end.position.x()),
          y(end.position.y()),
          z(end.position.z()),
          normal_x(end.normal.x()),
          normal_y(end.normal.y()),
          normal_z(end.normal.z()),
          constant(end.isotropic ? 1.0 : 0.0),
          strength(end.strength) {}

    double cosine(double dx, double dy, double dz) const {
        return normal_x * dx + normal_y * dy + normal_z * dz;
    }
    // PathEndpoint::factor() without the strength: 1 for isotropic ends.
    double shape(double cosine) const { return std::max(constant, (1.0 - constant) * cosine); }

    double x, y, z, normal_x, normal_y, normal_z, constant, strength;
};

}  // namespace

FacetTraits::FacetTraits(const Scene& scene, const std::vector<bool>& adds_third_bounce)
    : is_hidden_(scene.facets().size()),
      constant_(scene.facets().size()),
      varies_(scene.facets().size()) {
    for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
        is_hidden_[i] = scene.is_hidden(i) ? 1.0 : 0.0;
        if (!adds_third_bounce[scene.facet(i).object]) continue;
        any_adds_ = true;
        const Object& object = scene.object_of(i);
        const auto constant = constant_value(make_bsdf(object.material));
        if (constant && object.has_one_albedo()) {
            constant_[i] = *constant;
        } else {
            varies_[i] = 1;
            any_varies_ = true;
        }
    }
}

void FirstVertexBatch::draw_by_area(const AreaSampler& sampler, AreaDraws& draws) {
    // Lanes beyond the last number belong to no interval.
    alignas(64) std::array<double, kPadded> u1;
    alignas(64) std::array<double, kPadded> u2;
    u1.fill(1.0);
    u2.fill(0.0);
    const int size = std::min(draws.count - draws.begin, kCapacity - count_);
    for (int i = 0; i < size; ++i) {
        const core::Vec2 u = core::lattice_point(draws.begin + i, draws.count, draws.shift);
        // Rounding may lift the last number to 1.
        u1[i] = std::min(u.x(), core::kBelowOne);
        u2[i] = u.y();
    }
    for (int begin = 0; begin < size;) {
        const auto interval = sampler.interval_from(draws.hint, u1[begin]);
        begin += add_on_facet(
            sampler.facet_of(interval), interval, u1.data() + begin, u2.data() + begin);
        draws.hint = interval.index;
    }
    draws.begin += size;
}

// Appends points on a facet for increasing u1, as long as u1 lies in its interval.
//
// returns   their number
int FirstVertexBatch::add_on_facet(std::uint32_t facet,
                                   const core::DiscreteDistribution::Interval& interval,
                                   const double* u1,
                                   const double* u2) {
    using Lanes = Eigen::Array<double, kLanes, 1>;
    const auto at = [this](double* array) { return Eigen::Map<Lanes>(array + count_); };
    const Facet& on = scene_.facet(facet);
    const double is_hidden = traits_.is_hidden(facet);
    const double constant = traits_.constant(facet);
    const int begin = count_;
    int inside = kLanes;
    for (int i = 0; inside == kLanes; i += kLanes) {
        // As Interval::remap() and core::sample_triangle(), except that rounding may cross an edge.
        const Eigen::Map<const Lanes> u(u1 + i);
        const Eigen::Map<const Lanes> v(u2 + i);
        Lanes root = (u - interval.begin) * interval.inverse_width;
        for (double& value : root) value = std::sqrt(value);
        const Lanes b1 = root * (1.0 - v);
        const Lanes b2 = root * v;
        at(x_) = on.corner.x() + b1 * on.edge1.x() + b2 * on.edge2.x();
        at(y_) = on.corner.y() + b1 * on.edge1.y() + b2 * on.edge2.y();
        at(z_) = on.corner.z() + b1 * on.edge1.z() + b2 * on.edge2.z();
        at(normal_x_) = on.normal.x();
        at(normal_y_) = on.normal.y();
        at(normal_z_) = on.normal.z();
        at(is_hidden_) = is_hidden;
        at(constant_bsdf_) = constant;
        std::fill_n(facet_ + count_, kLanes, facet);
        inside = 0;
        for (int lane = 0; lane < kLanes; ++lane) inside += u1[i + lane] < interval.end ? 1 : 0;
        count_ += inside;
    }
    return count_ - begin;
}

std::uint64_t FirstVertexBatch::draw_by_direction(EndpointDirectionSampler& directions) {
    std::uint64_t num_rays = 0;
    DirectionPacket packet;
    const PathEndpoint& end = directions.end();
    while (!directions.done() && count_ + DirectionPacket::kSize <= kCapacity) {
        directions.next(packet);
        scene_.rays().first_hits(end.position, end.normal, packet);
        num_rays += static_cast<std::uint64_t>(packet.count);
        for (std::size_t i = 0; i < static_cast<std::size_t>(packet.count); ++i) {
            if (packet.triangle[i] == DirectionPacket::kNone) continue;
            const Vec3 direction(packet.x[i], packet.y[i], packet.z[i]);
            add(end.position + packet.distance_m[i] * direction, packet.triangle[i]);
        }
    }
    num_in_sight_ = count_;
    return num_rays;
}

void FirstVertexBatch::evaluate(const PathEndpoints& ends, const Draw& draw) {
    ends.coincide ? evaluate_segments<true>(ends, draw) : evaluate_segments<false>(ends, draw);
}

// Where both ends coincide, so do the segments, which saves a square root and a division.
template <bool kCoincide>
void FirstVertexBatch::evaluate_segments(const PathEndpoints& ends, const Draw& draw) {
    const End sensor(ends.sensor);
    const End light(ends.light);
    const double pdf_by_area = draw.area_fraction * draw.hidden_pdf_area;
    // Cosine-weighted directions from a wall, uniform ones from an isotropic end.
    const double pdf_by_direction =
        (1.0 - draw.area_fraction) / (ends.sensor.isotropic ? 4.0 * kPi : kPi);
    const double sensor_strength = draw.weight * sensor.strength;
    const double segments = ends.device_segments_m;
    const int count = count_;
    for (int i = 0; i < count; ++i) {
        const double dx = x_[i] - sensor.x;
        const double dy = y_[i] - sensor.y;
        const double dz = z_[i] - sensor.z;
        const double distance2 = dx * dx + dy * dy + dz * dz;
        const double distance = std::sqrt(distance2);
        const double inverse = 1.0 / distance;
        const double shape = sensor.shape(sensor.cosine(dx, dy, dz) * inverse);
        const double cosine =
            std::abs(normal_x_[i] * dx + normal_y_[i] * dy + normal_z_[i] * dz) * inverse;
        const double per_area = cosine * inverse * inverse;
        const double pdf = pdf_by_area * is_hidden_[i] + pdf_by_direction * shape * per_area;
        pdf_area_[i] = pdf;
        const double carried = sensor_strength * shape * per_area;
        throughput_[i] = carried > 0.0 ? carried / pdf : 0.0;

        const double lx = light.x - x_[i];
        const double ly = light.y - y_[i];
        const double lz = light.z - z_[i];
        const double light_distance2 = lx * lx + ly * ly + lz * lz;
        const double light_distance = kCoincide ? distance : std::sqrt(light_distance2);
        const double light_inverse = kCoincide ? inverse : 1.0 / light_distance;
        const double light_shape = light.shape(-light.cosine(lx, ly, lz) * light_inverse);
        const double out =
            (normal_x_[i] * lx + normal_y_[i] * ly + normal_z_[i] * lz) * light_inverse;
        const double in = normal_x_[i] * dx + normal_y_[i] * dy + normal_z_[i] * dz;
        // Facets reflect on both sides, and both segments must lie on the same side.
        const double reflected = in * out < 0.0 ? constant_bsdf_[i] * std::abs(out) : 0.0;
        opl_m_[i] = distance + light_distance + segments;
        contribution_[i] = throughput_[i] * reflected * light.strength * light_shape *
                           light_inverse * light_inverse;
    }
}

std::uint64_t FirstVertexBatch::trace_from(const PathEndpoint& end, int first) {
    SegmentPacket packet;
    std::fill_n(seen_, first, true);
    for (int begin = first; begin < count_; begin += SegmentPacket::kSize) {
        scene_.rays().aim(packet,
                          end.position,
                          end.normal,
                          {x_ + begin,
                           y_ + begin,
                           z_ + begin,
                           normal_x_ + begin,
                           normal_y_ + begin,
                           normal_z_ + begin},
                          std::min(count_ - begin, SegmentPacket::kSize));
        scene_.rays().trace(packet);
        for (int lane = 0; lane < packet.count; ++lane) {
            const bool is_blocked = (packet.blocked >> lane & 1U) != 0;
            seen_[begin + lane] = !is_blocked;
            if (is_blocked) contribution_[begin + lane] = 0.0;
        }
    }
    return static_cast<std::uint64_t>(count_ - first);
}

template <class Predicate>
void FirstVertexBatch::keep_if(const Predicate& keep) {
    int kept = 0;
    while (kept < count_ && keep(kept)) ++kept;
    int kept_in_sight = std::min(kept, num_in_sight_);
    for (int i = kept + 1; i < count_; ++i) {
        if (!keep(i)) continue;
        if (i < num_in_sight_) ++kept_in_sight;
        facet_[kept] = facet_[i];
        for (double* array : {x_,
                              y_,
                              z_,
                              normal_x_,
                              normal_y_,
                              normal_z_,
                              is_hidden_,
                              constant_bsdf_,
                              pdf_area_,
                              throughput_,
                              opl_m_,
                              contribution_}) {
            array[kept] = array[i];
        }
        ++kept;
    }
    count_ = kept;
    num_in_sight_ = kept_in_sight;
}

void FirstVertexBatch::keep_seen() {
    keep_if([this](int i) { return seen_[i]; });
}

void FirstVertexBatch::keep_useful() {
    keep_if([this](int i) { return !(contribution_[i] <= 0.0); });
}

double FirstVertexBatch::leave_out_other_lengths(const TimeGate& gate) {
    const double begin_m = gate.begin_m();
    const double end_m = gate.end_m();
    double all = 0.0;
    double inside = 0.0;
    for (int i = 0; i < count_; ++i) {
        const bool counts = opl_m_[i] >= begin_m && opl_m_[i] < end_m;
        all += contribution_[i];
        contribution_[i] = counts ? contribution_[i] : 0.0;
        inside += contribution_[i];
    }
    return all > 0.0 ? inside / all : 0.0;
}

void FirstVertexBatch::thin(double step_in_means, core::Rng& rng) {
    const double sum = std::accumulate(contribution_, contribution_ + count_, 0.0);
    SystematicSampler sampler(step_in_means * sum / count_, rng);
    keep_if([&](int i) {
        if (contribution_[i] <= 0.0) return false;
        const double drawn = sampler.draw(contribution_[i]);
        if (drawn == 0.0) return false;
        contribution_[i] = drawn;
        return true;
    });
}

std::vector<FirstVertexBatch::Drawn> FirstVertexBatch::draw_by_throughput(double step_in_means,
                                                                          core::Rng& rng) const {
    const double sum = std::accumulate(throughput_, throughput_ + count_, 0.0);
    const double step = step_in_means > 1.0 ? step_in_means * sum / count_ : 0.0;
    SystematicSampler sampler(step, rng);
    std::vector<Drawn> all;
    for (int i = 0; i < count_; ++i) {
        if (throughput_[i] <= 0.0) continue;
        const double drawn = sampler.draw(throughput_[i]);
        if (drawn != 0.0) all.push_back({i, drawn / throughput_[i]});
    }
    return all;
}

std::span<const double> FirstVertexBatch::find_velocities(const PathEndpoints& ends) {
    for (int i = 0; i < count_; ++i) {
        const Vec3 position(x_[i], y_[i], z_[i]);
        const Vec3& velocity = scene_.velocity_m_per_s(facet_[i]);
        OpticalPath path;
        path.add_segment(position - ends.sensor.position, Vec3::Zero(), velocity);
        path.add_segment(ends.light.position - position, velocity, Vec3::Zero());
        velocity_[i] = path.velocity_m_per_s;
    }
    return {velocity_, size_t_count()};
}

PathVertex FirstVertexBatch::vertex(int i, const PathEndpoint& sensor) const {
    PathVertex vertex = vertex_at(scene_, point(i), Vec3::Zero());
    const Vec3 to_sensor = sensor.position - vertex.point.position;
    vertex.optical_path.add_segment(
        -to_sensor, Vec3::Zero(), scene_.velocity_m_per_s(vertex.point.facet));
    vertex.to_previous = to_sensor / vertex.optical_path.opl_m;
    vertex.throughput = throughput_[i];
    return vertex;
}

}  // namespace renderer
