// SPDX-License-Identifier: MIT
// The program as its users call it: outputs, exit codes, and one line for whatever is wrong.
#include "tests/support/command_line.h"

#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/settings.h"
#include "renderer/gltf/gltf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::Outcome;
using test_support::write_file_bytes;

TEST_F(CommandLine, SceneToScoredReconstruction) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    const Outcome render = run("render " + scene + " -o " + file("capture.h5") + " --threads 2");
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_EQ(render.err, "");
    EXPECT_NE(render.out.find("wrote " + file("capture.h5")), std::string::npos);

    for (const std::string method : {"lct", "bp"}) {
        const std::string volume = file(method + ".h5");
        const Outcome reconstruct =
            run("reconstruct " + file("capture.h5") + " -o " + volume + " --method " + method +
                " --ply " + file(method + ".ply") + " --set volume.z_range_m=[0.5,0.9]");
        EXPECT_EQ(reconstruct.status, 0) << reconstruct.err;
        EXPECT_TRUE(fs::exists(file(method + ".png")));
        EXPECT_TRUE(fs::exists(file(method + ".ply")));
        const Outcome compare =
            run("compare " + volume + " " + scene + " -o " + file("metrics.json"));
        EXPECT_EQ(compare.status, 0) << compare.err;
        const core::Json metrics = core::read_json_file(file("metrics.json"));
        EXPECT_LT(metrics["depth_mae_m"].get<double>(), 0.01) << method;
        EXPECT_GT(metrics["mask_iou_best"].get<double>(), 0.5) << method;
        EXPECT_TRUE(metrics.contains("rotation_error_deg"));
        EXPECT_TRUE(metrics["rotation_error_deg"].is_null());
        const Outcome cloud = run("compare " + file(method + ".ply") + " " + scene);
        EXPECT_EQ(cloud.status, 0) << cloud.err;
        EXPECT_NE(cloud.out.find("chamfer_m"), std::string::npos);
    }
}

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

    const core::Json stated = {{"geometry", "roof.obj"},
                               {"geometry_unit_m", 0.001},
                               {"scan", {{"sensing_points", {4, 4}}}}};
    const std::string scene = make_scene("scene.json", stated);
    const Outcome render = run("render " + scene + " -o " + file("roof.h5"));
    EXPECT_EQ(render.status, 0) << render.err;
    EXPECT_EQ(render.err, "");
    const Outcome assumed = run("info " + make_scene("metres.json", {{"geometry", "roof.obj"}}));
    EXPECT_NE(assumed.out.find("geometry_unit_m states another"), std::string::npos)
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
    EXPECT_GT(capture.scene_info["light"]["share_in_axis"].get<double>(), 0.999);
    EXPECT_EQ(capture.scene_info["settings"]["time_axis"]["num_bins"], capture.time_axis.num_bins);
    EXPECT_NE(run("info " + scene).out.find("(auto)"), std::string::npos);
    EXPECT_EQ(run("render scenes/letter/scene.json -o " + file("set.h5") +
                  " --samples 4 --set time_axis=auto scan.sensing_points=[4,4]")
                  .status,
              0);
    expect_bad_input("render " + scene + " -o " + file("x.h5") + " --set time_axis=automatic",
                     "must be auto, or an object");
}

TEST_F(CommandLine, InfoOfASceneSaysFirstWhatItIs) {
    const Outcome info = run("info scenes/letter/scene.json");
    EXPECT_EQ(info.status, 0);
    EXPECT_LT(std::count(info.out.begin(), info.out.end(), '\n'), 30) << info.out;
    for (const char* part : {"object letter: ", "lambertian", "scan: confocal", "light: from 1."}) {
        EXPECT_NE(info.out.find(part), std::string::npos) << part << "\n" << info.out;
    }
}

