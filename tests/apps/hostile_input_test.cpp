// SPDX-License-Identifier: MIT
// Names, values and files that mean harm: one printable line, exit code 2, soon.
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

#include <sys/stat.h>

#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::Outcome;
using test_support::write_file_bytes;

class HostileInput : public CommandLine {};

void expect_printable(const std::string& text) {
    for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= ' ' && c != 0x7f)) << text;
}

TEST_F(HostileInput, TerminalEscapesAreShownEscaped) {
    const std::string name = "bad\x1b[2J\x07\n";
    for (const std::string& command :
         {"info '" + name + "'",
          "'" + name + "'",
          "render scenes/letter/scene.json -o x.h5 --method '" + name + "'",
          "reconstruct data/letter.h5 -o x.h5 --set '" + name + "=1'"}) {
        const Outcome outcome = run(command);
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_NE(outcome.err.find("1b[2J\\"), std::string::npos) << outcome.err;
        EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
        expect_printable(outcome.err);
    }
    write_file_bytes(file("m.json"),
                     R"({"depth_mae_m": 1, "rel_l2": "\u001b]0;title\u0007", "\u001b[1mkey": 1})");
    const Outcome metrics = run("info " + file("m.json"));
    EXPECT_NE(metrics.out.find("\\x1b]0;title\\x07"), std::string::npos) << metrics.out;
    expect_printable(metrics.out);
    const Outcome convert = run("convert data/letter.h5 '" + file("bad\x1b[2J.npz") + "'");
    EXPECT_EQ(convert.status, 0) << convert.err;
    expect_printable(convert.out);
}

TEST_F(HostileInput, NamesThatAreNoUtf8AreWrittenEscaped) {
    const std::string scene = make_scene("\xff.json", core::Json::object());
    const Outcome render = run("render '" + scene + "' -o '" + file("\xfe.h5") + "' --samples 1");
    EXPECT_EQ(render.status, 0) << render.err;
    const Outcome reconstruct =
        run("reconstruct '" + file("\xfe.h5") + "' -o '" + file("\xfd.h5") + "'");
    EXPECT_EQ(reconstruct.status, 0) << reconstruct.err;
    const Outcome compare =
        run("compare '" + file("\xfd.h5") + "' '" + scene + "' -o '" + file("\xfc.json") + "'");
    EXPECT_EQ(compare.status, 0) << compare.err;
    EXPECT_NE(file_bytes(file("\xfc.json")).find("\\\\xfd.h5"), std::string::npos);
}

TEST_F(HostileInput, LongNamesAreRefusedInOurWords) {
    const std::string name(300, 'n');
    for (const std::string& command : {"info " + name,
                                       "info " + name + ".json",
                                       "render " + name + " -o x.h5",
                                       "render scenes/letter/scene.json -o " + name + ".h5",
                                       "reconstruct data/letter.h5 -o " + name + ".h5",
                                       "convert data/letter.h5 " + name.substr(0, 240) + ".h5",
                                       "compare " + name + " data/letter.h5",
                                       "bench fit -o " + file("b") + " --against " + name}) {
        expect_bad_input(command, "nnn");
        EXPECT_EQ(file_bytes(file("err.txt")).find("filesystem error"), std::string::npos);
    }
}

TEST_F(HostileInput, EmptyNamesOfOutputsAreRefusedFirst) {
    for (const std::string command : {"render scenes/letter/scene.json",
                                      "reconstruct data/letter.h5",
                                      "fit data/letter.h5 scenes/letter/model.json",
                                      "simulate-noise data/letter.h5 --photons 9",
                                      "calibrate data/setup.json",
                                      "report data",
                                      "demo",
                                      "bench fit"}) {
        expect_bad_input(command + " -o ''", "--output");
    }
}

