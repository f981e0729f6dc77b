// SPDX-License-Identifier: MIT
// nlos track as its users call it: frames from files and as lines, and what it refuses.
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/apps/commands/simulated_walk.h"
#include "tests/support/command_line.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace {

using core::Json;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::Outcome;
using test_support::write_file_bytes;

constexpr const char* kModel =
    R"({"sensor": "vl53l8", "pose": {"position_m": [0, 0, 1]}, "background": {"frames": 10},
        "search": {"x_range_m": [-1, 1], "y_range_m": [-0.6, 0.6], "cell_m": 0.25}})";

class TrackCommand : public CommandLine {
 protected:
    // A short walk as lines, with its truth beside it.
    void write_walk() {
        test_support::WalkSettings settings;
        settings.frames = 30;
        settings.first = 14;
        settings.last = 30;
        settings.sensor_moves = false;
        settings.seed = 5;
        const test_support::SimulatedWalk walk = test_support::simulate_walk(settings);
        Json truth = Json::array();
        std::string lines;
        for (std::size_t f = 0; f < walk.frames.size(); ++f) {
            Json zones = Json::array();
            const auto& counts = walk.frames[f].counts;
            for (std::size_t z = 0; z < 16; ++z) {
                const auto begin = counts.begin() + static_cast<std::ptrdiff_t>(128 * z);
                zones.push_back(std::vector<double>(begin, begin + 128));
            }
            lines += Json{{"t", walk.frames[f].time_s}, {"histograms", zones}}.dump() + "\n";
            Json targets = Json::array();
            for (const auto& target : walk.truth[f].targets) {
                targets.push_back({{"position_m", core::write_value(target.position_m)}});
            }
            truth.push_back({{"time_s", walk.truth[f].time_s}, {"targets", targets}});
        }
        write_file_bytes(file("frames.jsonl"), lines);
        write_file_bytes(file("truth.json"), Json{{"frames", truth}}.dump());
        write_file_bytes(file("model.json"), kModel);
    }

    std::string live(const std::string& lines) const {
        return "track - " + file("model.json") + " <" + file(lines);
    }
};