TEST_F(CommandLine, ResponsesOfCapturesAreOffered) {
    const std::string counts = file("counts.h5");
    ASSERT_EQ(
        run("simulate-noise data/letter.h5 -o " + counts + " --photons 1e6 --jitter-fwhm-ps 100")
            .status,
        0);
    // auto takes what the file states; a method that is asked for does when it is told so.
    ASSERT_EQ(run("reconstruct " + counts + " -o " + file("v.h5")).status, 0);
    EXPECT_EQ(nlos::read_volume(file("v.h5")).settings.response.jitter_fwhm_ps, 100.0);
    const std::string reconstruct = "reconstruct " + counts + " --method lct -o " + file("v.h5");
    const Outcome ignored = run(reconstruct);
    EXPECT_NE(ignored.err.find("response=capture"), std::string::npos) << ignored.err;
    const Outcome used = run(reconstruct + " --set response=capture");
    EXPECT_EQ(used.status, 0) << used.err;
    EXPECT_EQ(used.err.find("response"), std::string::npos) << used.err;
    EXPECT_EQ(nlos::read_volume(file("v.h5")).settings.response.jitter_fwhm_ps, 100.0);
    EXPECT_NE(run("info " + counts).out.find("response of 100 ps"), std::string::npos);
    expect_bad_input("reconstruct data/letter.h5 -o " + file("w.h5") + " --set response=capture",
                     "states no response");
}

TEST_F(CommandLine, CalibrationsServeRenderReconstructAndFit) {
    const std::string scene = make_scene("scene.json", {{"scan", {{"sensing_points", {8, 8}}}}});
    ASSERT_EQ(run("render " + scene + " -o " + file("plain.h5")).status, 0);
    const core::Scan scan = nlos::read_capture(file("plain.h5")).scan;
    core::Json calibration = {{"response", {{"jitter_fwhm_ps", 60.0}}}};
    for (std::size_t i = 0; i < scan.num_pairs(); ++i) {
        const core::Vec3& p = scan.sensing.positions[i];
        calibration["points_m"].push_back({p.x(), p.y(), p.z()});
        calibration["normals"].push_back({0.0, 0.0, 1.0});
        calibration["opl_offset_m"].push_back(1.0 + 0.003 * static_cast<double>(i));
    }
    write_file_bytes(file("calibration.json"), calibration.dump());
    const std::string option = " --calibration " + file("calibration.json");
    const std::string capture = file("capture.h5");
    const Outcome render = run("render " + scene + " -o " + capture + option);
    EXPECT_EQ(render.status, 0) << render.err;

    // Only with the calibration is the letter where it is.
    const std::string reconstruct = "reconstruct " + capture + " -o " + file("volume.h5") +
                                    " --method bp --set volume.z_range_m=[0.5,0.9]";
    EXPECT_EQ(run(reconstruct + option).status, 0);
    EXPECT_EQ(run("compare " + file("volume.h5") + " " + scene + " -o " + file("m.json")).status,
              0);
    EXPECT_LT(core::read_json_file(file("m.json"))["depth_mae_m"].get<double>(), 0.02);

    const core::Json model = {{"scene", "scene.json"}, {"free", {{"letter", {"pose", "albedo"}}}}};
    write_file_bytes(file("model.json"), model.dump());
    const std::string fit = "fit " + capture + " " + file("model.json") + " -o " + file("fit.json");
    const Outcome fitted = run(fit + option);
    EXPECT_EQ(fitted.status, 0) << fitted.err;
    EXPECT_EQ(run("compare " + file("fit.json") + " " + scene + " -o " + file("f.json")).status, 0);
    const core::Json scores = core::read_json_file(file("f.json"));
    EXPECT_LT(scores["position_error_m"].get<double>(), 0.003) << scores.dump(1);
    const Outcome misled = run(fit);
    EXPECT_NE(misled.err.find("does not explain the data"), std::string::npos) << misled.err;

    calibration.erase("response");
    write_file_bytes(file("calibration.json"), calibration.dump());
    for (const std::string& command : {"render " + scene + " -o " + capture, reconstruct, fit}) {
        expect_bad_input(command + option, "has no response");
    }
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

TEST_F(CommandLine, CaptureRemembersHowItWasMade) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    ASSERT_EQ(run("render " + scene + " -o " + file("c.h5") + " --seed 7").status, 0);
    const core::Json info = nlos::read_capture(file("c.h5")).scene_info;
    EXPECT_EQ(info["settings"]["render"]["seed"], 7);
    EXPECT_NE(info["command"].get<std::string>().find("--seed 7"), std::string::npos);
    EXPECT_NE(info["program"].get<std::string>().find("nlos 0."), std::string::npos);
}

