// SPDX-License-Identifier: MIT
// Mirror-like surfaces: the narrowest lobe that files may ask for, at every incidence.
#include "renderer/core/random.h"
#include "renderer/material/bsdf.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/statistics.h"

namespace hard_cases {
namespace {

using core::Vec3;
using truth::Quad;
using truth::QuadVec;

constexpr renderer::GgxConductor kMirrorLike{0.7, renderer::kSmallestGgxAlpha};

// D of the GGX distribution by the normal's cosine: with tan^2 = (1 - cos^2)/cos^2,
// D = 1/(pi alpha^2 cos^4 (1 + tan^2/alpha^2)^2).
Quad normal_density(const QuadVec& half) {
    const Quad alpha = kMirrorLike.alpha;
    const Quad tan2 = (half.x * half.x + half.y * half.y) / (half.z * half.z);
    const Quad spread = 1 + tan2 / (alpha * alpha);
    return 1 / (truth::pi() * alpha * alpha * half.z * half.z * half.z * half.z * spread * spread);
}

Quad smith_lambda(const QuadVec& direction) {
    const Quad alpha = kMirrorLike.alpha;
    const Quad tan2 =
        (direction.x * direction.x + direction.y * direction.y) / (direction.z * direction.z);
    return (truth::sqrtq(1 + alpha * alpha * tan2) - 1) / 2;
}

Quad evaluate(const QuadVec& in, const QuadVec& out) {
    const QuadVec half = (in + out).normalized();
    Quad fresnel = 1 - half.dot(in);
    fresnel = fresnel * fresnel * fresnel * fresnel * fresnel;
    fresnel = Quad(kMirrorLike.albedo) + (1 - Quad(kMirrorLike.albedo)) * fresnel;
    return normal_density(half) * fresnel /
           ((1 + smith_lambda(in) + smith_lambda(out)) * 4 * in.z * out.z);
}

Quad density(const QuadVec& in, const QuadVec& out) {
    return normal_density((in + out).normalized()) / (4 * in.z * (1 + smith_lambda(in)));
}

Vec3 direction_at(double cosine, double azimuth) {
    const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    return {sine * std::cos(azimuth), sine * std::sin(azimuth), cosine};
}

}  // namespace

double mirror_like_lobe_at_all_angles() {
    core::Rng rng(test_support::seed_of("mirror_like_lobe_at_all_angles"), 0, 0);
    Worst worst;
    for (int i = 0; i < 5000; ++i) {
        const Vec3 in = direction_at(std::pow(10.0, -6.0 * rng.uniform()), 6.28 * rng.uniform());
        // Around the mirrored direction, by some widths of the lobe.
        const double reach = kMirrorLike.alpha * std::pow(10.0, 2.0 * rng.uniform() - 1.0);
        const Vec3 out =
            (Vec3(-in.x(), -in.y(), in.z()) +
             reach * direction_at(std::abs(2.0 * rng.uniform() - 1.0), 6.28 * rng.uniform()))
                .normalized();
        worst.add(truth::relative_error(renderer::evaluate_bsdf(kMirrorLike, in, out),
                                        evaluate(in, out)));
        worst.add(
            truth::relative_error(renderer::pdf_bsdf(kMirrorLike, in, out), density(in, out)));
    }
    return worst.value();
}

double mirror_like_density_integrates_to_one() {
    // Over half vectors h, with tan = alpha sqrt(s/(1-s)) and azimuth: D cos dh = ds dphi/2pi, and
    // out = 2 (in.h) h - in turns density d(out) into 4 (in.h) dh. Directions below the surface are
    // not drawn; what they would hold is added by the formula.
    constexpr int kSteps = 1000;
    constexpr int kAzimuths = 100;
    Worst worst;
    for (const double cosine : {1.0, 0.5, 0.05}) {
        const Vec3 in = direction_at(cosine, 0.4);
        double sum = 0.0;
        double whole = 0.0;
        for (int i = 0; i < kSteps; ++i) {
            // s = u^2 (3 - 2u) flattens both ends.
            const double u = (i + 0.5) / kSteps;
            const double s = u * u * (3.0 - 2.0 * u);
            const double weight = u * (1.0 - u);
            whole += weight * kAzimuths;
            const double tan = kMirrorLike.alpha * std::sqrt(s / (1.0 - s));
            for (int j = 0; j < kAzimuths; ++j) {
                const double azimuth = 2.0 * core::kPi * (j + 0.5) / kAzimuths;
                const Vec3 half =
                    Vec3(tan * std::cos(azimuth), tan * std::sin(azimuth), 1.0).normalized();
                const double facing = in.dot(half);
                if (!(facing > 0.0)) continue;
                const Vec3 out = 2.0 * facing * half - in;
                const double of_normals = truth::to_double(normal_density(half)) * half.z();
                const double found =
                    out.z() > 0.0 ? renderer::pdf_bsdf(kMirrorLike, in, out)
                                  : truth::to_double(normal_density(half) /
                                                     (4 * Quad(in.z()) * (1 + smith_lambda(in))));
                sum += weight * found * 4.0 * facing / of_normals;
            }
        }
        worst.add(std::abs(sum / whole - 1.0));
    }
    return worst.value();
}

double mirror_like_draws_at_grazing_incidence() {
    core::Rng rng(test_support::seed_of("mirror_like_draws_at_grazing_incidence"), 0, 0);
    Worst worst;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 in = direction_at(std::pow(10.0, -12.0 * rng.uniform()), 6.28 * rng.uniform());
        const double u = rng.uniform();
        const auto out = renderer::sample_bsdf(kMirrorLike, in, {u, rng.uniform()});
        if (!out) continue;
        const double weight = renderer::evaluate_bsdf(kMirrorLike, in, *out) * out->z() /
                              renderer::pdf_bsdf(kMirrorLike, in, *out);
        worst.add(std::abs(out->norm() - 1.0));
        worst.add(weight >= 0.0 ? std::max(0.0, weight - 1.0) : HUGE_VAL);
    }
    return worst.value(10'000);
}

}  // namespace hard_cases
