// SPDX-License-Identifier: MIT
#include "renderer/path/sensor_pairs.h"

#include <fmt/core.h>

#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr double kSpotTolerance_m = 1e-3;

PathEndpoint wall_end(const core::WallPoints& points, std::size_t index, double albedo) {
    PathEndpoint end;
    end.position = points.positions[index];
    end.normal = points.normals[index];
    end.strength = albedo / core::kPi;
    return end;
}

// The facet that a point lies on, up to the tolerance, with the point moved into its plane.
std::optional<SurfacePoint> surface_point(const Scene& scene, const Vec3& point) {
    std::optional<SurfacePoint> nearest;
    double least = kSpotTolerance_m;
    for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
        const Facet& facet = scene.facet(i);
        const Vec3 offset = point - facet.corner;
        const double height = facet.normal.dot(offset);
        if (std::abs(height) >= least) continue;
        const Vec3 area_vector = facet.edge1.cross(facet.edge2);
        const double b1 = offset.cross(facet.edge2).dot(area_vector) / area_vector.squaredNorm();
        const double b2 = facet.edge1.cross(offset).dot(area_vector) / area_vector.squaredNorm();
        constexpr double kEdge = 1e-6;  // a spot on a common edge belongs to either facet
        if (b1 < -kEdge || b2 < -kEdge || b1 + b2 > 1.0 + kEdge) continue;
        least = std::abs(height);
        nearest = SurfacePoint{point - height * facet.normal, i};
    }
    return nearest;
}

}  // namespace

int first_order(const core::Scan& scan) {
    return scan.visit(
        [](const core::WallScan&) { return 3; },
        [](const core::ImageScan& image) { return image.camera.light_spot_m ? 2 : 1; });
}

SensorPairs::SensorPairs(const Scene& scene, const core::Scan& scan)
    : scene_(&scene), scan_(&scan) {
    scan.visit([&](const core::WallScan& wall) { wall_ = &wall; },
               [&](const core::ImageScan& image) { camera_ = &image.camera; });
    if (!is_image()) return;
    world_from_image_ = camera_->world_from_image();
    if (camera_->light_spot_m) {
        light_ = spot_light(*camera_->light_spot_m);
    } else {
        light_.position = camera_->light_position();
        light_.isotropic = true;
        light_.strength = 1.0 / (4.0 * core::kPi);
    }
}

// The lit side is the one that faces the camera.
PathEndpoint SensorPairs::spot_light(const Vec3& spot) const {
    const auto point = surface_point(*scene_, spot);
    if (!point) {
        throw core::Error(
            "camera.light_spot_m",
            fmt::format(
                "found ({}, {}, {}), which lies on no surface", spot.x(), spot.y(), spot.z()),
            fmt::format("must lie within {} m of one", kSpotTolerance_m));
    }
    PathEndpoint light;
    light.position = point->position;
    light.normal = scene_->facet(point->facet).normal;
    if (light.normal.dot(camera_->position_m - light.position) < 0.0) light.normal *= -1.0;
    light.strength = albedo_of(scene_->bsdf_at(*point)) / core::kPi;
    light.velocity_m_per_s = scene_->velocity_m_per_s(point->facet);
    return light;
}

PathEndpoints SensorPairs::ends(std::size_t pair) const {
    PathEndpoints ends;
    if (is_image()) {
        ends.sensor.position = camera_->position_m;
        ends.sensor.isotropic = true;
        ends.sensor.strength = 1.0;
        ends.light = light_;
        return ends;
    }
    const double albedo = scene_->wall_albedo();
    ends.sensor = wall_end(wall_->sensing, wall_->sensing_index(pair), albedo);
    ends.light = wall_end(wall_->illumination, wall_->illumination_index(pair), albedo);
    ends.device_segments_m = wall_->device_segments_m(pair);
    ends.coincide =
        ends.sensor.position == ends.light.position && ends.sensor.normal == ends.light.normal;
    return ends;
}

std::optional<PathVertex> SensorPairs::first_vertex(std::size_t pixel, const core::Vec2& u) const {
    const Vec3 direction = direction_through(pixel, u);
    const auto hit = scene_->first_hit(camera_->position_m, direction, direction);
    if (!hit) return std::nullopt;
    return seen_vertex(*hit, direction);
}

void SensorPairs::find_first_vertices(std::size_t pixel,
                                      std::span<const core::Vec2> u,
                                      std::vector<PathVertex>& vertices) const {
    DirectionPacket packet;
    packet.count = static_cast<int>(u.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
        const Vec3 direction = direction_through(pixel, u[i]);
        packet.x[i] = direction.x();
        packet.y[i] = direction.y();
        packet.z[i] = direction.z();
    }
    const Vec3& position = camera_->position_m;
    const Vec3 view = direction_through(pixel, {0.5, 0.5});
    scene_->rays().first_hits(position, view, packet);
    for (std::size_t i = 0; i < u.size(); ++i) {
        if (packet.triangle[i] == DirectionPacket::kNone) continue;
        const Vec3 direction(packet.x[i], packet.y[i], packet.z[i]);
        vertices.push_back(seen_vertex(
            {position + packet.distance_m[i] * direction, packet.triangle[i]}, direction));
    }
}

Vec3 SensorPairs::direction_through(std::size_t pixel, const core::Vec2& u) const {
    const core::PinholeCamera& camera = *camera_;
    const double x = static_cast<double>(pixel / camera.height()) + u.x();
    const double y = static_cast<double>(pixel % camera.height()) + u.y();
    return (world_from_image_ * Vec3(x, y, 1.0)).normalized();
}

PathVertex SensorPairs::seen_vertex(const SurfacePoint& point, const Vec3& direction) const {
    PathVertex vertex = vertex_at(*scene_, point, -direction);
    vertex.throughput = 1.0;
    vertex.optical_path.add_segment(
        point.position - camera_->position_m, Vec3::Zero(), scene_->velocity_m_per_s(point.facet));
    vertex.order = first_order();
    return vertex;
}

}  // namespace renderer