TEST_F(CommandLine, HelpOnEveryLevelEndsWithAnExampleThatWorks) {
    EXPECT_TRUE(run("--help").out.ends_with("Example:\n  nlos demo -o out/demo\n"));
    EXPECT_NE(run("--version").out.find("nlos 0."), std::string::npos);
    for (const std::string name : {"scenes", "data"}) {
        fs::create_directory_symlink(NLOS_SOURCE_DIR "/" + name, file(name));
    }
    for (const std::string name : {"render",
                                   "simulate-noise",
                                   "reconstruct",
                                   "fit",
                                   "calibrate",
                                   "compare",
                                   "convert",
                                   "info",
                                   "bench",
                                   "report",
                                   "sweep"}) {
        const Outcome help = run(name + " --help");
        EXPECT_EQ(help.status, 0) << name;
        const std::string start = "Example:\n  nlos ";
        const std::size_t at = help.out.rfind(start + name);
        ASSERT_NE(at, std::string::npos) << help.out;
        const std::string example = help.out.substr(at + start.size());
        EXPECT_EQ(example.find('\n') + 1, example.size()) << example;
#ifndef __SANITIZE_ADDRESS__  // six minutes of what other tests here call too
        const Outcome outcome = run(example.substr(0, example.size() - 1), folder_.path().string());
        EXPECT_EQ(outcome.status, 0) << example << outcome.err;
#endif
    }
    EXPECT_NE(run("demo --help").out.find("Example:\n  nlos demo"), std::string::npos);
    EXPECT_NE(run("render --help").out.find("time_axis.bin_width_m = 0.008"), std::string::npos);
}

TEST_F(CommandLine, TargetsAreLookedAtBeforeTheWork) {
    const std::string letter = "data/letter.h5";
    const std::string copy = file("copy.h5");
    fs::copy_file(NLOS_SOURCE_DIR "/" + letter, copy);
    const std::string bytes = file_bytes(copy);
    for (const std::string& command : {"simulate-noise " + copy + " --photons 9 -o ",
                                       "reconstruct " + copy + " -o ",
                                       "convert " + copy + " ",
                                       "reconstruct " + copy + " -o " + file("v.h5") + " --ply "}) {
        expect_bad_input(command + (command.ends_with("ply ") ? letter : copy), "must be");
    }
    EXPECT_EQ(file_bytes(copy), bytes);
    expect_bad_input("reconstruct " + letter + " -o " + file("v.txt"), "must be one of .h5, .hdf5");
    expect_bad_input("reconstruct " + letter + " -o /proc/v.h5", "writable folder");
    expect_bad_input("compare " + copy + " " + letter + " -o " + file("m.txt"), ".json");
    expect_bad_input("info " + letter + " --picture " + file("p.jpg"), ".png");
    expect_bad_input("bench unknown", "known are render");
    expect_bad_input("render scenes -o " + file("x.h5"), "is a folder");
    expect_bad_input("compare " + copy + " " + letter + " --fscore-threshold-m nan", "positive");
    expect_bad_input("render scenes/curved/scene.json -o " + file("x.h5") +
                         " --set scan.sensing_points_m=[] scan.sensing_normals=[]",
                     "does not lie on the mesh with the role relay_wall");
}

