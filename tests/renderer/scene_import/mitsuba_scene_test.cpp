// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/renderer/scene_import/foreign_scenes.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

namespace {

using namespace scene_import_test;
using core::Vec3;

renderer::ImportedScene import_xml(const Values& values) {
    return import_text("scene.xml", example_xml(values));
}

double hidden_albedo(const std::string& bsdf) {
    return import_xml({{"@@shape", bsdf}}).geometry.objects.at(0).material.albedo;
}

TEST(MitsubaScene, ScanAxisAndDevicesAreTranslated) {
    const auto scene = import_xml({});
    const auto& scan = scene.description.scan;
    EXPECT_EQ(scan.pattern, core::ScanPattern::Single);
    EXPECT_EQ(scan.sensing_points, (std::array<int, 2>{12, 8}));
    EXPECT_EQ(scan.opl_origin, core::OplOrigin::RelayWall);
    EXPECT_LT((*scan.laser_m - Vec3(-0.5, 0, 0.25)).norm(), 1e-12);
    EXPECT_LT((*scan.detector_m - Vec3(0.1, 0.2, 0.3)).norm(), 1e-12);
    EXPECT_LT((*scan.illumination_m - Vec3(0.25, -0.125, 0)).norm(), 1e-9);
    EXPECT_EQ(scene.description.time_axis.opl_start_m, 1.5);
    EXPECT_EQ(scene.description.time_axis.bin_width_m, 0.01);
    EXPECT_EQ(scene.description.time_axis.num_bins, 300);
    EXPECT_EQ(scene.description.render.max_bounces, 5);  // its max_depth of 6 counts the light too
}

TEST(MitsubaScene, PatternAndBouncesComeFromTheIntegrator) {
    const auto pattern = [](const std::string& tag, const std::string& value) {
        return import_xml({{"@@integrator",
                            "<" + tag + " name=\"capture_type\" value=\"" + value + "\"/>"}})
            .description.scan.pattern;
    };
    EXPECT_EQ(pattern("string", "Confocal"), core::ScanPattern::Confocal);
    EXPECT_EQ(pattern("string", "exhaustive"), core::ScanPattern::Exhaustive);
    EXPECT_EQ(pattern("integer", "1"), core::ScanPattern::Single);
    EXPECT_ERROR_WITH(pattern("string", "spiral"), "integrator.capture_type: found \"spiral\"");

    const auto bounces = [](const std::string& key, int value) {
        return import_xml(
                   {{"@@integrator",
                     "<integer name=\"" + key + "\" value=\"" + std::to_string(value) + "\"/>"}})
            .description.render.max_bounces;
    };
    EXPECT_EQ(bounces("max_depth", 4), 3);
    EXPECT_EQ(bounces("filter_bounces", 3), 3);
    EXPECT_EQ(bounces("filter_depth", 6), 5);
    EXPECT_EQ(bounces("max_depth", -1), 5);  // unlimited
    EXPECT_EQ(import_xml({{"@@integrator",
                           R"(<integer name="max_depth" value="4"/>
                              <boolean name="nlos_laser_sampling" value="true"/>)"}})
                  .description.render.max_bounces,
              4);
}

TEST(MitsubaScene, ConfocalScansOfOnePixelHaveTheOriginalGrid) {
    const auto scene = import_xml({{"@@sensor",
                                    R"(<integer name="original_film_width" value="32"/>
                        <integer name="original_film_height" value="16"/>)"}});
    EXPECT_EQ(scene.description.scan.pattern, core::ScanPattern::Confocal);
    EXPECT_EQ(scene.description.scan.sensing_points, (std::array<int, 2>{32, 16}));
}

TEST(MitsubaScene, SegmentsToTheDevicesCountWhereTheSceneCountsThem) {
    const std::string flag = R"(<boolean name="account_first_and_last_bounces" value="true"/>)";
    for (const char* place : {"@@integrator", "@@sensor"}) {
        EXPECT_EQ(import_xml({{place, flag}}).description.scan.opl_origin, core::OplOrigin::Device);
    }
}

TEST(MitsubaScene, TheWallIsTheRectangleOfTheSensor) {
    const auto scene =
        import_xml({{"@@wall",
                     R"(<bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf>
             <transform name="to_world"><scale x="0.75" y="0.5"/><rotate y="1" angle="90"/>
                <translate x="1" y="2" z="3"/></transform>)"},
                    {"@@target", "1, 2, 3"}});
    const renderer::RelayWall& wall = scene.description.relay_wall;
    EXPECT_LT((wall.center_m - Vec3(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((wall.normal - Vec3(1, 0, 0)).norm(), 1e-12);
    EXPECT_LT((wall.up - Vec3(0, 1, 0)).norm(), 1e-12);
    EXPECT_NEAR(wall.size_m[0], 1.5, 1e-12);
    EXPECT_NEAR(wall.size_m[1], 1.0, 1e-12);
    EXPECT_NEAR(wall.albedo, 0.5, 1e-12);
    // The first column of points is where Mitsuba's first pixel is: x = -1 of the rectangle.
    EXPECT_LT((wall.world_from_wall() * Vec3(-0.75, 0, 0) - Vec3(1, 2, 3.75)).norm(), 1e-12);
}

TEST(MitsubaScene, MirroredWallsAreNamed) {
    const auto scene =
        import_xml({{"@@wall", R"(<transform name="to_world"><scale z="-1"/></transform>)"}});
    EXPECT_LT((scene.description.relay_wall.normal - Vec3(0, 0, -1)).norm(), 1e-12);
    EXPECT_TRUE(lists(scene, "columns of wall points run against"));
}

TEST(MitsubaScene, ALaserThatMissesTheWallIsNamed) {
    const auto scene = import_xml({{"@@target", "-0.5, 0, 1"}});
    EXPECT_TRUE(lists(scene, "laser: does not aim at the wall"));
    EXPECT_LT(scene.description.scan.illumination_m->norm(), 1e-12);
}

TEST(MitsubaScene, ShapesStandWhereTheirTransformsPutThem) {
    struct Case {
        std::string type;
        std::string shape;
        Vec3 low;
        Vec3 high;
    };
    const Case cases[]{
        {"rectangle", "", {-1, -1, 1}, {1, 1, 1}},
        {"cube", "", {-1, -1, 0}, {1, 1, 2}},
        {"disk", "", {-1, -1, 1}, {1, 1, 1}},
        {"sphere",
         R"(<point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/>)",
         {0.5, 1.5, 3.5},
         {1.5, 2.5, 4.5}},
        {"cylinder",
         R"(<point name="p0" x="0" y="0" z="0"/><point name="p1" x="0" y="3" z="0"/>
            <float name="radius" value="0.5"/>)",
         {-0.5, 0, 0.5},
         {0.5, 3, 1.5}},
        {"obj", R"(<string name="filename" value="shape.obj"/>)", {0, 0, 1}, {1, 1, 1}}};
    for (const Case& c : cases) {
        const auto scene = import_xml({{"@@type", c.type}, {"@@shape", c.shape}});
        ASSERT_EQ(scene.geometry.objects.size(), 1U) << c.type;
        Eigen::AlignedBox3d box;
        for (const Vec3& v : scene.geometry.objects[0].mesh.vertices) box.extend(v);
        EXPECT_LT((box.min() - c.low).norm(), 5e-3) << c.type;
        EXPECT_LT((box.max() - c.high).norm(), 5e-3) << c.type;
        EXPECT_EQ(scene.geometry.objects[0].name, "hidden");
    }
}

TEST(MitsubaScene, TransformsActInTheirOrder) {
    const auto scene =
        import_xml({{"@@type", "obj"},
                    {"@@place",
                     R"(<translate x="1"/><rotate z="1" angle="90"/><scale x="2" y="3" z="4"/>
             <matrix value="1 0 0 0.5  0 1 0 0  0 0 1 1  0 0 0 1"/>)"},
                    {"@@shape", R"(<string name="filename" value="shape.obj"/>)"}});
    // The corner at the origin: to (1, 0, 0), turned to (0, 1, 0), stretched to (0, 3, 0), moved.
    EXPECT_LT((scene.geometry.objects.at(0).mesh.vertices.at(0) - Vec3(0.5, 3, 1)).norm(), 1e-12);
}

TEST(MitsubaScene, DiffuseReflectancesAreMeansOfLinearColours) {
    EXPECT_NEAR(hidden_albedo(""), 0.5, 1e-12);  // Mitsuba's own, also within a bsdf
    EXPECT_NEAR(hidden_albedo(R"(<bsdf type="diffuse"/>)"), 0.5, 1e-12);
    const auto diffuse = [](const std::string& value) {
        return hidden_albedo("<bsdf type=\"twosided\"><bsdf type=\"diffuse\">" + value +
                             "</bsdf></bsdf>");
    };
    EXPECT_NEAR(diffuse(R"(<rgb name="reflectance" value="0.1, 0.2, 0.6"/>)"), 0.3, 1e-12);
    EXPECT_NEAR(diffuse(R"(<rgb name="reflectance" value="0.7"/>)"), 0.7, 1e-12);
    EXPECT_NEAR(diffuse(R"(<spectrum name="reflectance" value="0.4"/>)"), 0.4, 1e-12);
    EXPECT_NEAR(diffuse(R"(<spectrum name="reflectance" value="400:0.2, 700:0.4"/>)"), 0.3, 1e-12);
    EXPECT_NEAR(diffuse(R"(<float name="reflectance" value="0.9"/>)"), 0.9, 1e-12);
    EXPECT_NEAR(diffuse(R"(<rgb name="reflectance" value="#808080"/>)"), 0.21586, 1e-5);  // sRGB
    EXPECT_ERROR_WITH(diffuse(R"(<rgb name="reflectance" value="3"/>)"), "reflectance: found 3");
}

TEST(MitsubaScene, ReferencesNameMaterialsOfTheScene) {
    const std::string grey =
        R"(<bsdf type="diffuse" id="grey"><rgb name="reflectance" value="0.2"/></bsdf>)";
    const auto scene = import_xml({{"@@root", grey}, {"@@shape", R"(<ref id="grey"/>)"}});
    EXPECT_NEAR(scene.geometry.objects.at(0).material.albedo, 0.2, 1e-12);
    EXPECT_EQ(scene.geometry.objects.at(0).material.name, "grey");
    EXPECT_ERROR_WITH(import_xml({{"@@shape", R"(<ref id="gone"/>)"}}), "refers to 'gone'");
    EXPECT_TRUE(lists(import_xml({{"@@root", R"(<medium type="homogeneous" id="fog"/>)"},
                                  {"@@shape", R"(<ref name="interior" id="fog"/>)"}}),
                      "hidden.interior: is not translated"));
    EXPECT_ERROR_WITH(
        import_xml({{"@@root", R"(<bsdf type="twosided" id="loop"><ref id="loop"/></bsdf>)"},
                    {"@@shape", R"(<ref id="loop"/>)"}}),
        "nests BSDFs without end");
}

TEST(MitsubaScene, RoughConductorsKeepTheirWidthAndReflectance) {
    const auto scene =
        import_xml({{"@@shape",
                     R"(<bsdf type="roughconductor"><string name="material" value="none"/>
             <float name="alpha" value="0.25"/><string name="distribution" value="ggx"/>
             <rgb name="specular_reflectance" value="0.8"/></bsdf>)"}});
    const renderer::Material& material = scene.geometry.objects.at(0).material;
    EXPECT_EQ(material.model, renderer::model_of({.metallic = true}));
    EXPECT_NEAR(material.roughness, 0.5, 1e-12);  // alpha is its square
    EXPECT_NEAR(material.albedo, 0.8, 1e-12);
    // eta = 2, k = 1: (1 + 1) / (9 + 1).
    EXPECT_NEAR(hidden_albedo(R"(<bsdf type="conductor"><float name="eta" value="2"/>
                                 <float name="k" value="1"/></bsdf>)"),
                0.2,
                1e-12);
}

TEST(MitsubaScene, WhatIsNotTranslatedIsListed) {
    const auto scene = import_xml(
        {{"@@integrator", R"(<boolean name="nlos_hidden_geometry_sampling" value="true"/>)"},
         {"@@sensor",
          R"(<sampler type="independent"><integer name="sample_count" value="9"/></sampler>)"},
         {"@@film", R"(<integer name="crop_width" value="4"/>)"},
         {"@@root",
          R"(<shape type="hair" id="fur"/><medium type="homogeneous" id="fog"/>
             <shape type="rectangle" id="lamp"><emitter type="area"/></shape>)"},
         {"@@shape",
          R"(<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.1"/></bsdf>)"}});
    for (const char* part : {"integrator.nlos_hidden_geometry_sampling: is not translated",
                             "wall.sensor.sampler: is not translated",
                             "wall.sensor.film.crop_width: is not translated",
                             "fur: a shape of type hair is left out",
                             "fog: a plugin of type homogeneous is not translated",
                             "lamp.emitter: is not translated",
                             "hidden.bsdf: plastic is not modelled",
                             "laser: its power is not translated"}) {
        EXPECT_TRUE(lists(scene, part)) << part;
    }
    EXPECT_NEAR(scene.geometry.objects.at(1).material.albedo, 0.1, 1e-12);
}

TEST(MitsubaScene, TheDictionaryAsJsonIsTheSameScene) {
    const auto scene = import_text("scene.json", example_json());
    EXPECT_EQ(scene.description.scan.pattern, core::ScanPattern::Confocal);
    EXPECT_EQ(scene.description.scan.sensing_points, (std::array<int, 2>{4, 2}));
    EXPECT_EQ(scene.description.time_axis.opl_start_m, 2.0);
    EXPECT_EQ(scene.description.render.max_bounces, 3);
    EXPECT_EQ(scene.geometry.objects.at(0).name, "ball");
    EXPECT_NEAR(scene.geometry.objects[0].material.albedo, 0.3, 1e-12);
}

TEST(MitsubaScene, ScenesWithoutAScanAreRefused) {
    EXPECT_ERROR_WITH(import_text("scene.xml", "<scene version='3.0.0'/>"), "nlos_capture_meter");
    EXPECT_ERROR_WITH(import_xml({{"@@type", "hair"}}), "has no hidden objects");
    EXPECT_ERROR_WITH(import_xml({{"@@type", "obj"},
                                  {"@@shape", R"(<string name="filename" value="gone.obj"/>)"}}),
                      "gone.obj: cannot be opened");
    EXPECT_ERROR_WITH(
        import_xml({{"@@film", R"(<integer name="temporal_bins" value="2"/>)"},
                    {"@@wall", R"(<transform name="to_world"><scale x="0"/></transform>)"}}),
        "wall: is no rectangle");
    EXPECT_ERROR_WITH(import_text("scene.json", R"({"type": "bsdf"})"), "is no scene of Mitsuba");
}

TEST(MitsubaScene, TheDescriptionReadsBackAsItIs) {
    const auto scene =
        import_xml({{"@@integrator", R"(<string name="capture_type" value="Exhaustive"/>)"}});
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("scene.json"),
                                   renderer::imported_scene_json(scene, "scene.glb").dump());
    auto read = renderer::read_scene_description(folder.file("scene.json"), {});
    read.geometry.clear();
    EXPECT_EQ(core::write_value(read), core::write_value(scene.description));
}

}  // namespace
