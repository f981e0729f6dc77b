// SPDX-License-Identifier: MIT
// What is printed beside results: --quiet, --json, progress, and the nearest of known names.
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::Outcome;
using test_support::write_file_bytes;

class Output : public CommandLine {
 protected:
    // The last line of standard output, which is JSON.
    static core::Json last_line(const Outcome& outcome) {
        const std::string text = outcome.out.substr(0, outcome.out.size() - 1);
        return core::parse_json(text.substr(text.rfind('\n') + 1), "last line");
    }
};

TEST_F(Output, QuietLeavesWarningsAndErrors) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    const Outcome render = run("render " + scene + " -o " + file("c.h5") + " --quiet");
    EXPECT_EQ(render.status, 0);
    EXPECT_EQ(render.out, "");
    EXPECT_TRUE(fs::exists(file("c.h5")));
    EXPECT_EQ(run("--quiet info " + file("c.h5")).out, "");
    const Outcome dark =
        run("render " + scene + " -o " + file("d.h5") + " --quiet --set time_axis.opl_start_m=50");
    EXPECT_EQ(dark.out, "");
    EXPECT_NE(dark.err.find("warning: "), std::string::npos);
    const Outcome wrong = run("render none.json -o " + file("c.h5") + " --quiet");
    EXPECT_EQ(wrong.status, 2);
    EXPECT_NE(wrong.err.find("none.json"), std::string::npos);
}

TEST_F(Output, JsonEndsWithWhatTheTextShows) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    const std::string capture = file("c.h5");
    const core::Json render = last_line(run("render " + scene + " -o " + capture + " --json"));
    EXPECT_EQ(render["command"], "nlos render");
    EXPECT_EQ(render["status"], 0);
    EXPECT_EQ(render["written"], core::Json::array({capture}));
    EXPECT_EQ(render["estimator"], "third_bounce");
    EXPECT_GT(render["estimated_error"].get<double>(), 0.0);
    EXPECT_GT(render["seconds"].get<double>(), 0.0);
    EXPECT_TRUE(render.at("orders_left_out").is_null());

    const Outcome quiet = run("reconstruct " + capture + " -o " + file("v.h5") +
                              " --method lct --json --quiet --ply " + file("p.ply"));
    EXPECT_EQ(std::ranges::count(quiet.out, '\n'), 1) << "nothing but the line";
    const core::Json volume = last_line(quiet);
    EXPECT_EQ(volume["method"], "lct");
    EXPECT_EQ(volume["written"], core::Json::array({file("v.h5"), file("v.png"), file("p.ply")}));
    const core::Json scores = last_line(run("compare " + file("v.h5") + " " + scene + " --json"));
    EXPECT_TRUE(scores["metrics"]["depth_mae_m"].is_number());
    EXPECT_FALSE(scores.contains("written"));
    EXPECT_EQ(last_line(run("info " + capture + " --json"))["lines"][0], "format: y-tal HDF5");
}

// The letter lights nothing but the wall: bounces beyond the third are few.
TEST_F(Output, OrdersThatAreLeftOutAreSaidEverywhere) {
    const std::string scene = make_scene("scene.json", core::Json::object());
    const Outcome outcome = run("render " + scene + " -o " + file("c.h5") +
                                " --max-bounces 5 --target-error 0.04 --json");
    const core::Json orders = last_line(outcome)["orders_left_out"];
    ASSERT_TRUE(orders.is_object());
    EXPECT_EQ(orders["first"], 4);
    EXPECT_EQ(orders["last"], 5);
    EXPECT_GT(orders["share"].get<double>(), 0.0);
    EXPECT_LT(orders["error"].get<double>(), 0.04);
    const std::string words = "orders 4 to 5, some ";
    EXPECT_NE(outcome.out.find(words), std::string::npos);
    EXPECT_NE(run("info " + file("c.h5")).out.find("left out: bounces of " + words),
              std::string::npos);
}

TEST_F(Output, JsonTellsErrorsToo) {
    const Outcome missing = run("render none.json -o " + file("c.h5") + " --json");
    EXPECT_EQ(missing.status, 2);
    EXPECT_EQ(std::ranges::count(missing.err, '\n'), 1);
    const core::Json error = last_line(missing);
    EXPECT_EQ(error["status"], 2);
    EXPECT_EQ(error["command"], "nlos render");
    EXPECT_EQ(error["error"].get<std::string>() + "\n", missing.err);
    const Outcome usage = run("bench render --json --nonsense");
    EXPECT_EQ(usage.status, 2);
    EXPECT_EQ(last_line(usage)["command"], "nlos bench render");
    EXPECT_EQ(last_line(run("--json nonsense"))["status"], 2);
}