TEST_F(CommandLine, InfoSaysWhereResultsComeFrom) {
    EXPECT_NE(run("info data/letter.h5").out.find("  command: nlos render scenes/letter"),
              std::string::npos);
    ASSERT_EQ(run("reconstruct data/letter.h5 -o " + file("v.h5")).status, 0);
    EXPECT_NE(run("info " + file("v.h5")).out.find("  capture: data/letter.h5"), std::string::npos);
    EXPECT_NE(run("info data/setup.json").out.find("commands: 64 items"), std::string::npos);
    EXPECT_NE(run("info scenes/letter/model.json").out.find("start: search"), std::string::npos);
    ASSERT_EQ(run("calibrate data/setup.json -o " + file("c.json")).status, 0);
    EXPECT_NE(run("info " + file("c.json")).out.find("format: calibration"), std::string::npos);
    EXPECT_TRUE(core::read_json_file(file("c.json")).at("camera").is_null());
}

TEST_F(CommandLine, FitsAreComparedWithOneAnother) {
    const std::string model = make_scene("scene.json", core::Json::object());
    write_file_bytes(file("model.json"),
                     R"({"scene": "scene.json", "free": {"letter": ["pose", "albedo"]}})");
    const std::string fit = "fit data/letter.h5 " + file("model.json") + " -o ";
    ASSERT_EQ(run(fit + file("a.json")).status, 0);
    const Outcome stopped =
        run(fit + file("b.json") + " --set max_iterations=1 response.jitter_fwhm_ps=300");
    EXPECT_EQ(stopped.status, 1);
    EXPECT_EQ(std::count(stopped.err.begin(), stopped.err.end(), '\n'), 1) << stopped.err;
    EXPECT_FALSE(core::read_json_file(file("b.json"))["converged"]);
    EXPECT_NE(stopped.out.find("wrote " + file("b.json")), std::string::npos);
    ASSERT_EQ(
        run("compare " + file("a.json") + " " + file("b.json") + " -o " + file("m.json")).status,
        0);
    EXPECT_LT(core::read_json_file(file("m.json"))["position_error_m"], 0.1);
    expect_bad_input(fit + file("scene.json"), "is read as well");
    expect_bad_input(fit + file("c.json") + " --set start=nothing", "VOLUME.h5");
}

TEST_F(CommandLine, BadUsageIsOneLine) {
    expect_bad_input("", "nlos");
    expect_bad_input("unknown", "unknown");
    expect_bad_input("render scenes/letter/scene.json", "output");
    expect_bad_input("reconstruct some.h5", "output");
    expect_bad_input("render scenes/letter/scene.json -o x.h5 --samples", "samples");
    expect_bad_input("render scenes/letter/scene.json -o " + file("x.h5") + " --threads -1", "");
    expect_bad_input("render scenes/letter/scene.json -o " + file("none/x.h5"), "folder");
}

