// SPDX-License-Identifier: MIT
#include "renderer/material/bsdf.h"

#include "renderer/core/sampling.h"
#include "renderer/material/ggx.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec2;
using core::Vec3;

constexpr double kDielectricReflectance = 0.04;  // at normal incidence, index 1.5

// All overloads see incoming.z > 0 and outgoing.z > 0.

double evaluate_(const Lambertian& bsdf, const Vec3&, const Vec3&) {
    return bsdf.albedo / kPi;
}
double pdf_(const Lambertian&, const Vec3&, const Vec3& outgoing) {
    return outgoing.z() / kPi;
}
std::optional<Vec3> sample_(const Lambertian&, const Vec3&, const Vec2& u) {
    return core::sample_cosine_hemisphere(u);
}

double normal_density(double alpha, const Vec3& half) {
    return ggx_normal_density(alpha, half.z() * half.z(), half.head<2>().squaredNorm());
}

double evaluate_(const Ggx& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    const Vec3 half = (incoming + outgoing).normalized();
    return ggx_value(bsdf.albedo,
                     bsdf.alpha,
                     normal_density(bsdf.alpha, half),
                     incoming.z(),
                     outgoing.z(),
                     half.dot(incoming));
}

// The density of visible normals is D max(0, i.h) / ((1 + Lambda(i)) i_z), and reflection about h
// divides it by 4 i.h.
double pdf_(const Ggx& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    const Vec3 half = (incoming + outgoing).normalized();
    return normal_density(bsdf.alpha, half) /
           (2.0 * (incoming.z() + ggx_masking(bsdf.alpha, incoming.z())));
}

std::optional<Vec3> sample_(const Ggx& bsdf, const Vec3& incoming, const Vec2& u) {
    // Stretch the surface so that its microfacets form a hemisphere, draw a point of the visible
    // half disk about the view direction, and shrink the normal found there.
    const Vec3 view =
        Vec3(bsdf.alpha * incoming.x(), bsdf.alpha * incoming.y(), incoming.z()).normalized();
    const double radius = std::sqrt(u.x());
    const double angle = 2.0 * kPi * u.y();
    // The half disk is squeezed along `upward`, in which the surface is foreshortened.
    const Vec3 across = std::abs(view.z()) < 1.0 - 1e-12
                            ? Vec3(Vec3::UnitZ().cross(view).normalized())
                            : Vec3(Vec3::UnitX());
    const Vec3 upward = view.cross(across);
    const double t1 = radius * std::cos(angle);
    const double squeeze = 0.5 * (1.0 + view.z());
    const double t2 = (1.0 - squeeze) * std::sqrt(std::max(0.0, 1.0 - t1 * t1)) +
                      squeeze * radius * std::sin(angle);
    const double t3 = std::sqrt(std::max(0.0, 1.0 - t1 * t1 - t2 * t2));
    const Vec3 stretched = t1 * across + t2 * upward + t3 * view;
    const Vec3 half =
        Vec3(bsdf.alpha * stretched.x(), bsdf.alpha * stretched.y(), std::max(1e-12, stretched.z()))
            .normalized();
    const Vec3 outgoing = 2.0 * incoming.dot(half) * half - incoming;
    if (!(outgoing.z() > 0.0)) return std::nullopt;
    return outgoing;
}

double evaluate_(const Retroreflective&, const Vec3&, const Vec3&) {
    return 0.0;
}
double pdf_(const Retroreflective&, const Vec3&, const Vec3&) {
    return 0.0;
}
std::optional<Vec3> sample_(const Retroreflective&, const Vec3&, const Vec2&) {
    return std::nullopt;
}

// Reflected share at an angle of this cosine, by Schlick's approximation.
double dielectric_fresnel(double cosine) {
    return kDielectricReflectance + (1.0 - kDielectricReflectance) * std::pow(1.0 - cosine, 5);
}

double evaluate_(const Dielectric& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    const double let_through =
        (1.0 - dielectric_fresnel(incoming.z())) * (1.0 - dielectric_fresnel(outgoing.z()));
    return let_through * bsdf.albedo / kPi +
           evaluate_(Ggx{kDielectricReflectance, bsdf.alpha}, incoming, outgoing);
}

// How often the interface is sampled instead of the body.
double share_of_interface(const Dielectric& bsdf, const Vec3& incoming) {
    const double reflected = dielectric_fresnel(incoming.z());
    return std::clamp(reflected / (reflected + (1.0 - reflected) * bsdf.albedo), 0.1, 0.9);
}

double pdf_(const Dielectric& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    const double share = share_of_interface(bsdf, incoming);
    return share * pdf_(Ggx{1.0, bsdf.alpha}, incoming, outgoing) +
           (1.0 - share) * pdf_(Lambertian{}, incoming, outgoing);
}

std::optional<Vec3> sample_(const Dielectric& bsdf, const Vec3& incoming, const Vec2& u) {
    const double share = share_of_interface(bsdf, incoming);
    if (u.x() < share) return sample_(Ggx{1.0, bsdf.alpha}, incoming, {u.x() / share, u.y()});
    return sample_(Lambertian{}, incoming, {(u.x() - share) / (1.0 - share), u.y()});
}

bool same_side(const Vec3& a, const Vec3& b) {
    return a.z() * b.z() > 0.0;
}

// Both sides scatter alike: mirror the lower half space onto the upper.
Vec3 upper(const Vec3& direction, double side) {
    return {direction.x(), direction.y(), side < 0.0 ? -direction.z() : direction.z()};
}

}  // namespace

double evaluate_bsdf(const Bsdf& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    if (!same_side(incoming, outgoing)) return 0.0;
    const Vec3 in = upper(incoming, incoming.z());
    const Vec3 out = upper(outgoing, incoming.z());
    return std::visit([&](const auto& model) { return evaluate_(model, in, out); }, bsdf);
}

double pdf_bsdf(const Bsdf& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    if (!same_side(incoming, outgoing)) return 0.0;
    const Vec3 in = upper(incoming, incoming.z());
    const Vec3 out = upper(outgoing, incoming.z());
    return std::visit([&](const auto& model) { return pdf_(model, in, out); }, bsdf);
}

std::optional<Vec3> sample_bsdf(const Bsdf& bsdf, const Vec3& incoming, const Vec2& u) {
    if (incoming.z() == 0.0) return std::nullopt;
    const Vec3 in = upper(incoming, incoming.z());
    const std::optional<Vec3> out =
        std::visit([&](const auto& model) { return sample_(model, in, u); }, bsdf);
    if (!out || out->z() == 0.0) return std::nullopt;
    return upper(*out, incoming.z());
}

double albedo_of(const Bsdf& bsdf) {
    return std::visit([](const auto& model) { return model.albedo; }, bsdf);
}

}  // namespace renderer
