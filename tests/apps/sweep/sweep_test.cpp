// SPDX-License-Identifier: MIT
// Runs of a sweep: the same whoever does them, kept, resumed, and gathered at the end.
#include "apps/sweep/sweep.h"

#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/parallel.h"
#include "tests/apps/sweep/sweep_folder.h"
#include "tests/support/error_message.h"

#include <set>

namespace {

namespace fs = std::filesystem;
using apps::SweepPlan;
using apps::SweepProgress;
using apps::SweepResults;
using core::Json;
using test_support::file_bytes;
using test_support::write_file_bytes;

class Sweep : public test_support::SweepFolder {};

TEST_F(Sweep, GivesTheSameInPiecesAndForAnyNumberOfThreads) {
    const SweepPlan plan = make_plan();
    EXPECT_EQ(do_share(plan, "whole", {}, 1).num_new, 8U);
    EXPECT_EQ(do_share(plan, "threads", {}, 2).num_new, 8U);
    std::size_t num_new = 0;
    for (const std::size_t index : {2U, 0U, 1U}) {
        const SweepResults shards(plan, file("shards"));
        EXPECT_FALSE(shards.rows().has_value());
        num_new += do_share(plan, "shards", {index, 3}).num_new;
        EXPECT_EQ(shards.num_done(), num_new);
    }
    EXPECT_EQ(num_new, 8U);
    EXPECT_EQ(results(plan, "threads"), results(plan, "whole"));
    EXPECT_EQ(results(plan, "shards"), results(plan, "whole"));
}

TEST_F(Sweep, RepeatsDifferByTheirNoiseAlone) {
    const SweepPlan plan = make_plan({{"repeats", 2}});
    do_share(plan, "out");
    const auto metrics = [&](std::size_t run) {
        return without_measurements(core::read_json_file(run_file("out", run)))["metrics"];
    };
    EXPECT_NE(metrics(0), metrics(1)) << "20 photons";
    EXPECT_EQ(metrics(4), metrics(5)) << "no noise";
    EXPECT_FALSE(metrics(0)["depth_mae_m"].is_null());
}

TEST_F(Sweep, DoesOnlyWhatIsMissingOrDamaged) {
    const SweepPlan plan = make_plan();
    do_share(plan, "out");
    const std::vector<std::string> before = results(plan, "out");
    fs::remove(run_file("out", 5));
    const std::string whole = file_bytes(run_file("out", 2));
    write_file_bytes(run_file("out", 2), whole.substr(0, whole.size() / 2));
    write_file_bytes(run_file("out", 3), "");
    write_file_bytes(run_file("out", 6), "{}");
    const auto untouched = fs::last_write_time(run_file("out", 1));
    EXPECT_EQ(SweepResults(plan, file("out")).num_done(), 4U);
    const SweepProgress done = do_share(plan, "out");
    EXPECT_EQ(done.num_new, 4U);
    EXPECT_EQ(done.num_kept, 4U);
    EXPECT_EQ(fs::last_write_time(run_file("out", 1)), untouched);
    EXPECT_EQ(results(plan, "out"), before);
}

TEST_F(Sweep, RefusesTheFolderOfAnother) {
    do_share(make_plan(), "out");
    const std::string before = file_bytes(run_file("out", 0));
    EXPECT_ERROR_WITH(do_share(make_plan({{"repeats", 2}}), "out"), "another sweep");
    EXPECT_ERROR_WITH(SweepResults(make_plan({{"repeats", 2}}), file("out")).rows(),
                      "another sweep");
    EXPECT_EQ(file_bytes(run_file("out", 0)), before);
}

TEST_F(Sweep, AFailingRunIsRecordedAndStopsNoOther) {
    const SweepPlan plan = make_plan({{"grid",
                                       {{"scene.scan.pattern", {"confocal", "single"}},
                                        {"reconstruct.method", {"bp", "solver"}},
                                        {"reconstruct.memory_gb", {nullptr, 1e-6}}}}});
    EXPECT_EQ(do_share(plan, "out").num_new, 8U);
    const auto rows = SweepResults(plan, file("out")).rows();
    ASSERT_TRUE(rows.has_value());
    const apps::SweepSummary summary = apps::write_summary(plan, *rows, file("out"));
    EXPECT_EQ(summary.num_failed, 4U);
    for (const Json& row : *rows) {
        const bool fails = !row["reconstruct.memory_gb"].is_null();
        ASSERT_EQ(row["failed"].is_string(), fails) << row;
        EXPECT_EQ(row["depth_mae_m"].is_null(), fails) << row;
        EXPECT_EQ(row["failed"].dump().find("memory") != std::string::npos, fails) << row;
    }
    EXPECT_EQ(do_share(plan, "out").num_kept, 8U) << "failures are results";
}

TEST_F(Sweep, ASceneThatFailsFailsItsRunsAlone) {
    const SweepPlan plan = make_plan({{"grid",
                                       {{"scene.relay_wall.center_m", {{0, 0, 5}, {0, 0, 0}}},
                                        {"reconstruct.method", {"bp", "lct"}}}}});
    do_share(plan, "out");
    for (std::size_t run = 0; run < 4; ++run) {
        const Json json = core::read_json_file(run_file("out", run));
        EXPECT_EQ(json["failed"].is_string(), run < 2) << json;
    }
}

TEST_F(Sweep, StopsBetweenRunsAndGoesOn) {
    const SweepPlan plan = make_plan();
    const SweepResults stopped(plan, file("out"));
    core::Progress progress;
    progress.stop_requested = [&] { return stopped.num_done() >= 3; };
    const SweepProgress done = apps::do_share(plan, stopped, {}, progress);
    EXPECT_TRUE(done.interrupted);
    EXPECT_EQ(done.num_new, 3U);
    EXPECT_EQ(stopped.num_done(), 3U);
    EXPECT_EQ(do_share(plan, "out").num_new, 5U);
    do_share(plan, "whole");
    EXPECT_EQ(results(plan, "out"), results(plan, "whole"));
}

TEST_F(Sweep, TheTableHoldsEveryRunWithValuesAndScores) {
    const SweepPlan plan = make_plan();
    do_share(plan, "out");
    const auto rows = SweepResults(plan, file("out")).rows();
    ASSERT_TRUE(rows.has_value());
    apps::write_summary(plan, *rows, file("out"));
    const Json json = core::read_json_file(file("out/sweep.json"));
    ASSERT_EQ(json["runs"].size(), 8U);
    std::set<std::string> keys;
    nlos::Metrics metrics;
    for_each_field(metrics, [&](const char* name, auto&, const char*) {
        if (!nlos::looks_at_truth(name)) keys.insert(name);
    });
    for (const char* key : {"scene.scan.sensing_points",
                            "noise.photons_per_point",
                            "reconstruct.method",
                            "run",
                            "failed",
                            "seconds_render",
                            "seconds_reconstruct",
                            "program"}) {
        keys.insert(key);
    }
    for (std::size_t run = 0; run < 8; ++run) {
        const Json& row = json["runs"][run];
        EXPECT_EQ(row["run"], run);
        for (const std::string& key : keys) EXPECT_TRUE(row.contains(key)) << key;
        EXPECT_FALSE(row.contains("mask_iou_best"));
        const Json file = core::read_json_file(run_file("out", run));
        EXPECT_EQ(row["depth_rmse_m"], file["metrics"]["depth_rmse_m"]);
        EXPECT_EQ(row["scene.scan.sensing_points"], file["values"]["scene.scan.sensing_points"]);
    }
    const std::string csv = file_bytes(file("out/sweep.csv"));
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 9);
    EXPECT_NE(csv.find("\n3,\"[8,8]\",,bp,"), std::string::npos) << csv;
}

