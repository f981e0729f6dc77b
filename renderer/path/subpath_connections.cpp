// SPDX-License-Identifier: MIT
#include "renderer/path/subpath_connections.h"

#include "renderer/path/systematic_sampler.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace renderer {
namespace {

using core::kPi;
using core::Vec3;

// Tuned on scenes/room, lit by a spot and by a point, scenes/relief and scenes/traffic: equal error
// costs about the same with twice the connections and half the samples.
constexpr double kWalksPerVertex = 0.15;
constexpr int kConnectionsPerVertex = 16;
constexpr double kRaysPerVertex = 2.0;
// GGX widths below this reflect only a small part of what connections bring.
constexpr double kNarrowAlpha = 0.3;

}  // namespace

IndirectSplit IndirectSplit::at(const PathVertex& vertex) {
    const auto lobe = lobe_of(vertex.bsdf, std::abs(vertex.normal.dot(vertex.to_previous)));
    const double narrow = lobe && lobe->alpha < kNarrowAlpha ? lobe->fraction : 0.0;
    return {std::lerp(kWalksPerVertex, 1.0, narrow),
            static_cast<int>(std::lround((1.0 - narrow) * kConnectionsPerVertex))};
}

void SubpathDensity::add_step(const PathVertex& from, const PathVertex& to, double pdf_area) {
    // Now it is known where a light subpath would come from to the vertex before.
    if (num_steps_ >= 2) {
        ratio_ *=
            survival_at(to_, to.to_previous) * walk_->pdf_area(to_, -to.to_previous, from_.point);
    }
    ratio_ /= pdf_area;
    from_ = from;
    to_ = to;
    ++num_steps_;
}

double SubpathDensity::ratio() const {
    const double first = ratio_ * pdf_area_from_light(*scene_, *light_, to_.point);
    if (num_steps_ == 1 || !(first > 0.0)) return first;
    const Vec3 to_light = (light_->position - to_.point.position).normalized();
    return first * survival_at(to_, to_light) * walk_->pdf_area(to_, to_light, from_.point);
}

SubpathConnections::SubpathConnections(const Scene& scene,
                                       const RandomWalk& walk,
                                       const LightSubpaths& subpaths,
                                       const Orders& orders,
                                       core::Rng& rng,
                                       const PassHistogram& histogram,
                                       ShadowRayQueue& shadow_rays)
    : scene_(scene),
      walk_(walk),
      subpaths_(subpaths),
      orders_(orders),
      rng_(rng),
      resolves_velocity_(histogram.resolves_velocity()),
      begin_m_(histogram.gate().begin_m()),
      end_m_(histogram.gate().end_m()),
      shadow_rays_(shadow_rays),
      next_walk_(static_cast<int>(rng.uniform() * subpaths.num_walks())) {
    vertices_.reserve(kMaxVertices);
}

void SubpathConnections::connect(const PathVertex& vertex, const IndirectSplit& split) {
    if (vertices_.size() == kMaxVertices) finish();
    vertices_.push_back(vertex);
    for (int left = split.connections; left > 0;) {
        const int last = std::min(next_walk_ + left, subpaths_.num_walks());
        left -= last - next_walk_;
        const std::size_t end = subpaths_.begin(last);
        for (std::size_t begin = subpaths_.begin(next_walk_); begin < end; begin += kMaxAtOnce) {
            if (num_candidates_ + kMaxAtOnce > kMaxCandidates) {
                finish();
                vertices_.push_back(vertex);
            }
            connect_range(vertex, split, begin, std::min(kMaxAtOnce, end - begin));
        }
        next_walk_ = last == subpaths_.num_walks() ? 0 : last;
    }
}

