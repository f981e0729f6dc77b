// SPDX-License-Identifier: MIT
// `nlos render` and what it makes of a scene: meshes, scenes of other programs, axes, images.
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::Outcome;
using test_support::write_file_bytes;

TEST_F(CommandLine, MeshFilesAreDescribedComparedAndRendered) {
    const std::string mesh = file("roof.obj");
    write_file_bytes(mesh,
                     "o roof\nv -200 -100 700\nv 200 -100 700\nv 200 100 700\nv -200 100 800\n"
                     "f 1 2 3 4\n");
    const Outcome info = run("info " + mesh);
    EXPECT_EQ(info.status, 0) << info.err;
    EXPECT_NE(info.out.find("format: OBJ\nunit: 1 m (assumed"), std::string::npos) << info.out;
    EXPECT_NE(info.out.find("size: 1 objects, 2 triangles, 400 x 200 x 100 m"), std::string::npos)
        << info.out;
    EXPECT_EQ(run("compare " + mesh + " " + mesh).status, 0);

    const core::Json description = {{"geometry", "roof.obj"},
                                    {"geometry_unit_m", 0.001},
                                    {"scan", {{"sensing_points", {4, 4}}}}};
    const std::string scene = make_scene("scene.json", description);
    const Outcome render = run("render " + scene + " -o " + file("roof.h5"));
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_EQ(render.err, "");
    const Outcome assumed = run("info " + make_scene("metres.json", {{"geometry", "roof.obj"}}));
    EXPECT_NE(assumed.out.find("geometry_unit_m gives another"), std::string::npos)
        << assumed.out << assumed.err;
    expect_bad_input("info " + file("gone.stl"), "does not exist");
}

TEST_F(CommandLine, ScenesOfMitsubaAndYtalAreTranslatedAndRender) {
    write_file_bytes(file("shape.obj"), "v 0 0 0\nv 0.3 0 0\nv 0 0.3 0\nf 1 2 3\n");
    write_file_bytes(file("theirs.yaml"),
                     "num_bins: 100\nbin_width_opl: 0.02\nstart_opl: 1\nsensor_width: 4\n"
                     "sensor_height: 3\nintegrator_max_depth: 3\ngeometry:\n- name: Z\n  mesh:\n"
                     "    type: obj\n    filename: shape.obj\n  displacement_z: 0.8\n  material:\n"
                     "    id: white\n- name: relay_wall\n  mesh:\n    type: rectangle\n");
    const Outcome convert = run("convert " + file("theirs.yaml") + " " + file("ours.json"));
    EXPECT_EQ(convert.status, 0) << convert.err;
    EXPECT_NE(convert.out.find("not the same: "), std::string::npos) << convert.out;
    EXPECT_NE(convert.out.find("wrote " + file("ours.json")), std::string::npos) << convert.out;
    const Outcome render = run("render " + file("ours.json") + " -o " + file("ours.h5"));
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_NE(render.out.find("12 pairs x 100 bins, single"), std::string::npos) << render.out;
    write_file_bytes(file("no.xml"), "<scene version='3.0.0'/>");
    expect_bad_input("convert " + file("no.xml") + " " + file("kept.json"),
                     "nlos_capture_meter",
                     file("kept.json"));
}

TEST_F(CommandLine, DarknessIsNamedFromRenderToFit) {
    const std::string scene = make_scene("scene.json", {{"scan", {{"sensing_points", {4, 4}}}}});
    const std::string dark = file("dark.h5");
    const Outcome render =
        run("render " + scene + " -o " + dark + " --set time_axis.opl_start_m=50");
    EXPECT_EQ(render.status, 0);
    EXPECT_NE(render.err.find("and no light: paths are 1."), std::string::npos) << render.err;
    EXPECT_NE(render.err.find("the capture holds no light"), std::string::npos) << render.err;
    EXPECT_EQ(render.out.find("error about"), std::string::npos) << render.out;
    EXPECT_NE(run("info " + dark).out.find("the capture holds no light"), std::string::npos);
    const Outcome reconstruct = run("reconstruct " + dark + " -o " + file("v.h5"));
    EXPECT_NE(reconstruct.err.find("the capture holds no light"), std::string::npos)
        << reconstruct.err;
    const Outcome compare = run("compare " + dark + " " + dark);
    EXPECT_NE(compare.err.find("the reference holds no light"), std::string::npos) << compare.err;
    write_file_bytes(file("model.json"),
                     R"({"scene": "scene.json", "free": {"letter": ["pose"]}})");
    expect_bad_input("fit " + dark + " " + file("model.json") + " -o " + file("f.json"),
                     "found no light");

    const Outcome frames = run("render " + scene + " -o " + file("frames.h5") +
                               " --set time_axis.num_bins=1 time_axis.bin_width_m=0.1 "
                               "time_axis.opl_start_m=0.9 frames.count=6 frames.gate_step_m=0.1");
    EXPECT_NE(frames.err.find("of 6 frames hold no light"), std::string::npos) << frames.err;
}