TEST_F(CommandLine, BadScenesAreOneLineAndKeepOlderResults) {
    const std::string out = file("capture.h5");
    const auto expect_bad_scene = [&](const core::Json& changes, const std::string& part) {
        expect_bad_input("render " + make_scene("bad.json", changes) + " -o " + out, part, out);
    };
    expect_bad_input("render " + file("missing.json") + " -o " + out, "missing.json", out);
    expect_bad_scene({{"scann", 1}}, "known keys are geometry");
    expect_bad_scene({{"geometry", "missing.glb"}}, "missing.glb");
    expect_bad_scene({{"time_axis", {{"num_bins", 0}}}}, "num_bins");
    expect_bad_scene({{"time_axis", {{"bin_width_m", -1}}}}, "bin_width_m");
    expect_bad_scene({{"time_axis", {{"bin_width_m", "wide"}}}}, "bin_width_m");
    expect_bad_scene({{"relay_wall", {{"normal", {0, 0, 0}}}}}, "normal");
    expect_bad_scene({{"relay_wall", {{"up", {0, 0, 1}}}}}, "up");
    expect_bad_scene({{"relay_wall", {{"normal", {0, 0, -1}}}}}, "in front of");
    expect_bad_scene({{"relay_wall", {{"center_m", {0, 0, 2}}}}}, "in front of");
    expect_bad_scene({{"scan", {{"sensing_points", {0, 4}}}}}, "sensing_points");
    expect_bad_scene({{"scan", {{"sensing_points", {1000000, 1000000}}}}}, "sensing_points");
    expect_bad_scene({{"scan", {{"opl_origin", "device"}}}}, "laser_m");
    expect_bad_scene({{"scan", {{"sensing_points_m", {{0, 0, 0}}}}}}, "normals");
    expect_bad_scene({{"render", {{"samples", 0}}}}, "samples");
    expect_bad_scene({{"render", {{"method", "magic"}}}}, "auto");
    write_file_bytes(file("cut.json"), R"({"geometry": "scene.glb", )");
    expect_bad_input("render " + file("cut.json") + " -o " + out, "JSON", out);
    expect_bad_input("render scenes/letter/scene.json -o " + out + " --set time_axis.num_bin=3",
                     "known keys are",
                     out);
    expect_bad_input(
        "render scenes/letter/scene.json -o " + out + " --set time_axis", "--set", out);
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

TEST_F(CommandLine, BadGeometryIsOneLineAndKeepsOlderResults) {
    const std::string out = file("capture.h5");
    const std::string scene = make_scene("scene.json", core::Json::object());
    const std::string glb = file_bytes(file("scene.glb"));
    for (const double share : {0.0, 0.01, 0.3, 0.7, 0.99}) {
        write_file_bytes(file("scene.glb"), glb.substr(0, std::size_t(share * double(glb.size()))));
        expect_bad_input("render " + scene + " -o " + out, "scene.glb", out);
    }
    write_file_bytes(file("scene.gltf"), R"({"asset": {"version": "2.0"}})");
    expect_bad_input(
        "render " + make_scene("empty.json", {{"geometry", "scene.gltf"}}) + " -o " + out,
        "scene.gltf",
        out);
}

TEST_F(CommandLine, BadCapturesAreOneLineAndKeepOlderResults) {
    const std::string out = file("volume.h5");
    const std::string scene = make_scene("scene.json", core::Json::object());
    ASSERT_EQ(run("render " + scene + " -o " + file("capture.h5")).status, 0);
    const std::string bytes = file_bytes(file("capture.h5"));
    for (const double share : {0.0, 0.001, 0.2, 0.6, 0.999}) {
        write_file_bytes(file("cut.h5"),
                         bytes.substr(0, std::size_t(share * double(bytes.size()))));
        expect_bad_input("reconstruct " + file("cut.h5") + " -o " + out, "cut.h5", out);
        expect_bad_input("info " + file("cut.h5"), "cut.h5");
    }
    expect_bad_input("reconstruct " + file("none.h5") + " -o " + out, "none.h5", out);
    expect_bad_input(
        "reconstruct " + file("capture.h5") + " -o " + out + " --method fish", "", out);
    expect_bad_input(
        "reconstruct " + file("capture.h5") + " -o " + out + " --set snr=-1", "snr", out);
    for (const std::string option : {"ply", "glb"}) {
        expect_bad_input("reconstruct " + file("capture.h5") + " -o " + out + " --" + option + " " +
                             file("none/points." + option),
                         "folder does not exist",
                         out);
    }

    // NaN written behind the writer's back: the first four bytes of the brightest value.
    const core::Capture capture = nlos::read_capture(file("capture.h5"));
    const auto values = capture.transient.values();
    const float peak = *std::max_element(values.begin(), values.end());
    const std::string pattern(reinterpret_cast<const char*>(&peak), sizeof(peak));
    const std::size_t at = bytes.find(pattern);
    ASSERT_NE(at, std::string::npos);
    const float nan = std::nanf("");
    std::string poisoned = bytes;
    poisoned.replace(at, sizeof(nan), reinterpret_cast<const char*>(&nan), sizeof(nan));
    write_file_bytes(file("nan.h5"), poisoned);
    expect_bad_input("reconstruct " + file("nan.h5") + " -o " + out, "finite", out);
}

TEST_F(CommandLine, NoisyCapturesAreCountsOfTheirSeed) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    ASSERT_EQ(run("render " + scene + " -o " + file("c.h5")).status, 0);
    const std::string noise = "simulate-noise " + file("c.h5") + " -o ";
    const std::string settings = " --photons 5000 --jitter-fwhm-ps 60 --ambient 0.01 --seed 3";
    const Outcome outcome = run(noise + file("a.h5") + settings + " --threads 1");
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("wrote " + file("a.h5")), std::string::npos);
    ASSERT_EQ(run(noise + file("b.h5") + settings + " --threads 2").status, 0);
    const core::Capture a = nlos::read_capture(file("a.h5"));
    const core::Capture b = nlos::read_capture(file("b.h5"));
    EXPECT_TRUE(std::ranges::equal(a.transient.values(), b.transient.values()));
    EXPECT_EQ(a.unit, core::TransientUnit::Counts);
    EXPECT_GT(a.counts_per_radiance.value(), 0.0);
    EXPECT_EQ(a.scene_info["detector"]["photons"], 5000.0);
    double sum = 0.0;
    for (const float count : a.transient.values()) sum += count;
    const double wanted = 5000.0 + 0.01 * static_cast<double>(a.transient.values().size());
    EXPECT_NEAR(sum, wanted, 6.0 * std::sqrt(wanted));
    const Outcome lossy = run(noise + file("a.mat") + settings);
    EXPECT_EQ(lossy.status, 0) << lossy.err;
    EXPECT_NE(lossy.out.find("not kept: "), std::string::npos) << lossy.out;
    expect_bad_input(noise + file("d.h5"), "photons", file("d.h5"));
    expect_bad_input(noise + file("d.h5") + " --photons -1", "photons", file("d.h5"));
}