TEST_F(Output, NearestNamesAreOffered) {
    expect_bad_input("recontsruct a.h5", "did you mean 'reconstruct'? known are render, ");
    expect_bad_input("bench rendr",
                     "nlos bench: found unknown command 'rendr'; did you mean "
                     "'render'? known are render, ");
    expect_bad_input("render scenes/letter/scene.json -o " + file("c.h5") + " --sample 3",
                     "nlos render: found unknown option '--sample'; did you mean '--samples'?");
    expect_bad_input("reconstruct data/letter.h5 --otput " + file("v.h5"),
                     "did you mean '--output'?");
    expect_bad_input("reconstruct data/letter.h5 -o " + file("v.h5") + " --method phaser",
                     "did you mean 'phasor'? must be one of auto|lct");
    expect_bad_input("reconstruct data/letter.h5 -o " + file("v.h5") + " --set volume.voxel=3",
                     "did you mean 'voxels'? known keys are voxels, z_range_m");
    expect_bad_input("info data/letter.h5 --layout zaragosa", "did you mean 'zaragoza'?");
    expect_bad_input("bench render -o " + file("b") + " --part curve", "did you mean 'curves'?");
    const Outcome far = run("xyzzy");
    EXPECT_EQ(far.err.find("did you mean"), std::string::npos) << far.err;
    EXPECT_NE(far.err.find("known are render"), std::string::npos);
    EXPECT_NE(run("render").err.find("see nlos render --help"), std::string::npos);
}

// The terminal of `script` is one that lines can be drawn on again and again.
TEST_F(Output, NoColorAndDumbTerminalsGetPlainLines) {
    if (std::system("command -v script >/dev/null") != 0) GTEST_SKIP() << "script is not there";
    const std::string scene = make_scene("scene.json", core::Json::object());
    const std::string render = "'" NLOS_PROGRAM "' render " + scene + " -o " + file("c.h5") +
                               " --method path --seconds 1.5 --threads 1";
    const auto progress = [&](const std::string& environment) {
        const std::string command = "env -u NO_COLOR TERM=xterm " + environment +
                                    " script -qec \"" + render + "\" /dev/null >'" + file("log") +
                                    "' </dev/null";
        EXPECT_EQ(std::system(command.c_str()), 0) << command;
        return test_support::file_bytes(file("log"));
    };
    const std::string bar = progress("");
    EXPECT_NE(bar.find("\033[K"), std::string::npos) << bar;
    EXPECT_NE(bar.find("render, stage 2 of 3: rendering ["), std::string::npos) << bar;
    for (const std::string environment : {"NO_COLOR=1", "TERM=dumb"}) {
        const std::string lines = progress(environment);
        EXPECT_EQ(lines.find('\033'), std::string::npos) << lines;
        EXPECT_NE(lines.find("render, stage 2 of 3: rendering: "), std::string::npos) << lines;
    }
}

TEST_F(Output, FitsSayWhichStageTheyAreIn) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "takes many minutes; fits are tested without the program, too";
#endif
    // Coarse, but each stage must take the second from which on it is shown.
    ASSERT_EQ(run("render scenes/letter/scene.json -o " + file("in.h5") +
                  " --set scan.sensing_points=[40,40]")
                  .status,
              0);
    const std::string model = core::Json{{"scene", NLOS_SOURCE_DIR "/scenes/letter/scene.json"},
                                         {"start", "search"},
                                         {"free", {{"letter", {"pose", "albedo"}}}}}
                                  .dump();
    write_file_bytes(file("model.json"), model);
    ASSERT_EQ(
        run("fit " + file("in.h5") + " " + file("model.json") + " -o " + file("f.json")).status, 0);
    const std::string progress = test_support::file_bytes(file("err.txt"));
    EXPECT_NE(progress.find("fit, stage "), std::string::npos) << progress;
    EXPECT_NE(progress.find(": sharp data: "), std::string::npos) << progress;
}

// Benchmarks know the scenes that come with the program.
TEST_F(Output, BenchmarksRunFromAnyFolder) {
    const Outcome bench =
        run("bench render -o out --part third_bounce --scene scenes/letter/scene.json --repeats 1 "
            "--quiet --json",
            folder_.path().string());
    EXPECT_EQ(bench.status, 0) << bench.err;
    EXPECT_EQ(last_line(bench)["written"][0], "out/bench_render.json");
}

TEST_F(Output, InfoOnGeometryNamesRolesVelocitiesAndCameras) {
    const std::string traffic = run("info scenes/traffic/scene.glb").out;
    EXPECT_NE(traffic.find(", role back_wall, "), std::string::npos) << traffic;
    EXPECT_NE(traffic.find("moves by ("), std::string::npos) << traffic;
    write_file_bytes(file("scene.gltf"), R"({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"name": "target", "mesh": 0, "extras": {"nlos_role": "relay_wall"}},
                  {"name": "eye", "camera": 0, "translation": [0, 0, 2]}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 0.5235988, "znear": 0.1}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})");
    const std::string scene = run("info " + file("scene.gltf")).out;
    EXPECT_NE(scene.find("object target: 1 triangles, role relay_wall"), std::string::npos)
        << scene;
    EXPECT_NE(scene.find("camera eye: at (0, 0, 2) m, looks along (0, 0, -1), 30 deg high"),
              std::string::npos)
        << scene;
}

}  // namespace
