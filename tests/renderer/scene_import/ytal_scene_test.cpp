// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "tests/renderer/scene_import/foreign_scenes.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

namespace {

using namespace scene_import_test;
using core::Vec3;

const std::string kGeometry = example_yaml();

renderer::ImportedScene import_yaml(const std::string& keys,
                                    const std::string& geometry = kGeometry) {
    return import_text("scene.yaml", "name: test\n" + keys + geometry);
}

TEST(YtalScene, KeysThatAreLeftOutHaveItsDefaults) {
    const auto scene = import_yaml("");
    const auto& scan = scene.description.scan;
    EXPECT_EQ(scan.pattern, core::ScanPattern::Single);
    EXPECT_EQ(scan.sensing_points, (std::array<int, 2>{256, 256}));
    EXPECT_EQ(scan.opl_origin, core::OplOrigin::RelayWall);
    EXPECT_EQ(*scan.laser_m, Vec3(-0.5, 0, 0.25));
    EXPECT_EQ(*scan.detector_m, Vec3(-0.5, 0, 0.25));
    EXPECT_LT((*scan.illumination_m - Vec3(0, 0.1, 0)).norm(), 1e-12);  // the centre
    EXPECT_EQ(scene.description.time_axis.num_bins, 4096);
    EXPECT_EQ(scene.description.time_axis.bin_width_m, 0.003);
    EXPECT_EQ(scene.description.time_axis.opl_start_m, 0.0);
}

TEST(YtalScene, ScanAndAxisAreTranslated) {
    const auto scene = import_yaml(
        "num_bins: 1_000\nbin_width_opl: 0.01\nstart_opl: 0.5\naccount_first_and_last_bounces: "
        "yes\n"
        "sensor_width: 32\nsensor_height: 16\nlaser_x: 1\nlaser_y: 2\nlaser_z: 3\n"
        "laser_lookat_x: 8\nlaser_lookat_y: 12\n");
    const auto& scan = scene.description.scan;
    EXPECT_EQ(scene.description.time_axis.num_bins, 1000);
    EXPECT_EQ(scan.sensing_points, (std::array<int, 2>{32, 16}));
    EXPECT_EQ(scan.opl_origin, core::OplOrigin::Device);
    EXPECT_EQ(*scan.laser_m, Vec3(1, 2, 3));
    EXPECT_LT((*scan.illumination_m - Vec3(-0.5, 0.35, 0)).norm(), 1e-12);
    EXPECT_TRUE(import_yaml("auto_detect_bins: true\n").description.time_axis.automatic);
}

TEST(YtalScene, PatternsAreTranslated) {
    EXPECT_EQ(import_yaml("scan_type: confocal\nsensor_width: 32\nsensor_height: 32\n")
                  .description.scan.pattern,
              core::ScanPattern::Confocal);
    EXPECT_ERROR_WITH(import_yaml("scan_type: confocal\n"), "must be as many in a confocal scan");
    const auto scan =
        import_yaml("scan_type: exhaustive\nlaser_width: 4\nlaser_height: 2\n").description.scan;
    EXPECT_EQ(scan.pattern, core::ScanPattern::Exhaustive);
    EXPECT_EQ(scan.illumination_points, (std::array<int, 2>{4, 2}));
    EXPECT_ERROR_WITH(import_yaml("scan_type: spiral\n"), "scan_type: found spiral");
}

TEST(YtalScene, AperturesBoundWhatTheLaserScans) {
    const std::string aperture = "laser_aperture_start_x: 0.5\nlaser_aperture_end_y: 0.5\n";
    const auto confocal =
        import_yaml("scan_type: confocal\nsensor_width: 32\nsensor_height: 32\n" + aperture)
            .description.relay_wall;
    EXPECT_LT((confocal.center_m - Vec3(0.5, -0.15, 0)).norm(), 1e-12);
    EXPECT_EQ(confocal.size_m, (std::array<double, 2>{1.0, 0.5}));

    const auto exhaustive =
        import_yaml("scan_type: exhaustive\nlaser_width: 2\nlaser_height: 1\n" + aperture)
            .description;
    ASSERT_EQ(exhaustive.scan.illumination_points_m.size(), 2U);
    EXPECT_LT((exhaustive.scan.illumination_points_m[0] - Vec3(0.25, -0.15, 0)).norm(), 1e-12);
    EXPECT_LT((exhaustive.scan.illumination_points_m[1] - Vec3(0.75, -0.15, 0)).norm(), 1e-12);
    EXPECT_EQ(exhaustive.relay_wall.size_m, (std::array<double, 2>{2.0, 1.0}));
    EXPECT_ERROR_WITH(import_yaml("laser_aperture_start_x: 2\n"),
                      "laser_aperture_start_x: found 2");
}

TEST(YtalScene, GeometryIsScaledTurnedAndMoved) {
    const auto scene = import_yaml("");
    ASSERT_EQ(scene.geometry.objects.size(), 1U);
    const renderer::Object& object = scene.geometry.objects[0];
    EXPECT_EQ(object.name, "Z");
    EXPECT_EQ(object.material.albedo, 1.0);
    // (1, 0, 0) stretched to (2, 0, 0), turned to (0, 2, 0), moved.
    EXPECT_LT((object.mesh.vertices.at(1) - Vec3(0.5, 2, 1)).norm(), 1e-12);
    const renderer::RelayWall& wall = scene.description.relay_wall;
    EXPECT_EQ(wall.center_m, Vec3(0, 0.1, 0));
    EXPECT_EQ(wall.size_m, (std::array<double, 2>{2.0, 1.0}));
    EXPECT_EQ(wall.albedo, 1.0);
}

TEST(YtalScene, MaterialsAreTranslated) {
    const auto material = [](const std::string& text) {
        std::string geometry = kGeometry;
        geometry.replace(geometry.find("    id: white\n"), 14, text);
        return import_yaml("", geometry).geometry.objects.at(0).material;
    };
    const auto copper = material("    id: copper\n    alpha: 0.25\n");
    EXPECT_EQ(copper.model, renderer::model_of({.metallic = true}));
    EXPECT_NEAR(copper.roughness, 0.5, 1e-12);
    const auto custom = material(
        "    id: custom\n    text: |\n      <bsdf type=\"diffuse\">\n"
        "        <rgb name=\"reflectance\" value=\"0.2\"/>\n      </bsdf>\n");
    EXPECT_NEAR(custom.albedo, 0.2, 1e-12);
    EXPECT_ERROR_WITH(material("    id: gold\n"), "geometry[0].material.id: found gold");
}

TEST(YtalScene, WhatIsNotTranslatedIsListed) {
    const auto scene = import_yaml(
        "mitsuba_variant: llvm_ad_rgb\nsample_count: 1_000_000\n"
        "integrator_nlos_hidden_geometry_sampling: true\nlaser_emission: 1.0, 1.0, 1.0\n");
    EXPECT_TRUE(lists(scene, "sample_count: is not translated"));
    EXPECT_TRUE(lists(scene, "integrator_nlos_hidden_geometry_sampling: is not translated"));
    EXPECT_TRUE(lists(scene, "laser_emission: its power is not translated"));
    EXPECT_FALSE(lists(scene, "mitsuba_variant"));
}

TEST(YtalScene, WrongScenesAreNamed) {
    EXPECT_ERROR_WITH(import_yaml("relay_walls: a\nrelay_wall: gone\n", "geometry: []\n"),
                      "relay_wall: found gone");
    EXPECT_ERROR_WITH(import_yaml("", "geometry: 3\n"), "geometry: found 3");
    EXPECT_ERROR_WITH(import_yaml("num_bins: many\n"), "num_bins: found \"many\"");
    EXPECT_ERROR_WITH(import_yaml("histogram_mode: frequency\n"),
                      "histogram_mode: found frequency");
    EXPECT_ERROR_WITH(import_text("scene.yaml", "just text"), "must be an object");
}

}  // namespace