void SubpathConnections::connect_range(const PathVertex& vertex,
                                       const IndirectSplit& split,
                                       std::size_t begin,
                                       std::size_t count) {
    Connected connected;
    evaluate_range(vertex, split, begin, count, connected);
    const bool is_constant = traits_of(vertex.bsdf).is_constant && !subpaths_.any_varies();
    if (!is_constant) reevaluate_varying(vertex, split, begin, count, connected);
    if (orders_.max - vertex.order < subpaths_.max_vertices()) {
        for (std::size_t i = 0; i < count; ++i) {
            if (vertex.order + subpaths_.depth(begin + i) > orders_.max) connected.value[i] = 0.0;
        }
    }
    const auto first = static_cast<std::uint8_t>(vertices_.size() - 1);
    std::size_t n = num_candidates_;
    for (std::size_t i = 0; i < count; ++i) {
        const double opl_m = connected.opl_m[i];
        candidates_.value[n] = connected.value[i];
        candidates_.opl_m[n] = opl_m;
        candidates_.subpath_vertex[n] = static_cast<std::uint32_t>(begin + i);
        candidates_.first_vertex[n] = first;
        const auto counts = static_cast<unsigned>(connected.value[i] > 0.0) &
                            static_cast<unsigned>(opl_m >= begin_m_) &
                            static_cast<unsigned>(opl_m < end_m_);
        n += counts;
    }
    num_candidates_ = n;
}

// Between surfaces of constant value. Plain numbers in a loop without branches, so that the
// compiler fills vector units.
void SubpathConnections::evaluate_range(const PathVertex& vertex,
                                        const IndirectSplit& split,
                                        std::size_t begin,
                                        std::size_t count,
                                        Connected& connected) const {
    const auto at = [&](LightSubpaths::Column column) { return subpaths_.column(column) + begin; };
    const double* const x = at(LightSubpaths::kX);
    const double* const y = at(LightSubpaths::kY);
    const double* const z = at(LightSubpaths::kZ);
    const double* const normal_x = at(LightSubpaths::kNormalX);
    const double* const normal_y = at(LightSubpaths::kNormalY);
    const double* const normal_z = at(LightSubpaths::kNormalZ);
    const double* const radiance = at(LightSubpaths::kRadiance);
    const double* const opl = at(LightSubpaths::kOpl);
    const double* const ratio = at(LightSubpaths::kRatio);
    const bool is_back = vertex.normal.dot(vertex.to_previous) < 0.0;
    const Vec3 normal = is_back ? Vec3(-vertex.normal) : vertex.normal;
    const Vec3 position = vertex.point.position;
    const double px = position.x(), py = position.y(), pz = position.z();
    const double nx = normal.x(), ny = normal.y(), nz = normal.z();
    const double scale = vertex.throughput * constant_value(vertex.bsdf).value_or(0.0);
    const double connections = split.connections;
    const double area_fraction = walk_.area_fraction(vertex);
    const double by_area = split.walks * area_fraction * walk_.area_sampler().pdf_area();
    const double by_direction = split.walks * (1.0 - area_fraction) / kPi;
    const double opl_m = vertex.optical_path.opl_m;
    for (std::size_t i = 0; i < count; ++i) {
        const double dx = x[i] - px;
        const double dy = y[i] - py;
        const double dz = z[i] - pz;
        const double distance2 = dx * dx + dy * dy + dz * dz;
        const double cosine = std::max(0.0, nx * dx + ny * dy + nz * dz);
        const double facing =
            std::max(0.0, -normal_x[i] * dx - normal_y[i] * dy - normal_z[i] * dz);
        // cosines / distance2^2 is the geometry factor. The contribution of a connection and the
        // densities in its weight are multiplied by distance2^2, so that one division is enough.
        const double cosines = cosine * facing;
        const double densities = (connections + by_area * ratio[i]) * distance2 * distance2 +
                                 by_direction * cosines * ratio[i];
        const double value = scale * radiance[i] * cosines / densities;
        connected.value[i] = cosines > 0.0 ? value : 0.0;
        connected.opl_m[i] = opl_m + opl[i] + std::sqrt(distance2);
    }
}

void SubpathConnections::reevaluate_varying(const PathVertex& vertex,
                                            const IndirectSplit& split,
                                            std::size_t begin,
                                            std::size_t count,
                                            Connected& connected) const {
    const bool is_constant = traits_of(vertex.bsdf).is_constant;
    for (std::size_t i = 0; i < count; ++i) {
        if (is_constant && !subpaths_.varies(begin + i)) continue;
        connected.value[i] = varying_contribution(vertex, split, begin + i);
    }
}