TEST(SweepTable, QuotesWhatSeparates) {
    const Json rows = Json::array({{{"a", "x,\"y\""}, {"b", nullptr}}, {{"b", 0.5}, {"c", true}}});
    EXPECT_EQ(apps::csv_text(rows), "a,b,c\r\n\"x,\"\"y\"\"\",,\r\n,0.5,true\r\n");
}

// Rows of a sweep that nobody ran: the score is known.
TEST(SweepPlots, DrawMeansOverRepeatsAgainstNumbers) {
    apps::SweepSettings sweep;
    core::read_value(core::parse_json(R"({"grid": {"noise.photons": [10, 1000, null],
                                          "reconstruct.method": ["lct", "bp"]}, "repeats": 2,
                                          "plots": [{"metric": "fscore",
                                                     "against": "noise.photons"}]})",
                                      "sweep"),
                     "",
                     sweep);
    Json rows = Json::array();
    for (const Json& photons : {Json(10), Json(1000), Json(nullptr)}) {
        for (const std::string method : {"lct", "bp"}) {
            for (const double difference : {-0.125, 0.125}) {
                const double x = photons.is_null() ? 3.0 : photons.get<double>();
                const double score = x + (method == "bp" ? 0.5 : 0.0) + difference;
                rows.push_back({{"noise.photons", photons},
                                {"reconstruct.method", method},
                                {"fscore", score}});
            }
        }
    }
    rows.push_back({{"noise.photons", 10}, {"reconstruct.method", "bp"}, {"fscore", nullptr}});
    const auto plots = apps::plots_of(sweep, rows);
    ASSERT_EQ(plots.size(), 1U);
    EXPECT_EQ(plots.begin()->first, "sweep_fscore_by_noise_photons");
    const nlos::Plot& plot = plots.begin()->second;
    EXPECT_EQ(plot.x_scale, nlos::AxisScale::Logarithmic);
    EXPECT_EQ(plot.y_scale, nlos::AxisScale::Linear);
    ASSERT_EQ(plot.lines.size(), 4U);
    EXPECT_EQ(plot.lines[1].title, "method bp");
    EXPECT_EQ(plot.lines[1].x, (std::vector<double>{10.0, 1000.0}));
    EXPECT_EQ(plot.lines[1].y, (std::vector<double>{10.5, 1000.5}));
    EXPECT_EQ(plot.lines[3].style, nlos::LineStyle::Limit);
    EXPECT_EQ(plot.lines[3].limit_of, 1);
    EXPECT_EQ(plot.lines[3].y, (std::vector<double>{3.5, 3.5}));
}

