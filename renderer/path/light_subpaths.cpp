// SPDX-License-Identifier: MIT
#include "renderer/path/light_subpaths.h"

#include "renderer/core/sampling.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec2;
using core::Vec3;

constexpr std::size_t kWalksPerBlock = 64;

// The i-th point of an endless sequence in the unit square, of which any run is spread evenly:
// multiples of the powers of the plastic number (source [Roberts2018]), shifted at random.
Vec2 sequence_point(std::size_t i, const Vec2& shift) {
    constexpr double kPlastic1 = 0.7548776662466927;
    constexpr double kPlastic2 = 0.5698402909980532;
    const double u = shift.x() + kPlastic1 * static_cast<double>(i);
    const double v = shift.y() + kPlastic2 * static_cast<double>(i);
    return {u - std::floor(u), v - std::floor(v)};
}

}  // namespace

double pdf_area_from_light(const Scene& scene,
                           const PathEndpoint& light,
                           const SurfacePoint& point) {
    const Vec3 offset = point.position - light.position;
    const double distance2 = offset.squaredNorm();
    const Vec3 direction = offset / std::sqrt(distance2);
    const double pdf_direction =
        light.isotropic ? core::pdf_sphere() : std::max(0.0, light.normal.dot(direction)) / kPi;
    return pdf_direction * std::abs(scene.facet(point.facet).normal.dot(direction)) / distance2;
}

Vec3 sample_direction_from_light(const Scene& scene, const PathEndpoint& light, const Vec2& u) {
    if (light.isotropic) return core::sample_sphere(u);
    return core::frame_from_normal(light.normal, scene.tangent_hint(light.normal)) *
           core::sample_cosine_hemisphere(u);
}

LightSubpaths::LightSubpaths(const Scene& scene,
                             const RandomWalk& walk,
                             const PathEndpoint& light,
                             int num_walks,
                             int max_vertices,
                             core::Rng rng)
    : scene_(&scene), walk_(&walk), light_(light), max_vertices_(max_vertices) {
    const Vec2 shift(rng.uniform(), rng.uniform());
    const std::uint64_t seed = rng.next_bits();
    std::vector<Walked> walks(static_cast<std::size_t>(num_walks));
    core::parallel_blocks(walks.size(), kWalksPerBlock, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            core::Rng of_walk(seed, i, 0);
            walks[i] = trace_walk(sequence_point(i, shift), max_vertices, of_walk);
        }
    });
    std::size_t num_vertices = 0;
    for (const Walked& walked : walks) num_vertices += walked.steps.size();
    vertices_.reserve(num_vertices);
    for (std::vector<double>& column : columns_) column.reserve(num_vertices);
    for (const Walked& walked : walks) store(walked);
}

LightSubpaths::Walked LightSubpaths::trace_walk(const Vec2& u,
                                                int max_vertices,
                                                core::Rng& rng) const {
    Walked walked;
    if (max_vertices < 1) return walked;
    walked.steps.reserve(static_cast<std::size_t>(max_vertices));
    const Vec3 direction = sample_direction_from_light(*scene_, light_, u);
    // An isotropic light lies on no surface that its rays could start off.
    const Vec3& normal = light_.isotropic ? direction : light_.normal;
    ++walked.num_rays;
    const auto hit = scene_->first_hit(light_.position, normal, direction);
    if (!hit) return walked;
    PathVertex vertex = vertex_at(*scene_, *hit, -direction);
    const double pdf_first = pdf_area_from_light(*scene_, light_, *hit);
    if (!(pdf_first > 0.0)) return walked;
    vertex.throughput = light_.strength * (light_.isotropic ? 4.0 * kPi : kPi);
    vertex.optical_path.add_segment(hit->position - light_.position,
                                    light_.velocity_m_per_s,
                                    scene_->velocity_m_per_s(hit->facet));
    double ratio = 1.0 / pdf_first;
    walked.steps.push_back({vertex, ratio});
    while (static_cast<int>(walked.steps.size()) < max_vertices) {
        const double survival = survival_at(vertex, vertex.to_previous);
        if (rng.uniform() >= survival) break;
        const PathVertex before = vertex;
        const auto pdf = walk_->draw_next(vertex, rng, walked.num_rays);
        if (!pdf) break;
        vertex.throughput /= survival;
        // Backwards a path would come to the vertex before from this one, and go on from there.
        if (walked.steps.size() > 1) {
            const PathVertex& third = walked.steps[walked.steps.size() - 2].vertex;
            ratio *= walk_->pdf_area(before, -vertex.to_previous, third.point);
        }
        ratio /= survival * *pdf;
        walked.steps.push_back({vertex, ratio});
    }
    return walked;
}

// Where the BSDF is constant, so is the density of the first step back.
void LightSubpaths::store(const Walked& walked) {
    for (std::size_t i = 0; i < walked.steps.size(); ++i) {
        const auto& [vertex, ratio] = walked.steps[i];
        const std::optional<double> constant = constant_value(vertex.bsdf);
        const bool is_back = vertex.normal.dot(vertex.to_previous) < 0.0;
        const Vec3 normal = is_back ? Vec3(-vertex.normal) : vertex.normal;
        const bool has_step = constant && i > 0;
        const double step =
            has_step ? walk_->pdf_area(vertex, normal, walked.steps[i - 1].vertex.point) : 1.0;
        const std::array<double, kNumColumns> values{vertex.point.position.x(),
                                                     vertex.point.position.y(),
                                                     vertex.point.position.z(),
                                                     normal.x(),
                                                     normal.y(),
                                                     normal.z(),
                                                     vertex.throughput * constant.value_or(1.0),
                                                     vertex.optical_path.opl_m,
                                                     vertex.optical_path.velocity_m_per_s,
                                                     ratio * step};
        for (std::size_t c = 0; c < kNumColumns; ++c) columns_[c].push_back(values[c]);
        vertices_.push_back(vertex);
        depth_.push_back(static_cast<int>(i) + 1);
        varies_.push_back(constant ? 0 : 1);
        any_varies_ = any_varies_ || !constant;
    }
    walk_begin_.push_back(vertices_.size());
    num_rays_ += walked.num_rays;
}

}  // namespace renderer