// The same for surfaces of any kind.
double SubpathConnections::varying_contribution(const PathVertex& vertex,
                                                const IndirectSplit& split,
                                                std::size_t index) const {
    const PathVertex& other = subpaths_.vertex(index);
    const auto step = walk_.step_to(vertex, other.point);
    if (!step) return 0.0;
    double ratio = subpaths_.column(LightSubpaths::kRatio)[index] * step->pdf_area;
    double radiance = subpaths_.column(LightSubpaths::kRadiance)[index];
    if (subpaths_.varies(index)) {
        radiance *= walk_.evaluate(other, -step->direction);
        if (subpaths_.depth(index) > 1) {
            ratio *= walk_.pdf_area(other, -step->direction, subpaths_.vertex(index - 1).point);
        }
    } else if (other.normal.dot(other.to_previous) * other.normal.dot(step->direction) >= 0.0) {
        return 0.0;
    }
    return vertex.throughput * step->transport * radiance /
           (split.connections + split.walks * ratio);
}

// By counting; the order within one of many short intervals of length does not matter.
void SubpathConnections::sort_by_length() {
    constexpr std::size_t kIntervals = 512;
    std::array<std::uint16_t, kIntervals + 1> begin{};
    std::array<std::uint16_t, kMaxCandidates> interval;
    const double* const opl = candidates_.opl_m.data();
    double least = opl[0];
    double most = opl[0];
    for (std::size_t i = 0; i < num_candidates_; ++i) {
        least = std::min(least, opl[i]);
        most = std::max(most, opl[i]);
    }
    const double scale = most > least ? (kIntervals - 1) / (most - least) : 0.0;
    for (std::size_t i = 0; i < num_candidates_; ++i) {
        interval[i] = static_cast<std::uint16_t>(static_cast<int>((opl[i] - least) * scale));
    }
    for (std::size_t i = 0; i < num_candidates_; ++i) ++begin[interval[i] + 1U];
    for (std::size_t i = 0; i < kIntervals; ++i) {
        begin[i + 1] = static_cast<std::uint16_t>(begin[i + 1] + begin[i]);
    }
    for (std::size_t i = 0; i < num_candidates_; ++i) {
        order_[begin[interval[i]]++] = static_cast<std::uint16_t>(i);
    }
}

void SubpathConnections::finish() {
    if (num_candidates_ > 0) draw_shadow_rays();
    num_candidates_ = 0;
    vertices_.clear();
}

// Candidates above the step between samples are all taken, the others with a probability of their
// fraction of it.
void SubpathConnections::draw_shadow_rays() {
    const double* const values = candidates_.value.data();
    const double sum = std::accumulate(values, values + num_candidates_, 0.0);
    const double step = sum / (kRaysPerVertex * static_cast<double>(vertices_.size()));
    sort_by_length();
    SystematicSampler sampler(step, rng_);
    for (std::size_t i = 0; i < num_candidates_; ++i) {
        const std::size_t candidate = order_[i];
        const double drawn = sampler.draw(candidates_.value[candidate]);
        if (drawn != 0.0) append(candidate, drawn);
    }
}

void SubpathConnections::append(std::size_t candidate, double value) {
    const PathVertex& vertex = vertices_[candidates_.first_vertex[candidate]];
    const std::size_t index = candidates_.subpath_vertex[candidate];
    const auto at = [&](LightSubpaths::Column column) { return subpaths_.column(column)[index]; };
    const Vec3 position(at(LightSubpaths::kX), at(LightSubpaths::kY), at(LightSubpaths::kZ));
    const Vec3 normal(
        at(LightSubpaths::kNormalX), at(LightSubpaths::kNormalY), at(LightSubpaths::kNormalZ));
    OpticalPath optical_path{candidates_.opl_m[candidate], 0.0};
    if (resolves_velocity_) {
        OpticalPath to_there = vertex.optical_path;
        to_there.add_segment(position - vertex.point.position,
                             scene_.velocity_m_per_s(vertex.point.facet),
                             scene_.velocity_m_per_s(subpaths_.vertex(index).point.facet));
        optical_path.velocity_m_per_s = to_there.velocity_m_per_s + at(LightSubpaths::kVelocity);
    }
    const int channel = orders_.are_separate ? vertex.order + subpaths_.depth(index) - 1 : 0;
    shadow_rays_.add(
        {vertex.point.position, vertex.normal}, {position, normal}, channel, optical_path, value);
}

}  // namespace renderer
