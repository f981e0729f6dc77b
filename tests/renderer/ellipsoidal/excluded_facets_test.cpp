// SPDX-License-Identifier: MIT
// Which facets no connection goes to, and what that takes from the hierarchy.
#include "renderer/ellipsoidal/excluded_facets.h"

#include "renderer/ellipsoidal/connection_technique.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using core::Vec3;
using renderer::ConnectionEnds;
using renderer::Scene;

TEST(ExcludedFacets, AreThoseOfWallsFlaggedObjectsAndLargeFacets) {
    renderer::SceneGeometry geometry;
    const auto add = [&](const std::string& name, double size) -> renderer::Object& {
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(0, 0, 1.0 + 0.1 * static_cast<double>(geometry.objects.size())),
             Vec3(size, 0, 0),
             Vec3(0, size, 0)}));
        geometry.objects.back().name = name;
        return geometry.objects.back();
    };
    add("small", 0.1);
    add("large", 1.0);
    add("back", 0.1).role = renderer::Role::BackWall;
    add("flagged", 0.1).ellipsoidal_exclude = true;
    const core::WallScan scan = test_support::confocal_scan({Vec3::Zero()});
    const Scene scene(std::move(geometry), scan, renderer::RelayWall{});
    renderer::RenderSettings settings;
    const core::TimeAxis axis{0.0, 0.01, 100};
    using Names = std::vector<std::string>;
    EXPECT_EQ(renderer::ExcludedFacets::of(scene, axis, settings).objects.names,
              (Names{"back", "flagged", "relay_wall"}));
    settings.exclude_area_above_m2 = 0.1;
    settings.exclude = renderer::Exclusion::Drop;
    const auto excluded = renderer::ExcludedFacets::of(scene, axis, settings);
    EXPECT_EQ(excluded.objects.names, (Names{"large", "back", "flagged", "relay_wall"}));
    EXPECT_TRUE(excluded.objects.connected.empty());
    settings.exclude = renderer::Exclusion::None;
    EXPECT_TRUE(renderer::ExcludedFacets::of(scene, axis, settings).objects.names.empty());

    const renderer::ConnectionTechnique technique(scene, excluded, scan);
    const ConnectionEnds ends{{Vec3::Zero(), Vec3::Zero()}, Vec3::UnitZ(), Vec3::UnitZ()};
    for (std::uint32_t f = 0; f < scene.facets().size(); ++f) {
        const double p = technique.hierarchy().evaluate(ends, {0.0, 10.0}, f).probability;
        EXPECT_EQ(p > 0.0, scene.object_of(f).name == "small") << scene.object_of(f).name;
    }
}

// What `mis` leaves to walks they must be able to find: not a wall in a short gate.
TEST(ExcludedFacets, OfModeMisAreConnectedToInGatesShorterThanTheyAreWide) {
    renderer::SceneGeometry geometry;
    for (const double size : {0.3, 3.0}) {
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(0, 0, 1), Vec3(0.8 * size, 0, 0), Vec3(0, 0.6 * size, 0)}));
        geometry.objects.back().name = size > 1.0 ? "wall" : "panel";
        geometry.objects.back().role = renderer::Role::BackWall;
    }
    const core::WallScan scan = test_support::confocal_scan({Vec3::Zero()});
    const Scene scene(std::move(geometry), scan, renderer::RelayWall{});
    renderer::RenderSettings settings;
    using Names = std::vector<std::string>;
    const auto excluded = [&](const core::TimeAxis& axis) {
        return renderer::ExcludedFacets::of(scene, axis, settings);
    };
    for (const renderer::Exclusion mode : {renderer::Exclusion::Mis, renderer::Exclusion::Drop}) {
        settings.exclude = mode;
        const bool connects = mode == renderer::Exclusion::Mis;
        for (const auto& [axis, connected] :
             {std::pair{core::TimeAxis{0.5, 3.01, 1}, Names{}},
              {core::TimeAxis{0.5, 0.01, 299}, Names{"wall"}},
              {core::TimeAxis{0.5, 0.31, 1}, Names{"wall"}},
              {core::TimeAxis{0.5, 0.29, 1}, Names{"panel", "wall"}}}) {
            const auto found = excluded(axis);
            EXPECT_EQ(found.objects.names, (Names{"panel", "wall", "relay_wall"}));
            EXPECT_EQ(found.objects.connected, connects ? connected : Names{});
            for (std::uint32_t f = 0; f < scene.facets().size(); ++f) {
                const auto& names = found.objects.connected;
                const bool is_connected =
                    std::find(names.begin(), names.end(), scene.object_of(f).name) != names.end();
                EXPECT_EQ(found.facets[f], !is_connected) << scene.object_of(f).name;
            }
        }
    }
}

// A plane that holds an end carries nothing to it, and bounds of cosines know: of a flat relay wall
// exclusion has nothing to take away. On a curved one it has.
TEST(ExcludedFacets, TakeDrawsFromCurvedRelayWallsAlone) {
    for (const bool curved : {false, true}) {
        renderer::SceneGeometry geometry;
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(-0.2, -0.2, 0.8), Vec3(0.4, 0, 0), Vec3(0, 0.4, 0)}));
        for (const double slope : curved ? std::vector{-0.5, 0.5} : std::vector{0.0}) {
            geometry.objects.push_back(test_support::parallelogram_object(
                {Vec3(0, -1, 0),
                 Vec3(slope < 0.0 ? -1.0 : 1.0, 0, std::abs(slope)),
                 Vec3(0, 2, 0)}));
            geometry.objects.back().role = renderer::Role::RelayWall;
        }
        const core::WallScan scan =
            test_support::confocal_scan({Vec3(0.5, 0.1, curved ? 0.25 : 0.0)});
        const Vec3 normal = curved ? Vec3(-0.5, 0, 1).normalized() : Vec3(Vec3::UnitZ());
        const Scene scene(std::move(geometry), scan, renderer::RelayWall{});
        renderer::RenderSettings settings;
        settings.exclude = renderer::Exclusion::None;
        const core::TimeAxis axis{0.1, 4.0, 1};
        const renderer::ConnectionTechnique technique(
            scene, renderer::ExcludedFacets::of(scene, axis, settings), scan);
        const Vec3 spot = scan.sensing.positions[0];
        double fraction = 0.0;
        for (std::uint32_t f = 0; f < scene.facets().size(); ++f) {
            if (scene.object_of(f).role != renderer::Role::RelayWall) continue;
            fraction += technique.hierarchy()
                            .evaluate({{spot, spot}, normal, normal}, {0.1, 4.1}, f)
                            .probability;
        }
        EXPECT_TRUE(curved ? fraction > 0.1 : fraction < 1e-3) << fraction;
    }
}

}  // namespace
