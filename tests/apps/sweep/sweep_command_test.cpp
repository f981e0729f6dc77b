// SPDX-License-Identifier: MIT
// The sweep as its users call it.
#include "renderer/core/settings/json_file.h"
#include "tests/apps/sweep/sweep_folder.h"

#include <algorithm>

namespace {

namespace fs = std::filesystem;
using core::Json;
using test_support::file_bytes;
using test_support::Outcome;

class SweepCommand : public test_support::SweepFolder {};

// Of 8 x 8 points on a wall of 1 m, which files hold as they are: other places are rounded there.
TEST_F(SweepCommand, ScoresAreThoseOfTheCommandsOneByOne) {
    make_sweep();
    const Outcome sweep = run("sweep " + file("sweep.json") + " -o " + file("out"));
    ASSERT_EQ(sweep.status, 0) << sweep.err;
    const std::string scene = file("scene.json");
    const std::string axis =
        R"( 'time_axis={"opl_start_m":1.2,"bin_width_m":0.016,"num_bins":64}')";
    const std::string volume = " --set volume.z_range_m=[0.6,0.8]";
    ASSERT_EQ(
        run("render " + scene + " -o " + file("c.h5") + " --set scan.sensing_points=[8,8]" + axis)
            .status,
        0);
    ASSERT_EQ(run("simulate-noise " + file("c.h5") + " -o " + file("n.h5") +
                  " --photons-per-point 20 --ambient 0.01")
                  .status,
              0);
    for (const auto& [number, capture, method] : {std::tuple{0U, "n.h5", "lct"},
                                                  std::tuple{1U, "n.h5", "bp"},
                                                  std::tuple{2U, "c.h5", "lct"},
                                                  std::tuple{3U, "c.h5", "bp"}}) {
        ASSERT_EQ(run("reconstruct " + file(capture) + " -o " + file("v.h5") + " --method " +
                      method + volume)
                      .status,
                  0);
        ASSERT_EQ(run("compare " + file("v.h5") + " " + scene + " -o " + file("m.json")).status, 0);
        Json metrics = core::read_json_file(file("m.json"));
        for (const char* key : {"result", "reference", "seconds", "peak_rss_bytes"}) {
            metrics.erase(key);
        }
        const Json ours =
            without_measurements(core::read_json_file(run_file("out", number)))["metrics"];
        EXPECT_EQ(ours, metrics) << number;
        EXPECT_FALSE(metrics["mask_iou_best"].is_null());
    }
}

TEST_F(SweepCommand, ShardsOfManyProcessesMakeOneTable) {
    make_sweep();
    const std::string sweep = "sweep " + file("sweep.json") + " -o " + file("out") + " --shard ";
    const Outcome first = run(sweep + "0/2");
    EXPECT_EQ(first.status, 0) << first.err;
    EXPECT_NE(first.out.find("4 of 8 are done"), std::string::npos) << first.out;
    EXPECT_FALSE(fs::exists(file("out/sweep.json")));
    const Outcome second = run(sweep + "1/2");
    EXPECT_EQ(second.status, 0) << second.err;
    EXPECT_TRUE(second.out.ends_with("sweep.json and sweep.csv (8 runs)\n")) << second.out;
    EXPECT_EQ(core::read_json_file(file("out/sweep.json"))["runs"].size(), 8U);

    ASSERT_EQ(run("report " + file("out") + " -o " + file("page.html")).status, 0);
    const std::string page = file_bytes(file("page.html"));
    EXPECT_NE(page.find("Sweeps over settings"), std::string::npos);
    EXPECT_NE(page.find("<th>method<small>reconstruct</small></th>"), std::string::npos);
    EXPECT_EQ(page.find("Other files"), std::string::npos) << "the table belongs to the sweep";
    EXPECT_EQ(run("info " + file("out/sweep.json")).status, 0);
    EXPECT_EQ(run("info " + file("sweep.json")).status, 0);
}

TEST_F(SweepCommand, TheReportNamesRunsThatFailed) {
    make_sweep({{"grid", {{"reconstruct.memory_gb", {1, 1e-6}}}}});
    const Outcome sweep = run("sweep " + file("sweep.json") + " -o " + file("out"));
    EXPECT_EQ(sweep.status, 0) << sweep.err;
    EXPECT_TRUE(sweep.out.ends_with("(2 runs, 1 of them failed)\n")) << sweep.out;
    ASSERT_EQ(run("report " + file("out") + " -o " + file("page.html")).status, 0);
    EXPECT_NE(file_bytes(file("page.html")).find("<b>Run 1</b> failed: "), std::string::npos);
}

TEST_F(SweepCommand, FailsWhenAllRunsDo) {
    make_sweep({{"grid", {{"reconstruct.memory_gb", {1e-6, 1e-7}}}}});
    const Outcome sweep = run("sweep " + file("sweep.json") + " -o " + file("out"));
    EXPECT_EQ(sweep.status, 1) << sweep.err;
    EXPECT_NE(sweep.err.find("sweep: all of its 2 runs failed"), std::string::npos) << sweep.err;
    EXPECT_TRUE(fs::exists(file("out/sweep.json")));
}

TEST_F(SweepCommand, BadInputIsOneLineBeforeAnythingRuns) {
    make_sweep();
    const std::string sweep = "sweep " + file("sweep.json") + " -o " + file("out");
    expect_bad_input(sweep + " --set grid.noise.seed=[1,-2]", "noise.seed: found -2");
    expect_bad_input(sweep + " --set grid.reconstruct.method=[lct]", "reconstruct.method");
    expect_bad_input(sweep + " --shard 2/2", "--shard");
    expect_bad_input(sweep + " --slurm 0", "--slurm: found 0");
    expect_bad_input(sweep + " --slurm x", "--slurm: found x");
    expect_bad_input("sweep " + file("scene.json") + " -o " + file("out"), "unknown key");
    EXPECT_FALSE(fs::exists(file("out")));
    expect_bad_input("sweep " + file("sweep.json") + " -o " + file("scene.json"), "cannot be made");
}

TEST_F(SweepCommand, SlurmGetsAScriptAndNothingRuns) {
    make_sweep();
    const std::string sweep = "sweep " + file("sweep.json") + " -o '" + file("two words") +
                              "' --set repeats=2 --threads 3 --slurm";
    const Outcome outcome = run(sweep);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_TRUE(outcome.out.starts_with("#!/bin/bash\n")) << outcome.out;
    EXPECT_NE(outcome.out.find("--array=0-1\n"), std::string::npos) << "a task for each capture";
    EXPECT_NE(outcome.out.find("--cpus-per-task=3\n"), std::string::npos);
    EXPECT_NE(outcome.out.find(" --set repeats=2 --threads 3 --shard "), std::string::npos);
    EXPECT_NE(outcome.out.find("'" + file("two words") + "'"), std::string::npos);
    EXPECT_FALSE(fs::exists(file("two words")));
    EXPECT_NE(run(sweep + " 5").out.find("--array=0-4\n"), std::string::npos);
}

}  // namespace