TEST_F(TrackCommand, AnswersLinesWithLinesAndScoresThem) {
    write_walk();
    const Outcome outcome =
        run("track - " + file("model.json") + " -o " + file("track.json") + " --csv " +
            file("track.csv") + " --picture " + file("track.png") + " <" + file("frames.jsonl"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    std::istringstream answers(outcome.out);
    const Json track = core::read_json_file(file("track.json"));
    std::size_t frame = 0;
    for (std::string line; std::getline(answers, line); ++frame) {
        EXPECT_EQ(core::parse_json(line, "answer"), track["frames"][frame]);
    }
    ASSERT_EQ(frame, 30U);
    EXPECT_TRUE(track["frames"][0]["learning"].get<bool>());
    EXPECT_EQ(track["frames"][29]["targets"].size(), 1U);
    EXPECT_GT(file_bytes(file("track.png")).size(), 1000U);
    EXPECT_NE(file_bytes(file("track.csv")).find("time_s,id,probability"), std::string::npos);

    const Outcome compare = run("compare " + file("track.json") + " " + file("truth.json") +
                                " -o " + file("metrics.json"));
    ASSERT_EQ(compare.status, 0) << compare.err;
    const Json metrics = core::read_json_file(file("metrics.json"));
    EXPECT_LT(metrics["track_rmse_m"].get<double>(), 0.1);
    EXPECT_LT(metrics["track_false_alarms"].get<double>(), 0.1);
    EXPECT_TRUE(metrics["depth_mae_m"].is_null());

    const Outcome report = run("report " + folder_.path().string() + " -o " + file("report.html"));
    ASSERT_EQ(report.status, 0) << report.err;
    EXPECT_NE(file_bytes(file("report.html")).find("1 track"), std::string::npos);
}

/// Renders `scene`, counts with its sensor, tracks with `model`, and scores against `truth`.
class TrackScene : public TrackCommand {
 protected:
    Json scores(const Json& scene, const Json& model, const Json& truth) {
        write_file_bytes(file("scene.json"), scene.dump());
        write_file_bytes(file("model.json"), model.dump());
        write_file_bytes(file("truth.json"), truth.dump());
        for (const std::string& command :
             {"render " + file("scene.json") + " -o " + file("light.h5"),
              "simulate-noise " + file("light.h5") + " -o " + file("counts.h5") +
                  " --sensor --set ambient=0.1",
              "track " + file("counts.h5") + " " + file("model.json") + " -o " + file("track.json"),
              "compare " + file("track.json") + " " + file("truth.json") + " -o " +
                  file("metrics.json")}) {
            const Outcome outcome = run(command);
            EXPECT_EQ(outcome.status, 0) << command << outcome.err;
        }
        return core::read_json_file(file("metrics.json"));
    }

    /// The walk of the guide, a few frames of it.
    static Json walk_scene() {
        Json scene = core::read_json_file(NLOS_SOURCE_DIR "/data/walk/scene.json");
        scene["geometry"] = NLOS_SOURCE_DIR "/data/walk/vest.obj";
        scene["frames"]["count"] = kFrames;
        return scene;
    }

    static constexpr int kFrames = 8;
};

TEST_F(TrackScene, FindsADiffuseBodyWithTheErrorItReports) {
    Json scene = walk_scene();
    scene["geometry"] = file("plate.obj");
    write_file_bytes(file("plate.obj"),
                     "o vest\nv -0.1 -0.1 0.7\nv 0.1 -0.1 0.7\nv 0.1 0.1 0.7\nv -0.1 0.1 0.7\n"
                     "f 1 3 2\nf 1 4 3\n");
    scene["objects"]["vest"] = {{"albedo", 0.8}, {"velocity_m_per_s", {0.35, 0.05, -0.15}}};
    Json truth{{"frames", Json::array()}};
    for (int k = 0; k < kFrames; ++k) {
        const double t = 0.0333 * k;
        truth["frames"].push_back(
            {{"time_s", t}, {"targets", {{{"position_m", {0.35 * t, 0.05 * t, 0.7 - 0.15 * t}}}}}});
    }
    const Json model{{"background", {{"kind", "flat"}}},
                     {"target", {{"kind", "diffuse"}, {"radius_m", 0.1}}}};
    const Json metrics = scores(scene, model, truth);
    EXPECT_LT(metrics["track_rmse_m"].get<double>(), 0.1);
    EXPECT_GE(metrics["track_coverage"].get<double>(), 0.8);
    EXPECT_EQ(metrics["track_false_alarms"].get<double>(), 0.0);
}

TEST_F(TrackScene, FindsTheWayOfASensorBeforeATargetThatStands) {
    Json scene = walk_scene();
    scene["objects"]["vest"].erase("velocity_m_per_s");
    scene["scan"].erase("pose");
    Json truth{{"frames", Json::array()}};
    for (int k = 0; k < kFrames; ++k) {
        const double x = -0.6 + 0.02 * k;
        scene["scan"]["poses"].push_back(
            {{"position_m", {x, 0.0, 1.0}}, {"forward", {0.1, 0.0, -1.0}}});
        truth["frames"].push_back(
            {{"time_s", 0.0333 * k}, {"targets", {{{"position_m", {x, 0.0, 1.0}}}}}});
    }
    const Json model{{"background", {{"kind", "flat"}}},
                     {"pose", scene["scan"]["poses"][0]},
                     {"target", {{"radius_m", 0.05}, {"position_m", {0.0, 0.0, 1.2}}}},
                     {"free", "sensor_pose"}};
    const Json metrics = scores(scene, model, truth);
    EXPECT_LT(metrics["track_rmse_m"].get<double>(), 0.03);
    EXPECT_GE(metrics["track_coverage"].get<double>(), 0.8);
}

/// The guide's frames, changed by a test.
class TrackFile : public TrackCommand {
 protected:
    core::Capture capture = nlos::read_capture(NLOS_SOURCE_DIR "/data/walk/counts.h5");

    TrackFile() { capture.sequence->frames.resize(12, capture.transient); }

    std::string track(const std::string& more = "") {
        nlos::write_capture(file("frames.h5"), capture);
        return "track " + file("frames.h5") + " data/walk/track.json -o " + file("track.json") +
               more;
    }
};

TEST_F(TrackFile, ChecksFramesAsThoseOfLines) {
    const core::Capture good = capture;
    const Outcome sound = run(track());
    EXPECT_EQ(sound.status, 0) << sound.err;
    EXPECT_EQ(sound.err.find("warning"), std::string::npos) << sound.err;

    capture.sequence->frames[3].histogram(2)[7] = -4.0F;
    expect_bad_input(track(), "frame 3, zone 2: found -4 in bin 7");
    for (const double wrong : {-0.03,
                               std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
        capture = good;
        capture.sequence->frame_s = wrong;
        EXPECT_ERROR_WITH(track(), "frame_s");  // such a file is not even written
    }
    capture = good;
    capture.sequence->frame_s = 0.0;
    EXPECT_NE(run(track()).err.find("do not say how far apart"), std::string::npos);
    EXPECT_EQ(run(track(" --set frame_s=0.0333")).err.find("warning"), std::string::npos);
    capture.sequence->frames.clear();
    EXPECT_ERROR_WITH(track(), "frames: found none");
}

TEST_F(TrackFile, UsesThePoseThatIsStated) {
    ASSERT_EQ(run(track(" --set pose.position_m=[0.1,0,1.2]")).status, 0);
    const Json settings = core::read_json_file(file("track.json"))["settings"];
    EXPECT_EQ(settings["pose"]["position_m"], Json({0.1, 0.0, 1.2}));
    EXPECT_EQ(settings["pose"]["forward"], Json({0.1, 0.0, -1.0}));  // as the capture says
    expect_bad_input(track(" --set pose.position_m=[0,0,-1]"), "pose");
    expect_bad_input(track(" --set pose.forward=[0,0,1]"), "pose");
}

TEST_F(TrackCommand, RefusesBadLinesInOneLine) {
    write_file_bytes(file("model.json"), kModel);
    const std::vector<std::pair<std::string, std::string>> cases{
        {"{", "line 1"},
        {"[1]", "line 1"},
        {R"({"t": 0})", "line 1.histograms: is missing"},
        {R"({"t": "now", "histograms": null})", "line 1.t"},
        {R"({"histograms": [[1, 2]]})", "number of zones: found 1; must be 16"},
        {R"({"histograms": null, "posse": 1})", "posse"},
        {R"({"histograms": null, "pose": {"forward": [0, 0, 0]}})", "line 1.pose.forward"},
    };
    for (const auto& [line, part] : cases) {
        write_file_bytes(file("bad.jsonl"), line + "\n");
        expect_bad_input(live("bad.jsonl"), part);
    }
}

TEST_F(TrackCommand, RefusesModelsThatDoNotFit) {
    write_file_bytes(file("bad.jsonl"), "");
    write_file_bytes(file("model.json"), R"({"target": {"kind": "shiny"}})");
    expect_bad_input(live("bad.jsonl"), "retroreflective");
    write_file_bytes(file("model.json"), R"({"sensor": "vl53l9"})");
    expect_bad_input(live("bad.jsonl"), "vl53l8");
    write_file_bytes(file("model.json"), "{}");
    expect_bad_input(live("bad.jsonl"), "sensor");
    expect_bad_input(live("bad.jsonl") + " --smooth", "--smooth");
    expect_bad_input("track " + file("model.json") + " -o " + file("t.json"), "must be FRAMES");
    expect_bad_input("track data/letter.h5 " + file("model.json"), "--output");
}

}  // namespace