TEST_F(HostileInput, EarlierBenchmarksAreCheckedBeforeAnythingRuns) {
    for (const std::string text : {"[]",
                                   "5",
                                   "{}",
                                   R"({"program": 1, "machine": "m"})",
                                   R"({"program": "p", "machine": []})",
                                   R"({"fit": {"program": {}}})"}) {
        write_file_bytes(file("old.json"), text);
        const std::string against = " --against " + file("old.json");
        expect_bad_input("bench fit -o " + file("b") + against, "is not a benchmark's");
        expect_bad_input("bench all -o " + file("b") + against, "is not a benchmark's");
    }
    expect_bad_input("bench fit -o " + file("b") + " --results " + file("b"), "is a folder");
}

TEST_F(HostileInput, PipesAndDevicesAreNoGeometry) {
    for (const std::string suffix : {"", ".glb", ".ply", ".obj", ".stl"}) {
        const std::string pipe = file("pipe" + suffix);
        ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
        fs::create_symlink("/dev/zero", file("zero" + suffix));
        for (const std::string& name : {"pipe" + suffix, "zero" + suffix}) {
            const std::string scene = make_scene("scene.json", {{"geometry", name}});
            expect_bad_input("render " + scene + " -o " + file("x.h5"), "is no regular file");
            if (suffix.empty()) continue;
            expect_bad_input("info " + file(name), "is no regular file");
            expect_bad_input("compare " + file(name) + " " + scene, "is no regular file");
        }
    }
    expect_bad_input(
        "render scenes/letter/scene.json -o " + file("x.h5") + " --calibration " + file("pipe"),
        "is no regular file");
}

TEST_F(HostileInput, PhotographsAreCheckedBeforeTheyAreDecoded) {
    core::Json setup = core::read_json_file(NLOS_SOURCE_DIR "/data/setup.json");
    setup["direct_returns"] = NLOS_SOURCE_DIR "/data/direct_returns.h5";
    setup["spots_px"] = setup["commands"];
    const auto expect_refused = [&](const std::string& name, const std::string& part) {
        setup["boards"]["images"] = {name, name, name};
        write_file_bytes(file("setup.json"), setup.dump());
        expect_bad_input("calibrate " + file("setup.json") + " -o " + file("c.json"), part);
    };
    fs::create_directory(file("folder.png"));
    ASSERT_EQ(::mkfifo(file("pipe.png").c_str(), 0600), 0);
    write_file_bytes(file("picture.tif"), "II*");
    std::string claim = file_bytes(NLOS_SOURCE_DIR "/scenes/letter/reconstruction.png");
    // 100,000 x 100,000 pixels, 8-bit colours, and the checksum of that.
    claim.replace(16, 17, std::string("\0\1\206\240\0\1\206\240\10\2\0\0\0\047\060\234\237", 17));
    write_file_bytes(file("claim.png"), claim);
    write_file_bytes(file("cut.jpg"), "\xff\xd8\xff\xe0");
    expect_refused("folder.png", "is a folder");
    expect_refused("pipe.png", "is no regular file");
    expect_refused("picture.tif", "is neither a PNG nor a JPEG file");
    expect_refused("claim.png", "has 100000 x 100000 pixels");
    expect_refused("cut.jpg", "cannot be decoded");
}

TEST_F(HostileInput, HolesAreNoContents) {
    for (const std::string name :
         {"s.json", "s.glb", "s.ply", "s.obj", "s.stl", "s.xml", "s.yaml"}) {
        std::ofstream(file(name)) << "\n";
        fs::resize_file(file(name), std::uintmax_t{3} << 30);
        const std::string target = name.ends_with("ml") ? file("out.json") : file("out.h5");
        const std::string command = name.ends_with("ml") ? "convert " : "info ";
        expect_bad_input(command + file(name) + (command == "info " ? "" : " " + target), name);
        const std::string scene = make_scene("scene.json", {{"geometry", name}});
        expect_bad_input("render " + scene + " -o " + file("x.h5"), name);
    }
}

}  // namespace
