// SPDX-License-Identifier: MIT
#include "renderer/restir/light_vertex_cache.h"

#include "renderer/core/sampling.h"
#include "renderer/core/system/parallel.h"
#include "renderer/path/light_subpaths.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr std::size_t kWalksPerBlock = 64;
constexpr std::uint32_t kVerticesAtOnce = 64;

// Bound of the rounding of lengths in single precision, relative to the size of the scene.
constexpr float kRoundingFraction = 16.0F * 0x1.0p-24F;

}  // namespace

LightVertexCache::LightVertexCache(const Scene& scene,
                                   const RandomWalk& walk,
                                   const SensorPairs& sensor_pairs)
    : scene_(&scene), walk_(&walk), by_area_(!sensor_pairs.is_image()) {
    light_ = sensor_pairs.ends(0).light;
    if (!by_area_) return;
    light_.position = Vec3::Zero();
    for (std::size_t pair = 0; pair < sensor_pairs.num_pairs(); ++pair) {
        light_.position +=
            sensor_pairs.ends(pair).light.position / static_cast<double>(sensor_pairs.num_pairs());
    }
}

PathVertex LightVertexCache::first_vertex(const SurfacePoint& point) const {
    PathVertex vertex = vertex_at(*scene_, point, (light_.position - point.position).normalized());
    vertex.throughput = 1.0;
    return vertex;
}

double LightVertexCache::pdf_area_of_first(const SurfacePoint& point) const {
    if (by_area_) return scene_->is_hidden(point.facet) ? walk_->area_sampler().pdf_area() : 0.0;
    return pdf_area_from_light(*scene_, light_, point);
}

LightVertexCache::Walked LightVertexCache::trace_walk(int index,
                                                      int max_vertices,
                                                      double shift,
                                                      core::Rng& rng) const {
    Walked walked;
    // Any run of these is evenly spread.
    const double u1 = core::lattice_point(index, 1, {0.0, shift}).y();
    const double u2 = rng.uniform();
    SurfacePoint point;
    if (by_area_) {
        point = walk_->area_sampler().sample(u1, u2);
    } else {
        const Vec3 direction = sample_direction_from_light(*scene_, light_, {u1, u2});
        ++walked.num_rays;
        const auto hit = scene_->first_hit(light_.position, light_.normal, direction);
        if (!hit) return walked;
        point = *hit;
    }
    walked.points.push_back(point);
    PathVertex vertex = first_vertex(point);
    while (static_cast<int>(walked.points.size()) < max_vertices) {
        if (!walk_->draw_next(vertex, rng, walked.num_rays)) break;
        walked.points.push_back(vertex.point);
    }
    return walked;
}

std::uint64_t LightVertexCache::trace(int num_walks,
                                      int max_vertices,
                                      std::uint64_t seed,
                                      std::uint64_t frame) {
    std::vector<Walked> walks(static_cast<std::size_t>(num_walks));
    const double shift = core::Rng(seed, walks.size(), frame).uniform();
    core::parallel_blocks(walks.size(), kWalksPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            core::Rng rng(seed, i, frame);
            walks[i] = trace_walk(static_cast<int>(i), max_vertices, shift, rng);
        }
    });
    store(walks);
    std::uint64_t num_rays = 0;
    for (const Walked& walked : walks) num_rays += walked.num_rays;
    return num_rays;
}

void LightVertexCache::store(const std::vector<Walked>& walks) {
    points_.clear();
    walk_of_.clear();
    walk_begin_.assign(1, 0);
    for (auto& column : columns_) column.clear();
    const Vec3& origin = scene_->rays().origin();
    for (std::size_t w = 0; w < walks.size(); ++w) {
        double to_light = 0.0;
        for (std::size_t i = 0; i < walks[w].points.size(); ++i) {
            const SurfacePoint& point = walks[w].points[i];
            const Vec3 first = (walks[w].points[0].position - origin);
            const Vec3 local = point.position - origin;
            if (i > 0) {
                to_light += (point.position - walks[w].points[i - 1].position).norm();
            } else if (!by_area_) {
                to_light = (point.position - light_.position).norm();
            }
            points_.push_back(point);
            walk_of_.push_back(static_cast<std::uint32_t>(w));
            const std::array<double, kNumColumns> values{
                local.x(), local.y(), local.z(), first.x(), first.y(), first.z(), to_light};
            for (std::size_t c = 0; c < kNumColumns; ++c) {
                columns_[c].push_back(static_cast<float>(values[c]));
            }
        }
        walk_begin_.push_back(static_cast<std::uint32_t>(points_.size()));
    }
}