TEST_F(CommandLine, TimeAxesCanBeChosenByTheProgram) {
    const std::string scene =
        make_scene("scene.json", {{"scan", {{"sensing_points", {4, 4}}}}, {"time_axis", "auto"}});
    const Outcome render = run("render " + scene + " -o " + file("auto.h5"));
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_EQ(render.err, "");
    const core::Capture capture = nlos::read_capture(file("auto.h5"));
    EXPECT_GT((*capture.scene_info)["light"]["share_in_axis"].get<double>(), 0.999);
    EXPECT_EQ((*capture.scene_info)["settings"]["time_axis"]["num_bins"],
              capture.time_axis.num_bins);
    EXPECT_NE(run("info " + scene).out.find("(auto)"), std::string::npos);
    EXPECT_EQ(run("render scenes/letter/scene.json -o " + file("set.h5") +
                  " --samples 4 --set time_axis=auto scan.sensing_points=[4,4]")
                  .status,
              0);
    expect_bad_input("render " + scene + " -o " + file("x.h5") + " --set time_axis=automatic",
                     "must be auto, or an object");
}

TEST_F(CommandLine, EqualSeedsGiveEqualFilesWhateverTheThreads) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    std::vector<core::Capture> captures;
    for (const std::string arguments : {"--threads 1",
                                        "--threads 2",
                                        "--threads 2 --method path --seed 1",
                                        "--threads 1 --method path --seed 1",
                                        "--method path --seed 2"}) {
        const Outcome outcome = run("render " + scene + " -o " + file("c.h5") + " " + arguments);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        captures.push_back(nlos::read_capture(file("c.h5")));
    }
    const auto values = [&](std::size_t i) { return captures[i].transient.values(); };
    const auto are_equal = [&](std::size_t a, std::size_t b) {
        return std::equal(values(a).begin(), values(a).end(), values(b).begin());
    };
    EXPECT_TRUE(are_equal(0, 1));
    EXPECT_TRUE(are_equal(2, 3));
    EXPECT_FALSE(are_equal(2, 4));
}

TEST_F(CommandLine, ImagesOfACamera) {
    const std::string out = file("image.h5");
    const std::string small = " --samples 8 --set camera.resolution=[16,12]";
    const Outcome render = run("render scenes/box/scene.json -o " + out + small);
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_NE(render.out.find("192 pairs x 256 bins, camera by path"), std::string::npos)
        << render.out;
    EXPECT_EQ(file_bytes(file("image.png")).substr(1, 3), "PNG");
    EXPECT_NE(run("info " + out).out.find("camera: 16 x 12 pixels"), std::string::npos);
    EXPECT_EQ(run("compare " + out + " " + out).status, 0);
    ASSERT_EQ(run("render scenes/box/scene.json -o " + file("same.exr") + small).status, 0);
    EXPECT_NE(
        run("compare " + file("same.exr") + " " + out).out.find("rel_l2                   0 "),
        std::string::npos);
    expect_bad_input("render scenes/box/scene.json -o " + file("image.tiff") + small, "image.tiff");
    expect_bad_input("reconstruct " + out + " -o " + file("v.h5"), "image of a camera");
    expect_bad_input("compare " + out + " scenes/box/scene.json", "cannot be compared");
    expect_bad_input("info scenes/box/scene.json --picture " + file("p.png"), "relay wall");
    expect_bad_input(
        "render scenes/box/scene.json -o " + out + " --set camera.up=[0,0,1]", "camera.up", out);
    expect_bad_input("render scenes/letter/scene.json -o " + out + " --set camera.fov_y_deg=30",
                     "found together with relay_wall",
                     out);
    expect_bad_input(
        "render scenes/box/scene.json -o " + out + " --method third_bounce --max-bounces 3",
        "found third_bounce for a camera",
        out);
    expect_bad_input("render scenes/box/scene.json -o " + out +
                         " --set camera.light_m=null camera.light_spot_m=[0,0,0]",
                     "camera.light_spot_m",
                     out);
}

TEST_F(CommandLine, SequencesBecomeFilmStripsInTheReport) {
    fs::create_directories(file("box"));
    const Outcome render = run("render scenes/box/gated.json -o " + file("box/gated.h5") +
                               " --samples 4 --set camera.resolution=[16,12]");
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_NE(render.out.find("24 frames x 192 pairs x 1 bins"), std::string::npos) << render.out;
    const core::Capture capture = nlos::read_capture(file("box/gated.h5"));
    ASSERT_TRUE(capture.sequence.has_value());
    EXPECT_EQ(capture.sequence->frames.size(), 24U);
    EXPECT_NEAR(capture.time_axis.opl_start_m, 1.5 + 23 * 0.1, 1e-9);
    ASSERT_EQ(run("report " + file("box") + " -o " + file("box.html")).status, 0);
    const std::string page = file_bytes(file("box.html"));
    EXPECT_NE(page.find("16 x 12 pixels"), std::string::npos);
    EXPECT_NE(page.find("24, the path length moves by 100 mm"), std::string::npos);
}

}  // namespace
