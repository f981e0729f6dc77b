// SPDX-License-Identifier: MIT
#include "renderer/core/settings/json_file.h"
#include "tests/support/command_line.h"

namespace test_support {
namespace {

using core::Json;

class BenchField : public CommandLine {
 protected:
    // An environment of peers whose Python is a shell script.
    std::string environment_with(const std::string& script) const {
        const fs::path folder = file("peers");
        fs::create_directories(folder / "bin");
        const fs::path python = folder / "bin" / "python";
        write_file_bytes(python.string(), "#!/bin/sh\n" + script);
        fs::permissions(python, fs::perms::owner_all);
        return folder.string();
    }

    Json bench(const std::string& options) const {
        const Outcome outcome =
            run("bench field --quick --sensing-points 8 -o " + file("out") + " " + options);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return core::read_json_file(file("out/bench_field.json"));
    }
};

Json rows_of(const Json& table, const std::string& program) {
    Json rows = Json::array();
    for (const Json& row : table) {
        if (row["program"] == program) rows.push_back(row);
    }
    return rows;
}

TEST_F(BenchField, PeersThatFailCostTheirRowsOnly) {
    const std::string peers = environment_with(
        "case \"$1\" in\n"
        "*ytal*) echo Traceback >&2; echo 'no lct in <0.20>' >&2; exit 1;;\n"
        "*) echo nothing of use;;\n"
        "esac\n");
    const Json figures = bench("--peers " + peers);
    for (const Json& row : rows_of(figures["reconstruction_runs"], "nlos")) {
        EXPECT_EQ(row["reason"], "") << row;
        EXPECT_LT(row["depth_mae_mm"].get<double>(), 200.0) << row;
        EXPECT_GT(row["process_cpu_s"].get<double>(), row["cpu_s"].get<double>()) << row;
        EXPECT_GT(row["peak_mb"].get<double>(), 10.0) << row;
    }
    const Json peer_rows = rows_of(figures["reconstruction_runs"], "y-tal");
    ASSERT_EQ(peer_rows.size(), 12U);  // four methods, three captures
    for (const Json& row : peer_rows) {
        EXPECT_EQ(row["reason"], "no lct in <0.20>");
        EXPECT_TRUE(row["depth_mae_mm"].is_null());
    }
    for (const Json& row : rows_of(figures["rendering"], "mitransient")) {
        EXPECT_EQ(row["reason"], "said nothing of what it did");
    }
    EXPECT_FALSE(figures["bin_agreement"][0]["consistent"].get<bool>());
    const std::string page = file_bytes(file("out/report.html"));
    EXPECT_NE(page.find("no lct in &lt;0.20&gt;"), std::string::npos);
    EXPECT_NE(page.find("solver"), std::string::npos);
}

TEST_F(BenchField, ReadsCapturesWithKnownDistances) {
    const fs::path folder = file("captures");
    fs::create_directories(folder);
    ASSERT_EQ(run("render scenes/letter/scene.json --set 'scan.sensing_points=[16,16]' -o " +
                  (folder / "letter.h5").string())
                  .status,
              0);
    write_file_bytes((folder / "captures.json").string(),
                     R"({"captures": [{"name": "F", "file": "letter.h5", "depth_m": 0.7}]})");
    const Json figures = bench("--part captures --captures " + folder.string());
    const Json rows = rows_of(figures["captures"], "nlos");
    ASSERT_GE(rows.size(), 8U);
    for (const Json& row : rows) {
        if (row["method"] == "phasor") continue;  // blurred at so few points
        EXPECT_NEAR(row["error_mm"].get<double>(), 0.0, 10.0) << row;
    }
}

TEST_F(BenchField, WrongFoldersAreRefusedBeforeTheWork) {
    const std::string command = "bench field --quick -o " + file("out") + " ";
    expect_bad_input(command + "--peers " + file("none"), "install_peers.sh");
    expect_bad_input(command + "--captures " + file("none"), "captures.json");
    write_file_bytes(file("captures.json"), R"({"captures": [{"file": "a.h5"}]})");
    expect_bad_input(command + "--captures " + fs::path(file("x")).parent_path().string(),
                     "captures[0].depth_m");
    expect_bad_input(command + "--sensing-points 3", "8");
}

}  // namespace
}  // namespace test_support
