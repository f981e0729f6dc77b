// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/shift/charts.h"

#include <cmath>
#include <optional>
#include <vector>

namespace test_support {

/// A smooth union of spheres as the zero set of phi(p) = -k log sum exp(-(|p - c_i| - r_i)/k):
/// a signed distance to within the blending length k.
struct SmoothSpheres {
    struct Sphere {
        core::Vec3 centre;
        double radius;
    };
    std::vector<Sphere> spheres;
    double blend_m = 0.1;

    struct Value {
        double phi;
        core::Vec3 gradient;
        core::Mat3 hessian;
    };

    /// With weights w_i = exp(-(s_i - phi)/k), sphere distances s_i, unit outward n_i:
    /// gradient g = sum w_i n_i, Hessian sum w_i (I - n n^T)/d_i - (sum w_i n n^T - g g^T)/k.
    Value at(const core::Vec3& p) const {
        double sum = 0.0;
        for (const Sphere& s : spheres) {
            sum += std::exp(-((p - s.centre).norm() - s.radius) / blend_m);
        }
        Value v{-blend_m * std::log(sum), core::Vec3::Zero(), core::Mat3::Zero()};
        for (const Sphere& s : spheres) {
            const double distance = (p - s.centre).norm();
            const core::Vec3 n = (p - s.centre) / distance;
            const double w = std::exp(-(distance - s.radius) / blend_m) / sum;
            const core::Mat3 nn = n * n.transpose();
            v.gradient += w * n;
            v.hessian += w * ((core::Mat3::Identity() - nn) / distance - nn / blend_m);
        }
        v.hessian += v.gradient * v.gradient.transpose() / blend_m;
        return v;
    }
};

/// A custom chart: heights of an implicit surface over a plane, X = xi_1 e_1 + xi_2 e_2 + h e_3
/// with phi(X) = 0, found by marching down from above.
///
/// Derivatives follow from phi = 0 along the surface, phi_i = grad phi . e_i and so on:
///     h_i  = -phi_i/phi_3
///     h_ij = -(phi_ij + phi_i3 h_j + phi_j3 h_i + phi_33 h_i h_j)/phi_3
class SdfChart {
 public:
    static constexpr bool kAffine = false;
    static constexpr bool kPeriodic = false;

    /// surface   must outlive the chart
    /// frame     columns e_1, e_2, e_3
    /// top_m     height from which the march starts
    SdfChart(const SmoothSpheres& surface, const core::Mat3& frame, double top_m)
        : surface_(&surface), frame_(frame), top_m_(top_m) {}

    std::optional<renderer::ChartPoint> at(const core::Vec2& xi) const {
        const auto height = height_at(xi);
        if (!height) return std::nullopt;
        const core::Vec3 position = frame_ * core::Vec3(xi.x(), xi.y(), *height);
        const auto value = surface_->at(position);
        const core::Vec3 phi = frame_.transpose() * value.gradient;
        if (phi.z() < kSteepest) return std::nullopt;
        const core::Mat3 phi2 = frame_.transpose() * value.hessian * frame_;
        const core::Vec2 h = -phi.head<2>() / phi.z();
        const auto second = [&](int i, int j) {
            const double h_ij =
                -(phi2(i, j) + phi2(i, 2) * h[j] + phi2(j, 2) * h[i] + phi2(2, 2) * h[i] * h[j]) /
                phi.z();
            return core::Vec3(h_ij * frame_.col(2));
        };
        renderer::ChartPoint point;
        point.position = position;
        point.tangent1 = frame_.col(0) + h.x() * frame_.col(2);
        point.tangent2 = frame_.col(1) + h.y() * frame_.col(2);
        point.second11 = second(0, 0);
        point.second12 = second(0, 1);
        point.second22 = second(1, 1);
        point.area_density = point.tangent1.cross(point.tangent2).norm();
        point.velocity.setZero();
        return point;
    }

 private:
    static constexpr double kSteepest = 0.05;  ///< of phi_3: beyond, the heights fold over
    static constexpr int kMaxSteps = 200;

    // phi is at most the distance along any line, so that steps of phi stay above the surface;
    // Newton's method finishes.
    std::optional<double> height_at(const core::Vec2& xi) const {
        double height = top_m_;
        for (int step = 0; step < kMaxSteps; ++step) {
            const auto value = surface_->at(frame_ * core::Vec3(xi.x(), xi.y(), height));
            const double gradient = value.gradient.dot(frame_.col(2));
            if (std::abs(value.phi) < 1e-3 && gradient > kSteepest) {
                const double change = value.phi / gradient;
                height -= change;
                if (std::abs(change) < 1e-14) return height;
                continue;
            }
            height -= value.phi;
            if (height < -top_m_) return std::nullopt;
        }
        return std::nullopt;
    }

    const SmoothSpheres* surface_;
    core::Mat3 frame_;
    double top_m_;
};

static_assert(renderer::SurfaceChart<SdfChart>);

}  // namespace test_support
