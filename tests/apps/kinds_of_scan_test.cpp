// SPDX-License-Identifier: MIT
// Every kind of scan through every command that takes one: it works, or is refused in one line that
// says what is allowed.
#include "nlos/formats/capture_file.h"
#include "nlos/pictures/image_layout.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace {

using test_support::CommandLine;
using test_support::Outcome;

/// A kind in the words of users.
struct Example {
    std::string name;
    core::Json scene;  ///< changes to the small scene
    bool has_wall;     ///< what its captures say of it
};

// A kind without an example does not compile.
Example example_of(std::type_identity<core::WallScan>) {
    return {"confocal", {{"scan", {{"sensing_points", {8, 8}}}}}, true};
}
Example example_of(std::type_identity<core::ImageScan>) {
    const core::Json camera = {{"position_m", {0.1, 0.2, -0.5}},
                               {"look_at_m", {0.0, 0.0, 1.0}},
                               {"light_m", {-0.3, 0.3, -0.1}},
                               {"resolution", {8, 6}}};
    return {"camera", {{"camera", camera}, {"scan", nullptr}, {"relay_wall", nullptr}}, false};
}
Example example_of(std::type_identity<core::SensorScan>) {
    const core::Json pose = {{"position_m", {0.1, 0.0, 1.0}}, {"forward", {0.0, 0.0, -1.0}}};
    const core::Json scan = {{"pattern", "sensor"}, {"sensor", "vl53l8"}, {"pose", pose}};
    return {"sensor", {{"scan", scan}, {"time_axis", "auto"}}, true};
}

template <class... Kinds>
std::vector<Example> examples_of(std::type_identity<std::variant<Kinds...>>) {
    return {example_of(std::type_identity<Kinds>())...};
}

class KindsOfScan : public CommandLine, public testing::WithParamInterface<Example> {
 protected:
    std::string scene() const { return make_scene("scene.json", GetParam().scene); }

    void expect_done(const std::string& arguments) const {
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.status, 0) << arguments << "\n" << outcome.err;
    }

    /// What needs points on a relay wall refuses other kinds by name.
    void expect_done_on_walls(const std::string& arguments) const {
        if (GetParam().has_wall) {
            expect_done(arguments);
        } else {
            expect_bad_input(arguments, GetParam().name);
        }
    }

    void render(const std::string& output, const std::string& more = "") const {
        const Outcome outcome =
            run("render " + scene() + " -o " + output + " --samples 16 " + more);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_NE(outcome.out.find(", " + GetParam().name + " by "), std::string::npos)
            << outcome.out;
    }
};

TEST_P(KindsOfScan, AreWrittenReadAndComparedInEveryFormat) {
    const std::string capture = file("capture.h5");
    render(capture);
    const core::Capture rendered = nlos::read_capture(capture);
    EXPECT_EQ(rendered.scan.has_wall(), GetParam().has_wall);
    for (const std::string name : {"c.npz", "c.exr", "c.h5"}) {
        expect_done("convert " + capture + " " + file(name));
        const core::Capture read = nlos::read_capture(file(name));
        EXPECT_EQ(read.scan.pair_extents(), rendered.scan.pair_extents()) << name;
        EXPECT_EQ(read.scan.pattern(), rendered.scan.pattern()) << name;
        EXPECT_EQ(read.scan.opl_origin(), rendered.scan.opl_origin()) << name;
        const Outcome same = run("compare " + file(name) + " " + capture);
        EXPECT_EQ(same.status, 0) << same.err;
        EXPECT_EQ(same.err, "") << name;
    }
    expect_done("convert " + capture + " " + file("steady.h5") + " --steady");
    for (const char* layout : {"stanford-2018", "stanford-fk-2019", "conv-nlos"}) {
        const Outcome outcome =
            run("convert " + capture + " " + file("c.mat") + " --out-layout " + layout);
        if (outcome.status == 0) continue;
        EXPECT_EQ(outcome.status, 2) << outcome.err;
        EXPECT_NE(outcome.err.find("c.mat: "), std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find("; must be "), std::string::npos) << outcome.err;
    }
}

TEST_P(KindsOfScan, AreDescribedAndDrawn) {
    std::filesystem::create_directories(file("results"));
    const std::string capture = file("results/capture.h5");
    render(capture);
    const Outcome of_scene = run("info " + file("scene.json"));
    EXPECT_EQ(of_scene.status, 0) << of_scene.err;
    EXPECT_NE(of_scene.out.find(GetParam().name), std::string::npos) << of_scene.out;
    const Outcome of_capture = run("info " + capture);
    EXPECT_EQ(of_capture.status, 0) << of_capture.err;
    EXPECT_NE(of_capture.out.find(GetParam().name), std::string::npos) << of_capture.out;
    expect_done("info " + capture + " --picture " + file("c.png"));
    expect_done("report " + file("results") + " -o " + file("c.html"));
}

TEST_P(KindsOfScan, MakeSequences) {
    render(file("frames.h5"), "--set frames.count=2 frames.gate_step_m=0.01");
    EXPECT_EQ(nlos::read_capture(file("frames.h5")).sequence->frames.size(), 2U);
    const std::string film = "info " + file("frames.h5") + " --film " + file("film.png");
    if (nlos::is_picture(nlos::read_capture(file("frames.h5")).scan)) {
        expect_done(film);
    } else {
        expect_bad_input(film, "film: found a list");
    }
}

TEST_P(KindsOfScan, AreSolvedWhereThereIsAWall) {
    const std::string capture = file("capture.h5");
    render(capture);
    expect_done("simulate-noise " + capture + " -o " + file("counts.h5") + " --photons 1e5");
    expect_done_on_walls("reconstruct " + capture + " -o " + file("v.h5") +
                         " --method bp --set volume.voxels=[8,8,8]");
    test_support::write_file_bytes(file("model.json"),
                                   R"({"scene": "scene.json", "free": {"letter": ["albedo"]}})");
    expect_done_on_walls("fit " + capture + " " + file("model.json") + " -o " + file("f.json"));
}

INSTANTIATE_TEST_SUITE_P(All,
                         KindsOfScan,
                         testing::ValuesIn(examples_of(std::type_identity<core::Scan::Kind>())),
                         [](const auto& test) { return test.param.name; });

}  // namespace
