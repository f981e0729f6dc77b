// SPDX-License-Identifier: MIT
// Settings of every command with values from the edges of their types: exit codes as documented,
// one line for what is refused, no crash. A few of them, or with NLOS_FUZZ_ALL=1 in the environment
// every setting with every value, where what takes more than 10 s fails too.
#include "apps/capture_options.h"
#include "apps/commands/reconstruct_job.h"
#include "apps/commands/track_job.h"
#include "apps/dataset/recipe.h"
#include "apps/sweep/sweep_settings.h"
#include "calib/calibrate.h"
#include "calib/fit.h"
#include "nlos/detector/detector.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_help.h"
#include "renderer/core/stopwatch.h"
#include "renderer/scene/scene_file.h"
#include "tests/support/command_line.h"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

using test_support::CommandLine;
using test_support::Outcome;

// Values of every JSON type, at its edges.
const std::vector<std::string> kValues{"0",
                                       "-1",
                                       "1",
                                       "2147483647",
                                       "-2147483648",
                                       "2147483648",
                                       "9223372036854775807",
                                       "18446744073709551615",
                                       "0.5",
                                       "-0.0",
                                       "1e-308",
                                       "5e-324",
                                       "1e308",
                                       "1e999",
                                       "nan",
                                       "inf",
                                       "null",
                                       "true",
                                       "false",
                                       "\"\"",
                                       "auto",
                                       "[]",
                                       "{}",
                                       "[0,0]",
                                       "[1,1,1]",
                                       "[1e300,-1e300,1e-300]",
                                       "[[0,0,0]]",
                                       "[null]",
                                       "/",
                                       "/dev/zero",
                                       "%s%n$(id)"};

constexpr double kLongest_s = 10.0;

class SettingsFuzz : public CommandLine {
 protected:
    // Tries `count` of the settings, each with one value, chosen by the seed; or all.
    void try_settings(const std::string& command,
                      const std::vector<core::SettingHelp>& settings,
                      int count,
                      unsigned seed) const {
        const bool all = std::getenv("NLOS_FUZZ_ALL") != nullptr;
        std::mt19937 random(seed);
        const std::size_t num_tries =
            all ? settings.size() * kValues.size() : static_cast<std::size_t>(count);
        for (std::size_t i = 0; i < num_tries; ++i) {
            const std::string& key =
                settings[all ? i / kValues.size() : random() % settings.size()].key;
            const std::string& value =
                kValues[all ? i % kValues.size() : random() % kValues.size()];
            const std::string arguments = command + " --set '" + key + "=" + value + "'";
            const core::Stopwatch stopwatch;
            const Outcome outcome = run(arguments);
            EXPECT_TRUE(!all || stopwatch.seconds() < kLongest_s) << arguments;
            EXPECT_TRUE(outcome.status >= 0 && outcome.status <= 2) << arguments;
            if (outcome.status == 0) continue;
            const std::string& error = outcome.err;
            EXPECT_GE(std::count(error.begin(), error.end(), '\n'), 1) << arguments;
            EXPECT_EQ(error.find("nlos: "), std::string::npos) << arguments << "\n"
                                                               << error << "no message of ours";
            if (outcome.status != 2) continue;
            EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << arguments << "\n"
                                                                       << error;
        }
    }
};

// Small and short, whatever the setting is.
TEST_F(SettingsFuzz, OfRender) {
    const std::string scene = make_scene("scene.json",
                                         {{"scan", {{"sensing_points", {2, 2}}}},
                                          {"time_axis", {{"num_bins", 16}, {"bin_width_m", 0.2}}},
                                          {"render", {{"samples", 4}}}});
    try_settings("render " + scene + " -o " + file("c.h5"),
                 core::settings_help(renderer::SceneDescription{}),
                 40,
                 11);
}

TEST_F(SettingsFuzz, OfReconstruct) {
    try_settings("reconstruct data/letter.h5 -o " + file("v.h5") + " --set volume.voxels=[8,8,8]",
                 core::settings_help(apps::ReconstructOptions{}),
                 40,
                 12);
}

TEST_F(SettingsFuzz, OfCaptures) {
    for (const std::string command : {"info data/letter.h5", "convert data/letter.h5 "}) {
        const bool writes = command.ends_with(' ');
        try_settings(command + (writes ? file("c.npz") : ""),
                     core::settings_help(apps::CaptureOptions{}),
                     20,
                     13);
    }
}

TEST_F(SettingsFuzz, OfSimulateNoise) {
    try_settings("simulate-noise data/letter.h5 -o " + file("c.npz") + " --photons 1000",
                 core::settings_help(nlos::DetectorSettings{}),
                 20,
                 17);
}

// The first few frames of the walk.
TEST_F(SettingsFuzz, OfTrack) {
    core::Capture walk = nlos::read_capture(NLOS_SOURCE_DIR "/data/walk/counts.h5");
    walk.sequence->frames.resize(12);
    walk.transient = walk.sequence->frames.back();
    nlos::write_capture(file("walk.h5"), walk);
    try_settings("track " + file("walk.h5") + " data/walk/track.json -o " + file("t.json"),
                 core::settings_help(apps::WithCapture<calib::TrackSettings>{}),
                 20,
                 18);
}

TEST_F(SettingsFuzz, OfGenerate) {
    try_settings("generate data/recipes/shapes.json -o " + file("set") +
                     " --set items=1 calibration_items=0 scene.scan.sensing_points=[4,4]",
                 core::settings_help(apps::Recipe{}),
                 20,
                 19);
}

// The description alone is read: a script is printed, and nothing runs.
TEST_F(SettingsFuzz, OfSweep) {
    std::vector<core::SettingHelp> settings = core::settings_help(apps::SweepSettings{});
    for (const std::string key : {"scene.time_axis",
                                  "scene.scan.sensing_points",
                                  "scene.geometry",
                                  "scene.camera",
                                  "noise.response",
                                  "noise.seed",
                                  "reconstruct.method",
                                  "reconstruct.volume.voxels",
                                  "scene",
                                  "a,b"}) {
        settings.push_back({"grid." + key, "", "", {}, ""});
        settings.push_back({"fixed." + key, "", "", {}, ""});
    }
    try_settings("sweep data/sweep.json -o " + file("out") + " --slurm", settings, 60, 16);
}

TEST_F(SettingsFuzz, OfFitAndCalibrate) {
    try_settings("fit data/letter.h5 scenes/letter/model.json -o " + file("f.json") +
                     " --set start=given max_iterations=1 blur_schedule_m=[0]",
                 core::settings_help(calib::FitSettings{}),
                 16,
                 14);
    try_settings("calibrate data/setup.json -o " + file("c.json"),
                 core::settings_help(calib::SetupSettings{}),
                 10,
                 15);
}

}  // namespace
