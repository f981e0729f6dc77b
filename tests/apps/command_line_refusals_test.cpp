// SPDX-License-Identifier: MIT
// Wrong usage, scenes and files: exit code 2, one line that says what is wrong, older results kept.
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::write_file_bytes;

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

TEST_F(CommandLine, BadGeometryIsOneLineAndKeepsOlderResults) {
    const std::string out = file("capture.h5");
    const std::string scene = make_scene("scene.json", core::Json::object());
    const std::string glb = file_bytes(file("scene.glb"));
    for (const double fraction : {0.0, 0.01, 0.3, 0.7, 0.99}) {
        write_file_bytes(file("scene.glb"),
                         glb.substr(0, std::size_t(fraction * double(glb.size()))));
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
    for (const double fraction : {0.0, 0.001, 0.2, 0.6, 0.999}) {
        write_file_bytes(file("cut.h5"),
                         bytes.substr(0, std::size_t(fraction * double(bytes.size()))));
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

    // Bytes changed behind the writer's back: the checksum tells, whatever they are now.
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
    expect_bad_input("reconstruct " + file("nan.h5") + " -o " + out, "H: is damaged", out);
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

TEST_F(CommandLine, BenchWithoutItsProgramSaysSo) {
    fs::copy_file(NLOS_PROGRAM, file("nlos"));
    const std::string command =
        "'" + file("nlos") + "' bench render -o out 2>'" + file("err.txt") + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
    EXPECT_EQ(file_bytes(file("err.txt")),
              file("nlos-bench") + ": is missing; it is built and installed together with nlos\n");
}

}  // namespace
