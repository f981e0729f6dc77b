// SPDX-License-Identifier: MIT
#include "renderer/ellipsoidal/connection_technique.h"

#include "renderer/geometry/closed_surface.h"

namespace renderer {
namespace {

// Of the samples of a surface that follow a narrow lobe, the fraction that this technique does too.
constexpr double kLobeFraction = 0.75;

// Lobes of a larger alpha are not narrow: facets are then chosen by size and cosines alone.
constexpr double kWidestLobe = 0.3;

std::vector<std::uint32_t> kept_facets(const ExcludedFacets& excluded) {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < excluded.facets.size(); ++i) {
        if (!excluded.facets[i]) kept.push_back(i);
    }
    return kept;
}

core::Vec3 lit_normal(const PathEndpoint& end) {
    return end.isotropic ? core::Vec3(core::Vec3::Zero()) : end.normal;
}

// A vertex on a facet that has been chosen, if there is one.
std::optional<ConnectionDraw> connect_on(const Scene& scene,
                                         const FocusPair& foci,
                                         const std::optional<FacetChoice>& choice,
                                         core::Rng& rng,
                                         const ConnectionLobe* lobe = nullptr) {
    if (!choice) return std::nullopt;
    const double opl_m = choice->lengths.low_m + rng.uniform() * choice->lengths.width_m();
    const auto connection =
        sample_ellipsoid(foci, opl_m, scene.facet(choice->facet), rng.uniform(), lobe);
    if (!connection) return std::nullopt;
    return ConnectionDraw{
        {connection->position, choice->facet},
        choice->probability / choice->lengths.width_m() * connection->pdf_area_per_pdf_opl};
}

// Density of connect_on() and of the choice together [1/m^2].
double pdf_on(const Scene& scene,
              const FocusPair& foci,
              const FacetChoice& choice,
              const SurfacePoint& point,
              const ConnectionLobe* lobe = nullptr) {
    if (!(choice.probability > 0.0) || choice.facet != point.facet) return 0.0;
    const double opl_m = foci.opl_m(point.position);
    if (opl_m < choice.lengths.low_m || opl_m > choice.lengths.high_m) return 0.0;
    return choice.probability / choice.lengths.width_m() *
           pdf_ellipsoid(foci, scene.facet(point.facet), point.position, lobe);
}

}  // namespace

ConnectionEnds connection_ends(const PathVertex& vertex, const PathEndpoint& light) {
    const bool flipped = vertex.normal.dot(vertex.to_previous) < 0.0;
    return {{vertex.point.position, light.position},
            flipped ? core::Vec3(-vertex.normal) : vertex.normal,
            lit_normal(light)};
}

ConnectionEnds connection_ends(const PathEndpoints& ends) {
    return {{ends.sensor.position, ends.light.position},
            lit_normal(ends.sensor),
            lit_normal(ends.light)};
}

ConnectionTechnique::ConnectionTechnique(const Scene& scene,
                                         const ExcludedFacets& excluded,
                                         const core::Scan& scan)
    : scene_(&scene),
      is_excluded_(excluded.facets),
      hierarchy_(scene, kept_facets(excluded), visible_sides(scene.objects(), scan.path_ends())) {}

std::optional<LobeOnFacet> ConnectionTechnique::lobe_of(const PathVertex& vertex,
                                                        const core::Vec3& light,
                                                        std::uint64_t& num_rays) const {
    const double cosine = vertex.normal.dot(vertex.to_previous);
    const auto lobe = renderer::lobe_of(vertex.bsdf, std::abs(cosine));
    if (!lobe || lobe->alpha > kWidestLobe) return std::nullopt;
    const core::Vec3 mirrored = 2.0 * cosine * vertex.normal - vertex.to_previous;
    const core::Vec3 side = cosine < 0.0 ? core::Vec3(-vertex.normal) : vertex.normal;
    ++num_rays;
    const auto met = scene_->first_hit(vertex.point.position, side, mirrored);
    if (!met || is_excluded_[met->facet]) return std::nullopt;
    const core::Vec3& normal = scene_->facet(met->facet).normal;
    if (normal.dot(mirrored) * normal.dot(met->position - light) <= 0.0) return std::nullopt;
    // The lobe falls to half of its peak where the half vector is tilted by about alpha; the
    // direction turns by twice that angle.
    return LobeOnFacet{
        met->facet, {mirrored, met->position, 2.0 * lobe->alpha}, kLobeFraction * lobe->fraction};
}

// The facet that the lobe hits, with the probability that a draw takes it; 0 without a lobe or
// where the facet has none of the lengths.
FacetChoice ConnectionTechnique::choice_by_lobe(const ConnectionEnds& ends,
                                                const OplBand& lengths,
                                                const std::optional<LobeOnFacet>& lobe) const {
    if (!lobe) return {};
    const OplBand part = hierarchy_.part_of(lengths, ends.foci, lobe->facet);
    return {lobe->facet, part.width_m() > 0.0 ? lobe->probability : 0.0, part};
}

std::optional<ConnectionDraw> ConnectionTechnique::sample(
    const ConnectionEnds& ends,
    const OplBand& lengths,
    core::Rng& rng,
    const std::optional<LobeOnFacet>& lobe) const {
    const FacetChoice by_lobe = choice_by_lobe(ends, lengths, lobe);
    if (!(by_lobe.probability > 0.0)) {
        return connect_on(*scene_, ends.foci, hierarchy_.sample(ends, lengths, rng.uniform()), rng);
    }
    std::optional<ConnectionDraw> draw;
    if (rng.uniform() < by_lobe.probability) {
        draw = connect_on(*scene_, ends.foci, by_lobe, rng, &lobe->lobe);
        if (!draw) return std::nullopt;
        draw->pdf_area += (1.0 - by_lobe.probability) * pdf_area(ends, lengths, draw->point);
    } else {
        draw = connect_on(*scene_, ends.foci, hierarchy_.sample(ends, lengths, rng.uniform()), rng);
        if (!draw) return std::nullopt;
        draw->pdf_area = (1.0 - by_lobe.probability) * draw->pdf_area +
                         pdf_on(*scene_, ends.foci, by_lobe, draw->point, &lobe->lobe);
    }
    return draw;
}

double ConnectionTechnique::pdf_area(const ConnectionEnds& ends,
                                     const OplBand& lengths,
                                     const SurfacePoint& point,
                                     const std::optional<LobeOnFacet>& lobe) const {
    const double by_hierarchy =
        pdf_on(*scene_, ends.foci, hierarchy_.evaluate(ends, lengths, point.facet), point);
    if (!lobe) return by_hierarchy;
    const FacetChoice by_lobe = choice_by_lobe(ends, lengths, lobe);
    return (1.0 - by_lobe.probability) * by_hierarchy +
           pdf_on(*scene_, ends.foci, by_lobe, point, &lobe->lobe);
}

std::optional<ConnectionDraw> ConnectionTechnique::sample(const HierarchyCut& cut,
                                                          double u,
                                                          std::size_t& hint,
                                                          core::Rng& rng) const {
    return connect_on(*scene_, cut.foci(), cut.sample(u, hint), rng);
}

double ConnectionTechnique::pdf_area(const HierarchyCut& cut, const SurfacePoint& point) const {
    return pdf_on(*scene_, cut.foci(), cut.evaluate(point.facet), point);
}

}  // namespace renderer
