// SPDX-License-Identifier: MIT
#include "renderer/connection_technique.h"

#include "renderer/closed_surface.h"

namespace renderer {
namespace {

std::vector<std::uint32_t> kept_facets(const ExcludedFacets& excluded) {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < excluded.facets.size(); ++i) {
        if (!excluded.facets[i]) kept.push_back(i);
    }
    return kept;
}

std::vector<int> visible_sides(const Scene& scene, const core::Scan& scan) {
    std::vector<int> sides;
    for (const Object& object : scene.objects()) sides.push_back(visible_side(object, scan));
    return sides;
}

core::Vec3 lit_normal(const PathEnd& end) {
    return end.isotropic ? core::Vec3(core::Vec3::Zero()) : end.normal;
}

}  // namespace

ExcludedFacets ExcludedFacets::of(const Scene& scene, const RenderSettings& settings) {
    ExcludedFacets excluded;
    excluded.facets.resize(scene.facets().size());
    if (settings.exclude == Exclusion::None) return excluded;
    std::vector<bool> touched(scene.objects().size());
    for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
        const Object& object = scene.object_of(i);
        const bool too_large = settings.exclude_area_above_m2 &&
                               scene.facet(i).area_m2 > *settings.exclude_area_above_m2;
        excluded.facets[i] = object.role != Role::Hidden || object.ellipsoidal_exclude || too_large;
        if (excluded.facets[i]) touched[scene.facet(i).object] = true;
    }
    for (std::size_t o = 0; o < touched.size(); ++o) {
        if (touched[o]) excluded.objects.push_back(scene.objects()[o].name);
    }
    return excluded;
}

ConnectionEnds connection_ends(const PathVertex& vertex, const PathEnd& light) {
    const bool flipped = vertex.normal.dot(vertex.to_previous) < 0.0;
    return {{vertex.point.position, light.position},
            flipped ? core::Vec3(-vertex.normal) : vertex.normal,
            lit_normal(light)};
}

ConnectionEnds connection_ends(const PathEnds& ends) {
    return {{ends.sensor.position, ends.light.position},
            lit_normal(ends.sensor),
            lit_normal(ends.light)};
}

ConnectionTechnique::ConnectionTechnique(const Scene& scene,
                                         const ExcludedFacets& excluded,
                                         const core::Scan& scan)
    : scene_(&scene), hierarchy_(scene, kept_facets(excluded), visible_sides(scene, scan)) {}

std::optional<ConnectionDraw> ConnectionTechnique::place(const FocusPair& foci,
                                                         const std::optional<FacetChoice>& choice,
                                                         core::Rng& rng) const {
    if (!choice) return std::nullopt;
    const double opl_m = choice->lengths.low_m + rng.uniform() * choice->lengths.width_m();
    const auto connection =
        sample_ellipsoid(foci, opl_m, scene_->facet(choice->facet), rng.uniform());
    if (!connection) return std::nullopt;
    return ConnectionDraw{
        {connection->position, choice->facet},
        choice->probability / choice->lengths.width_m() * connection->pdf_area_per_pdf_opl};
}

double ConnectionTechnique::pdf_of(const FocusPair& foci,
                                   const FacetChoice& choice,
                                   const SurfacePoint& point) const {
    if (!(choice.probability > 0.0)) return 0.0;
    const double opl_m = foci.opl_m(point.position);
    if (opl_m < choice.lengths.low_m || opl_m > choice.lengths.high_m) return 0.0;
    return choice.probability / choice.lengths.width_m() *
           pdf_ellipsoid(foci, scene_->facet(point.facet), point.position);
}

std::optional<ConnectionDraw> ConnectionTechnique::sample(const ConnectionEnds& ends,
                                                          const OplBand& lengths,
                                                          core::Rng& rng) const {
    return place(ends.foci, hierarchy_.sample(ends, lengths, rng.uniform()), rng);
}

double ConnectionTechnique::pdf_area(const ConnectionEnds& ends,
                                     const OplBand& lengths,
                                     const SurfacePoint& point) const {
    return pdf_of(ends.foci, hierarchy_.evaluate(ends, lengths, point.facet), point);
}

std::optional<ConnectionDraw> ConnectionTechnique::sample(const HierarchyCut& cut,
                                                          double u,
                                                          std::size_t& hint,
                                                          core::Rng& rng) const {
    return place(cut.foci(), cut.sample(u, hint), rng);
}

double ConnectionTechnique::pdf_area(const HierarchyCut& cut, const SurfacePoint& point) const {
    return pdf_of(cut.foci(), cut.evaluate(point.facet), point);
}

}  // namespace renderer
