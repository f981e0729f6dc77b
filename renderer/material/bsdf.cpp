// SPDX-License-Identifier: MIT
#include "renderer/material/bsdf.h"

#include <cassert>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

constexpr auto kDefaults = []<class... Models>(const std::variant<Models...>*) {
    return std::array{Bsdf(Models{})...};
}(static_cast<const Bsdf*>(nullptr));

// Narrower lobes are not smooth over an element of a surface.
constexpr double kSmallestAlphaOfElements = 0.03;

bool same_side(const Vec3& a, const Vec3& b) {
    return a.z() * b.z() > 0.0;
}

// Both sides scatter alike: mirror the lower half space onto the upper.
Vec3 upper(const Vec3& direction, double side) {
    return {direction.x(), direction.y(), side < 0.0 ? -direction.z() : direction.z()};
}

}  // namespace

SurfaceModel model_of(const GltfSurface& surface) {
    std::size_t i = 0;
    while (i < kNumSurfaceModels && kSurfaceTraits[i].gltf != surface) ++i;
    assert(i < kNumSurfaceModels);
    return static_cast<SurfaceModel>(i);
}

std::string model_names(bool (*holds)(const SurfaceTraits&)) {
    std::string names;
    for (const SurfaceTraits& traits : kSurfaceTraits) {
        if (!holds(traits)) continue;
        names += (names.empty() ? "" : " or ") + std::string(traits.name);
    }
    return names;
}

Bsdf make_bsdf(SurfaceModel model, double albedo, double alpha) {
    Bsdf bsdf = kDefaults[static_cast<std::size_t>(model)];
    std::visit(
        [&]<class Model>(Model& made) {
            made.albedo = albedo;
            if constexpr (Model::kTraits.has_lobe) made.alpha = alpha;
        },
        bsdf);
    return bsdf;
}

double evaluate_bsdf(const Bsdf& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    if (!same_side(incoming, outgoing)) return 0.0;
    const Vec3 in = upper(incoming, incoming.z());
    const Vec3 out = upper(outgoing, incoming.z());
    return std::visit([&](const auto& model) { return model.evaluate(in, out); }, bsdf);
}

double pdf_bsdf(const Bsdf& bsdf, const Vec3& incoming, const Vec3& outgoing) {
    if (!same_side(incoming, outgoing)) return 0.0;
    const Vec3 in = upper(incoming, incoming.z());
    const Vec3 out = upper(outgoing, incoming.z());
    return std::visit([&](const auto& model) { return model.pdf(in, out); }, bsdf);
}

std::optional<Vec3> sample_bsdf(const Bsdf& bsdf, const Vec3& incoming, const Vec2& u) {
    if (incoming.z() == 0.0) return std::nullopt;
    const Vec3 in = upper(incoming, incoming.z());
    const std::optional<Vec3> out =
        std::visit([&](const auto& model) { return model.sample(in, u); }, bsdf);
    if (!out || out->z() == 0.0) return std::nullopt;
    return upper(*out, incoming.z());
}

double reflects_at_most(const Bsdf& bsdf, double cosine) {
    return std::visit([&](const auto& model) { return model.reflects_at_most(cosine); }, bsdf);
}

std::optional<Lobe> lobe_of(const Bsdf& bsdf, double cosine) {
    return std::visit(
        [&]<class Model>(const Model& model) -> std::optional<Lobe> {
            if constexpr (Model::kTraits.has_lobe) {
                return Lobe{model.alpha, model.lobe_fraction(cosine)};
            }
            return std::nullopt;
        },
        bsdf);
}

std::optional<ElementResponse> element_response(const Bsdf& bsdf) {
    const auto response = traits_of(bsdf).element;
    const bool is_narrow =
        response && response->glossy && lobe_of(bsdf, 1.0)->alpha < kSmallestAlphaOfElements;
    return is_narrow ? std::nullopt : response;
}

}  // namespace renderer