TEST(SweepPlots, NeedResultsAtTwoNumbers) {
    apps::SweepSettings sweep;
    core::read_value(
        core::parse_json(R"({"grid": {"noise.photons": [1, 2]}})", "sweep"), "", sweep);
    Json rows = Json::array({{{"noise.photons", 1}, {"seconds", 0.5}, {"depth_mae_m", 0.5}},
                             {{"noise.photons", 2}, {"seconds", 0.5}, {"depth_mae_m", nullptr}}});
    const auto plots = apps::plots_of(sweep, rows);
    ASSERT_EQ(plots.size(), 1U) << "scores that no run has are not drawn either";
    EXPECT_EQ(plots.begin()->first, "sweep_seconds_by_noise_photons");
}

TEST(SweepPlots, SpreadManyCurvesOverPictures) {
    apps::SweepSettings sweep;
    core::read_value(
        core::parse_json(R"({"grid": {"scene.render.seed": [1, 2, 3], "noise.seed": [1, 2, 3, 4],
                                      "reconstruct.method": ["lct", "bp"], "noise.photons": [1, 2]},
                             "plots": [{"metric": "fscore", "against": "noise.photons"}]})",
                         "sweep"),
        "",
        sweep);
    Json rows = Json::array();
    for (int run = 0; run < 48; ++run) {
        rows.push_back({{"scene.render.seed", run / 16 + 1},
                        {"noise.seed", run / 4 % 4 + 1},
                        {"reconstruct.method", run / 2 % 2 == 0 ? "lct" : "bp"},
                        {"noise.photons", run % 2 + 1},
                        {"fscore", 0.5}});
    }
    const auto plots = apps::plots_of(sweep, rows);
    ASSERT_EQ(plots.size(), 3U);
    for (const auto& [name, plot] : plots) EXPECT_EQ(plot.lines.size(), 8U);
    EXPECT_EQ(plots.at("sweep_fscore_by_noise_photons_02").title, "seed 2");
}

}  // namespace