TEST_F(CommandLine, ConversionsComeBackTheSame) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    ASSERT_EQ(run("render " + scene + " -o " + file("a.h5")).status, 0);
    ASSERT_EQ(run("convert " + file("a.h5") + " " + file("b.exr")).status, 0);
    ASSERT_EQ(run("convert " + file("b.exr") + " " + file("c.hdf5")).status, 0);
    const core::Capture a = nlos::read_capture(file("a.h5"));
    const core::Capture c = nlos::read_capture(file("c.hdf5"));
    EXPECT_TRUE(std::ranges::equal(a.transient.values(), c.transient.values()));
    EXPECT_EQ(a.scene_info, c.scene_info);
    const Outcome mat = run("convert " + file("a.h5") + " " + file("d.mat"));
    ASSERT_EQ(mat.status, 0) << mat.err;
    EXPECT_NE(mat.out.find("not kept:"), std::string::npos);
    ASSERT_EQ(run("convert " + file("a.h5") + " " + file("e.exr") + " --steady").status, 0);
    EXPECT_EQ(nlos::read_capture(file("e.exr")).time_axis.num_bins, 1);
    expect_bad_input("convert " + file("a.h5") + " " + file("f.tiff"), ".exr", file("f.tiff"));
    expect_bad_input(
        "convert " + file("a.h5") + " " + file("g.h5") + " --gate-m 9 1", "gate", file("g.h5"));
}

TEST_F(CommandLine, FilesThatDoNotFitTogetherAreRefused) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    ASSERT_EQ(run("render scenes/curved/scene.json -o " + file("curved.h5")).status, 0);
    expect_bad_input("compare " + file("curved.h5") + " " + scene, "cannot be compared");
    expect_bad_input("reconstruct " + file("curved.h5") + " -o " + file("v.h5") + " --method lct",
                     "phasor",
                     file("v.h5"));
    expect_bad_input("report " + file("nowhere") + " -o " + file("r.html"), "nowhere");
}

TEST_F(CommandLine, DemoMakesASelfContainedReport) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "takes many minutes; other tests here call each of its commands";
#endif
    const Outcome outcome = run("demo -o " + file("demo"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string page = file_bytes(file("demo/report.html"));
    EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos);
    EXPECT_NE(outcome.out.find("wrote " + file("demo/report.html")), std::string::npos);
}

}  // namespace
