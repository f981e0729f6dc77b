// SPDX-License-Identifier: MIT
#include "renderer/shift/charts.h"

#include "renderer/geometry/planar_patches.h"

#include <cmath>
#include <limits>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

constexpr double kPole = 1.0 - 1e-4;
constexpr double kHorizon = 1e-4;
constexpr double kEdgeOn = 1e-4;  ///< smallest cosine of a ray to a facet's normal

bool is_inside(double mu) {
    return mu > kHorizon && mu < kPole;
}

// A unit direction and its derivatives by (mu, psi), relative to the normal at y.
struct Direction {
    Vec3 d, by_mu, by_psi, by_mu_mu, by_mu_psi, by_psi_psi;

    explicit Direction(const Vec2& xi) {
        const double mu = xi.x();
        const double phi = 2.0 * core::kPi * xi.y();
        const double sine = std::sqrt(1.0 - mu * mu);
        const Vec3 radial(std::cos(phi), std::sin(phi), 0.0);
        const Vec3 around(-radial.y(), radial.x(), 0.0);
        d = sine * radial + mu * Vec3::UnitZ();
        by_mu = -mu / sine * radial + Vec3::UnitZ();
        by_psi = 2.0 * core::kPi * sine * around;
        by_mu_mu = -1.0 / (sine * sine * sine) * radial;
        by_mu_psi = -2.0 * core::kPi * mu / sine * around;
        by_psi_psi = -4.0 * core::kPi * core::kPi * sine * radial;
    }
};

}  // namespace

HemisphereChart::HemisphereChart(
    const Scene& scene, const Vec3& y, const Vec3& normal, const Vec3& seen, double rounding_m)
    : scene_(&scene), y_(y), origin_(seen), rounding_m_(rounding_m) {
    const Vec3 up = std::copysign(1.0, normal.dot(seen - y)) * normal;
    world_from_local_ = core::frame_from_normal(up, scene.tangent_hint(normal));
}

std::optional<Vec2> HemisphereChart::coordinates_of(const Vec3& position) const {
    const Vec3 d = world_from_local_.transpose() * (position - y_).normalized();
    if (!is_inside(d.z())) return std::nullopt;
    return Vec2(d.z(), std::atan2(d.y(), d.x()) / (2.0 * core::kPi));
}

std::optional<ChartPoint> HemisphereChart::at(const Vec2& xi) const {
    if (!is_inside(xi.x())) return std::nullopt;
    const Vec3 direction = world_from_local_ * Direction(xi).d;
    const auto hit = scene_->rays().first_hit(y_, world_from_local_.col(2), direction);
    if (!hit) return std::nullopt;
    auto point = on_facet(xi, hit->triangle);
    // Rays are traced in single precision and may hit a facet just outside its edge.
    if (point &&
        !is_in_triangle(barycentric_of(scene_->facet(hit->triangle), point->position + origin_))) {
        return std::nullopt;
    }
    return point;
}

// On the plane n.(X - corner) = 0 the point is X = y + k d/(n.d) with k = n.(corner - y). With
// s = n.d, rho = k/s, and indices for derivatives:
//     X_i  = rho (d_i - s_i/s d)
//     X_ij = rho (d_ij - s_i/s d_j - s_j/s d_i - s_ij/s d + 2 s_i s_j/s^2 d)
std::optional<ChartPoint> HemisphereChart::on_facet(const Vec2& xi, std::uint32_t facet) const {
    if (!is_inside(xi.x())) return std::nullopt;
    const Facet& plane = scene_->facet(facet);
    const Direction dir(xi);
    const Vec3 normal = world_from_local_.transpose() * plane.normal;
    const double s = normal.dot(dir.d);
    if (std::abs(s) < kEdgeOn) return std::nullopt;
    const double rho = plane.normal.dot(plane.corner - y_) / s;
    if (!(rho > 0.0)) return std::nullopt;
    const double a = normal.dot(dir.by_mu) / s;
    const double b = normal.dot(dir.by_psi) / s;
    const double a_a = normal.dot(dir.by_mu_mu) / s;
    const double a_b = normal.dot(dir.by_mu_psi) / s;
    const double b_b = normal.dot(dir.by_psi_psi) / s;

    ChartPoint point;
    point.position = (y_ - origin_) + rho * (world_from_local_ * dir.d);
    const auto world = [&](const Vec3& local) { return Vec3(rho * (world_from_local_ * local)); };
    point.tangent1 = world(dir.by_mu - a * dir.d);
    point.tangent2 = world(dir.by_psi - b * dir.d);
    point.second11 = world(dir.by_mu_mu - 2.0 * a * dir.by_mu + (2.0 * a * a - a_a) * dir.d);
    point.second12 =
        world(dir.by_mu_psi - a * dir.by_psi - b * dir.by_mu + (2.0 * a * b - a_b) * dir.d);
    point.second22 = world(dir.by_psi_psi - 2.0 * b * dir.by_psi + (2.0 * b * b - b_b) * dir.d);
    // Both y and the angle are rounded, which moves a point seen at a grazing angle further.
    const double sine = std::sqrt(1.0 - xi.x() * xi.x());
    point.rounding_m =
        (rounding_m_ + rho * std::numeric_limits<double>::epsilon() / sine) / std::abs(s);
    point.area_density = point.tangent1.cross(point.tangent2).norm();
    point.velocity = scene_->object_of(facet).velocity_m_per_s;
    point.facet = facet;
    return point;
}

}  // namespace renderer