void LightVertexCache::find(const PathDomain& domain,
                            const OplBand& opl_m,
                            const Stretch& walks,
                            std::vector<std::uint32_t>& found) const {
    found.clear();
    const Vec3& origin = scene_->rays().origin();
    const Eigen::Vector3f start = (domain.start() - origin).cast<float>();
    const Eigen::Vector3f light = (domain.ends.light.position - origin).cast<float>();
    const auto end_f = static_cast<float>(opl_m.high_m - domain.extra_opl_m());
    const auto begin_f = static_cast<float>(opl_m.low_m - domain.extra_opl_m());
    const float margin = kRoundingFraction * (std::abs(end_f) + std::abs(begin_f) + start.norm());
    const float low = begin_f - margin;
    const float high = end_f + margin;
    // Confocal, and every walk has a single vertex.
    const bool same_segments =
        by_area_ && domain.ends.coincide && points_.size() + 1 == walk_begin_.size();
    const std::uint32_t last = walk_begin_[static_cast<std::size_t>(walks.first + walks.count)];
    for (std::uint32_t v = walk_begin_[static_cast<std::size_t>(walks.first)]; v < last;) {
        std::array<float, kVerticesAtOnce> length;
        const std::uint32_t count = std::min(kVerticesAtOnce, last - v);
        // With pointers the loops vectorize; sums of 32-bit indices might wrap around.
        std::array<const float*, kNumColumns> at;
        for (std::size_t c = 0; c < kNumColumns; ++c) at[c] = columns_[c].data() + v;
        const auto [x, y, z, first_x, first_y, first_z, to_light_m] = at;
        for (std::uint32_t i = 0; i < count; ++i) {
            const float dx = x[i] - start.x();
            const float dy = y[i] - start.y();
            const float dz = z[i] - start.z();
            length[i] = std::sqrt(dx * dx + dy * dy + dz * dz) + to_light_m[i];
        }
        for (std::uint32_t i = 0; same_segments && i < count; ++i) length[i] *= 2.0F;
        for (std::uint32_t i = 0; by_area_ && !same_segments && i < count; ++i) {
            const float lx = first_x[i] - light.x();
            const float ly = first_y[i] - light.y();
            const float lz = first_z[i] - light.z();
            length[i] += std::sqrt(lx * lx + ly * ly + lz * lz);
        }
        const auto is_hit = [&](std::uint32_t i) {
            return static_cast<std::uint32_t>(length[i] >= low) &
                   static_cast<std::uint32_t>(length[i] < high);
        };
        // In a narrow gate most blocks have no hit, and the others few: collect them without
        // branches.
        std::uint32_t num_hits = 0;
        for (std::uint32_t i = 0; i < count; ++i) num_hits += is_hit(i);
        if (num_hits > 0) {
            std::array<std::uint32_t, kVerticesAtOnce> hits;
            std::uint32_t n = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                hits[n] = v + i;
                n += is_hit(i);
            }
            found.insert(found.end(), hits.begin(), hits.begin() + num_hits);
        }
        v += count;
    }
}

ReusablePath LightVertexCache::path_from(std::uint32_t vertex) const {
    ReusablePath path;
    const std::uint32_t first = walk_begin_[walk_of_[vertex]];
    for (std::uint32_t v = vertex + 1; v-- > first;) path.append(points_[v]);
    return path;
}

double LightVertexCache::pdf_area(const ReusablePath& path) const {
    double pdf = pdf_area_of_first(path.last());
    PathVertex vertex = first_vertex(path.last());
    for (int i = path.num_vertices - 2; i >= 0 && pdf > 0.0; --i) {
        const auto step = walk_->step_to(vertex, path.at(i));
        if (!step) return 0.0;
        pdf *= step->pdf_area;
        vertex = walk_->advance(vertex, path.at(i), *step, step->pdf_area);
    }
    return pdf;
}

}  // namespace renderer
