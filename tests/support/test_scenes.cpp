// SPDX-License-Identifier: MIT
#include "tests/support/test_scenes.h"

#include <array>
#include <cmath>

namespace test_support {
namespace {

using core::Vec3;

bool crosses(const Vec3& from, const Vec3& to, const Parallelogram& shape) {
    const Vec3 normal = shape.u.cross(shape.v);
    const Vec3 along = to - from;
    const double slope = normal.dot(along);
    if (slope == 0.0) return false;
    const double t = normal.dot(shape.corner - from) / slope;
    if (t <= 0.0 || t >= 1.0) return false;
    const Vec3 p = from + t * along - shape.corner;
    const double g11 = shape.u.dot(shape.u);
    const double g12 = shape.u.dot(shape.v);
    const double g22 = shape.v.dot(shape.v);
    const double determinant = g11 * g22 - g12 * g12;
    const double a = (g22 * p.dot(shape.u) - g12 * p.dot(shape.v)) / determinant;
    const double b = (g11 * p.dot(shape.v) - g12 * p.dot(shape.u)) / determinant;
    return a >= 0.0 && a <= 1.0 && b >= 0.0 && b <= 1.0;
}

void subdivide(const std::array<Vec3, 3>& triangle, int level, renderer::Object& object) {
    if (level == 0) {
        const auto base = static_cast<std::uint32_t>(object.mesh.vertices.size());
        for (const Vec3& corner : triangle) object.mesh.vertices.push_back(corner);
        object.mesh.triangles.push_back({base, base + 1, base + 2});
        return;
    }
    const auto& [a, b, c] = triangle;
    const Vec3 ab = (a + b).normalized();
    const Vec3 bc = (b + c).normalized();
    const Vec3 ca = (c + a).normalized();
    subdivide({a, ab, ca}, level - 1, object);
    subdivide({ab, b, bc}, level - 1, object);
    subdivide({ca, bc, c}, level - 1, object);
    subdivide({ab, bc, ca}, level - 1, object);
}

}  // namespace

renderer::Object parallelogram_object(const Parallelogram& shape) {
    renderer::Object object;
    object.mesh.vertices = {shape.corner,
                            shape.corner + shape.u,
                            shape.corner + shape.u + shape.v,
                            shape.corner + shape.v};
    object.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    object.material.albedo = shape.albedo;
    if (shape.roughness) {
        object.material.model = renderer::model_of({.metallic = true});
        object.material.roughness = *shape.roughness;
    }
    return object;
}

renderer::Object sphere_object(const Vec3& center, double radius, int subdivisions, double albedo) {
    renderer::Object object;
    object.material.albedo = albedo;
    for (const double x : {-1.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) {
            for (const double z : {-1.0, 1.0}) {
                subdivide({Vec3(x, 0, 0), Vec3(0, y, 0), Vec3(0, 0, z)}, subdivisions, object);
            }
        }
    }
    for (Vec3& vertex : object.mesh.vertices) vertex = center + radius * vertex;
    return object;
}

core::TriangleMesh seamed_sphere(const Vec3& center, double radius, int cells) {
    core::TriangleMesh mesh;
    const int columns = 2 * cells;
    for (int row = 0; row <= cells; ++row) {
        const double polar = core::kPi * row / cells;
        for (int column = 0; column <= columns; ++column) {
            const double turn = core::kPi * column / cells;
            mesh.vertices.push_back(center + radius * Vec3(std::sin(polar) * std::cos(turn),
                                                           std::sin(polar) * std::sin(turn),
                                                           std::cos(polar)));
        }
    }
    for (int row = 0; row < cells; ++row) {
        for (int column = 0; column < columns; ++column) {
            const auto a = static_cast<std::uint32_t>(row * (columns + 1) + column);
            const auto below = a + static_cast<std::uint32_t>(columns) + 1;
            if (row > 0) mesh.triangles.push_back({a, below, a + 1});
            if (row + 1 < cells) mesh.triangles.push_back({a + 1, below, below + 1});
        }
    }
    return mesh;
}

core::WallPoints wall_points(const std::vector<Vec3>& positions) {
    core::WallPoints points;
    points.positions = positions;
    points.normals.assign(positions.size(), Vec3::UnitZ());
    return points;
}

core::WallScan confocal_scan(const std::vector<Vec3>& positions) {
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Confocal;
    scan.sensing = wall_points(positions);
    scan.illumination = scan.sensing;
    return scan;
}

core::WallScan single_scan(const Vec3& illumination, const std::vector<Vec3>& sensing) {
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Single;
    scan.sensing = wall_points(sensing);
    scan.illumination = wall_points({illumination});
    return scan;
}

core::WallScan exhaustive_scan(const std::vector<Vec3>& illumination,
                               const std::vector<Vec3>& sensing) {
    core::WallScan scan;
    scan.pattern = core::ScanPattern::Exhaustive;
    scan.sensing = wall_points(sensing);
    scan.illumination = wall_points(illumination);
    return scan;
}

core::Scan image_of(const core::PinholeCamera& camera) {
    return core::ImageScan{camera};
}

std::vector<renderer::Object> facing_surfaces() {
    return {parallelogram_object(
                {Vec3(-0.25, -0.2, 0.75), Vec3(0.45, 0.05, 0.15), Vec3(-0.05, 0.4, -0.1), 0.8}),
            parallelogram_object(
                {Vec3(0.3, -0.3, 0.5), Vec3(0.05, 0.6, 0.05), Vec3(0.0, 0.1, 0.4), 0.7}),
            parallelogram_object(
                {Vec3(-0.05, -0.1, 0.4), Vec3(0.15, 0, 0.02), Vec3(0.02, 0.2, 0), 0.5})};
}

std::vector<float> third_bounce_by_quadrature(const Parallelogram& hidden,
                                              const Parallelogram& occluder,
                                              const core::WallScan& scan,
                                              const core::TimeAxis& axis,
                                              double wall_albedo,
                                              int steps) {
    const auto num_bins = static_cast<std::size_t>(axis.num_bins);
    std::vector<double> sums(scan.num_pairs() * num_bins, 0.0);
    const Vec3 area_vector = hidden.u.cross(hidden.v);
    const Vec3 normal = area_vector.normalized();
    const double cell_area = area_vector.norm() / (double(steps) * steps);
    const double front = std::pow(wall_albedo / core::kPi, 2) * cell_area;
    renderer::Bsdf bsdf = renderer::Lambertian{hidden.albedo};
    if (hidden.roughness)
        bsdf = renderer::GgxConductor{hidden.albedo, std::pow(*hidden.roughness, 2)};
    const core::Mat3 facet_from_world = core::frame_from_normal(normal, hidden.u).transpose();
    for (int i = 0; i < steps; ++i) {
        for (int j = 0; j < steps; ++j) {
            const Vec3 p =
                hidden.corner + (i + 0.5) / steps * hidden.u + (j + 0.5) / steps * hidden.v;
            for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
                const Vec3& l = scan.illumination.positions[scan.illumination_index(pair)];
                const Vec3& s = scan.sensing.positions[scan.sensing_index(pair)];
                const Vec3 to_l = l - p;
                const Vec3 to_s = s - p;
                const double rl = to_l.norm();
                const double rs = to_s.norm();
                const double cos_l = -to_l.z() / rl;
                const double cos_s = -to_s.z() / rs;
                const double cos_pl = normal.dot(to_l) / rl;
                const double cos_ps = normal.dot(to_s) / rs;
                if (cos_l <= 0.0 || cos_s <= 0.0 || cos_pl * cos_ps <= 0.0) continue;
                const int bin =
                    static_cast<int>(std::floor((rl + rs - axis.opl_start_m) / axis.bin_width_m));
                if (bin < 0 || bin >= axis.num_bins) continue;
                if (crosses(p, l, occluder) || crosses(p, s, occluder)) continue;
                const double value = renderer::evaluate_bsdf(
                    bsdf, facet_from_world * (to_l / rl), facet_from_world * (to_s / rs));
                sums[pair * num_bins + static_cast<std::size_t>(bin)] +=
                    front * value * cos_l * cos_s * cos_pl * cos_ps / (rl * rl * rs * rs);
            }
        }
    }
    return {sums.begin(), sums.end()};
}

}  // namespace test_support
