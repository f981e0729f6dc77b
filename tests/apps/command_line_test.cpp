// SPDX-License-Identifier: MIT
// The program as its users call it: from scenes to scores, help, and what files tell of themselves.
#include "tests/support/command_line.h"

#include "apps/commands.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/settings/json_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
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
    // Every method takes what the file gives, unless it is told otherwise.
    for (const std::string method : {"auto", "lct", "bp"}) {
        const Outcome used =
            run("reconstruct " + counts + " --method " + method + " -o " + file("v.h5"));
        EXPECT_EQ(used.status, 0) << used.err;
        EXPECT_EQ(used.err.find("response"), std::string::npos) << used.err;
        EXPECT_EQ(nlos::read_volume(file("v.h5")).settings.response.jitter_fwhm_ps, 100.0);
    }
    const Outcome ignored =
        run("reconstruct " + counts + " --method lct --set response=none -o " + file("v.h5"));
    EXPECT_EQ(ignored.err.find("response"), std::string::npos) << ignored.err;
    EXPECT_TRUE(nlos::read_volume(file("v.h5")).settings.response.is_none);
    EXPECT_NE(run("info " + counts).out.find("response of 100 ps"), std::string::npos);
    expect_bad_input("reconstruct data/letter.h5 -o " + file("w.h5") + " --set response=capture",
                     "gives no response");
}

TEST_F(CommandLine, CalibrationsServeRenderReconstructAndFit) {
    const std::string scene = make_scene("scene.json", {{"scan", {{"sensing_points", {8, 8}}}}});
    ASSERT_EQ(run("render " + scene + " -o " + file("plain.h5")).status, 0);
    const core::WallScan scan = nlos::read_capture(file("plain.h5")).scan.wall();
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

TEST_F(CommandLine, CaptureRemembersHowItWasMade) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    ASSERT_EQ(run("render " + scene + " -o " + file("c.h5") + " --seed 7").status, 0);
    const core::Json info = *nlos::read_capture(file("c.h5")).scene_info;
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
    for (const apps::CommandRow* row : apps::all_commands()) {
        const std::string name = row->name;
        const Outcome help = run(name + " --help");
        EXPECT_EQ(help.status, 0) << name;
        EXPECT_TRUE(help.out.starts_with(row->summary)) << help.out;
        EXPECT_TRUE(help.out.ends_with("Example:\n  " + std::string(row->example) + "\n"))
            << help.out;
#ifndef __SANITIZE_ADDRESS__  // six minutes of what other tests here call too
        if (name == "bench" || name == "demo") continue;  // which tests of their own run
        const std::string example = std::string(row->example).substr(std::string("nlos ").size());
        const Outcome outcome = run(example, folder_.path().string());
        EXPECT_EQ(outcome.status, 0) << example << outcome.err;
#endif
    }
    EXPECT_NE(run("render --help").out.find("time_axis.bin_width_m = 0.008"), std::string::npos);
}

// A mesh anywhere, in any unit, renders by the scene that is proposed for it, its light on the
// axis.
TEST_F(CommandLine, AMeshGetsASceneThatRenders) {
    write_file_bytes(file("plate.obj"),
                     "v 100 200 300\nv 140 200 300\nv 140 230 310\nv 100 230 310\n"
                     "f 1 4 3 2\n");
    expect_bad_input("render " + file("plate.obj") + " -o " + file("c.h5"), "nlos scene ");
    const std::string scene = file("scene.json");
    const Outcome proposed =
        run("scene " + file("plate.obj") + " -o " + scene + " --unit-m 0.01 --json");
    ASSERT_EQ(proposed.status, 0) << proposed.err;
    const core::Json json = core::read_json_file(scene);
    EXPECT_EQ(json["geometry"], "plate.obj");
    EXPECT_NEAR(json["relay_wall"]["center_m"][2].get<double>(), 2.6, 1e-9);
    EXPECT_NEAR(json["relay_wall"]["size_m"][0].get<double>(), 0.8, 1e-9);
    ASSERT_EQ(
        run("render " + scene + " -o " + file("c.h5") + " --set scan.sensing_points=[4,4]").status,
        0);
    const core::Capture capture = nlos::read_capture(file("c.h5"));
    EXPECT_GT(*std::ranges::max_element(capture.transient.values()), 0.0F);
    // From a folder inside the scene's own.
    ASSERT_TRUE(fs::create_directory(file("meshes")));
    fs::copy_file(file("plate.obj"), file("meshes/plate.obj"));
    ASSERT_EQ(run("scene plate.obj -o ../above.json --unit-m 0.01", file("meshes")).status, 0);
    EXPECT_EQ(core::read_json_file(file("above.json"))["geometry"], "meshes/plate.obj");
    expect_bad_input("scene none.obj -o " + scene, "none.obj");
    expect_bad_input("scene " + file("plate.obj") + " -o " + file("s.h5"), ".json");
}

TEST_F(CommandLine, HelpIsACommandToo) {
    EXPECT_EQ(run("help").out, run("--help").out);
    EXPECT_EQ(run("help render").out, run("render --help").out);
    EXPECT_EQ(run("help bench render").out, run("bench render --help").out);
    EXPECT_EQ(run("help reder").status, 2);
    EXPECT_NE(run("help reder").err.find("did you mean"), std::string::npos);
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
    EXPECT_EQ((*a.scene_info)["detector"]["photons"], 5000.0);
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
    EXPECT_EQ(*a.scene_info, *c.scene_info);
    const Outcome mat = run("convert " + file("a.h5") + " " + file("d.mat"));
    ASSERT_EQ(mat.status, 0) << mat.err;
    EXPECT_NE(mat.out.find("not kept:"), std::string::npos);
    ASSERT_EQ(run("convert " + file("a.h5") + " " + file("e.exr") + " --steady").status, 0);
    EXPECT_EQ(nlos::read_capture(file("e.exr")).time_axis.num_bins, 1);
    expect_bad_input("convert " + file("a.h5") + " " + file("f.tiff"), ".exr", file("f.tiff"));
    expect_bad_input(
        "convert " + file("a.h5") + " " + file("g.h5") + " --gate-m 9 1", "gate", file("g.h5"));
}

}  // namespace
