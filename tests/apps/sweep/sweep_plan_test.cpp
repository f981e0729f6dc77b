// SPDX-License-Identifier: MIT
// The runs that a sweep file stands for, and what is refused before any of them.
#include "apps/sweep/sweep_plan.h"

#include "renderer/core/settings/json_file.h"
#include "tests/apps/sweep/sweep_folder.h"
#include "tests/support/error_message.h"

#include <set>

namespace {

using apps::SweepPlan;
using apps::SweepRun;
using core::Json;

class SweepPlanTest : public test_support::SweepFolder {
 protected:
    // Expects that a sweep whose grid is this one is refused, with both parts in the message.
    void expect_refused(const std::string& grid,
                        const std::string& key,
                        const std::string& what) const {
        const std::string message = test_support::error_message([&] {
            make_plan({{"grid", core::parse_json(grid, "grid")}});
        });
        EXPECT_NE(message.find(key), std::string::npos) << message;
        EXPECT_NE(message.find(what), std::string::npos) << message;
    }
};

TEST_F(SweepPlanTest, NumbersRunsWithTheLastKeyFastestAndRepeatsLast) {
    const SweepPlan plan = make_plan({{"repeats", 3}});
    ASSERT_EQ(plan.num_runs(), 24U);
    std::size_t number = 0;
    for (const int points : {8, 6}) {
        for (const Json& photons : {Json(20), Json(nullptr)}) {
            for (const std::string method : {"lct", "bp"}) {
                for (int repeat = 0; repeat < 3; ++repeat) {
                    const SweepRun run = plan.run(number);
                    EXPECT_EQ(run.number, number++);
                    EXPECT_EQ(run.repeat, repeat);
                    EXPECT_EQ(run.scene.scan.sensing_points[1], points);
                    EXPECT_EQ(run.scene.time_axis.num_bins, 64);
                    EXPECT_EQ(run.noise.has_value(), !photons.is_null());
                    const nlos::DetectorSettings noise =
                        run.noise.value_or(nlos::DetectorSettings());
                    EXPECT_EQ(noise.photons_per_point.has_value(), run.noise.has_value());
                    EXPECT_EQ(noise.photons_per_point.value_or(20.0), 20.0);
                    EXPECT_EQ(noise.seed, run.noise ? static_cast<unsigned>(repeat) : 0U);
                    EXPECT_EQ(noise.ambient, run.noise ? 0.01 : 0.0);
                    EXPECT_EQ(core::enum_name(run.reconstruct.method), method);
                    EXPECT_EQ((*run.reconstruct.volume.z_range_m)[1], 0.8);
                    EXPECT_EQ(run.values["noise.photons_per_point"], photons);
                }
            }
        }
    }
}

TEST_F(SweepPlanTest, KeysOfOneEntryVaryTogether) {
    const SweepPlan plan = make_plan(
        {{"fixed", Json::object()},
         {"grid",
          {{"scene.time_axis.bin_width_m,scene.time_axis.num_bins", {{0.01, 200}, {0.02, 100}}},
           {"reconstruct.method", Json::array({"bp"})}}}});
    ASSERT_EQ(plan.num_runs(), 2U);
    EXPECT_EQ(plan.run(0).scene.time_axis.num_bins, 200);
    EXPECT_EQ(plan.run(1).scene.time_axis.num_bins, 100);
    EXPECT_EQ(plan.run(1).scene.time_axis.bin_width_m, 0.02);
    EXPECT_EQ(plan.run(1).values["scene.time_axis.num_bins"], 100);
}

TEST_F(SweepPlanTest, OverridesReachTheSweepsOwnKeys) {
    const SweepPlan plan(make_sweep(),
                         {"repeats=2",
                          "grid.noise.photons_per_point=[1,2,3]",
                          "grid.reconstruct.snr=[5]",
                          "fixed.noise.ambient=0.5"});
    ASSERT_EQ(plan.num_runs(), 24U);
    EXPECT_EQ(plan.run(4).noise->photons_per_point, 2.0);
    EXPECT_EQ(plan.run(4).noise->ambient, 0.5);
    EXPECT_EQ(plan.run(4).reconstruct.snr, 5.0);
    const SweepPlan automatic(make_sweep(),
                              {"fixed.scene.time_axis=auto",
                               "fixed.scene.time_axis.num_bins=9",
                               "fixed.noise.response.tail_ps=7",
                               "fixed.noise.response.jitter_fwhm_ps=8"});
    EXPECT_EQ(automatic.run(0).scene.time_axis.num_bins, 9) << "the last one counts";
    EXPECT_EQ(automatic.run(0).noise->response.tail_ps, 7.0);
    EXPECT_EQ(automatic.run(0).noise->response.jitter_fwhm_ps, 8.0);
}

TEST_F(SweepPlanTest, PiecesHoldEveryRunOnceAndOneCaptureEach) {
    const SweepPlan plan = make_plan({{"grid",
                                       {{"reconstruct.method", {"lct", "bp", "fk"}},
                                        {"scene.scan.sensing_points", {{8, 8}, {6, 6}}}}}});
    EXPECT_EQ(plan.pieces(1), (std::vector<std::vector<std::size_t>>{{0, 2, 4}, {1, 3, 5}}));
    EXPECT_EQ(plan.pieces(2), plan.pieces(1));
    for (const std::size_t num_shares : {3U, 4U, 6U, 50U}) {
        std::multiset<std::size_t> runs;
        const auto pieces = plan.pieces(num_shares);
        EXPECT_GE(pieces.size(), std::min<std::size_t>(num_shares, 4));
        for (const auto& piece : pieces) {
            EXPECT_FALSE(piece.empty());
            runs.insert(piece.begin(), piece.end());
            for (const std::size_t run : piece) EXPECT_EQ(run % 2, piece.front() % 2);
        }
        EXPECT_EQ(runs, (std::multiset<std::size_t>{0, 1, 2, 3, 4, 5}));
    }
}

TEST_F(SweepPlanTest, WrongKeysAndValuesOfTheGridAreNamed) {
    expect_refused(R"({"scene.foo": [1]})", "scene.foo", "unknown key");
    expect_refused(R"({"noise.response.foo": [1]})", "noise.response.foo", "unknown key");
    expect_refused(R"({"foo.bar": [1]})", "foo.bar", "must be a setting's");
    expect_refused(R"({"scene": [1]})", "scene", "must be a setting's");
    expect_refused(R"({"scene.scan.": [1]})", "scene.scan.", "must be a setting's");
    expect_refused(R"({"reconstruct.method": ["lct", "x"]})", "reconstruct.method", "\"x\"");
    expect_refused(R"({"scene.scan.sensing_points": [[8, 8], "a"]})",
                   "scene.scan.sensing_points",
                   "found \"a\"");
    expect_refused(R"({"scene.scan.sensing_points": [[8, 8], [0, 16]]})",
                   "scene.scan.sensing_points",
                   "scene.scan.sensing_points = [0,16]");
    expect_refused(
        R"({"noise.photons_per_point": [5, -1]})", "noise.photons_per_point", "found -1");
    expect_refused(R"({"noise.photons": [5], "noise.photons_per_point": [5]})",
                   "noise.photons",
                   "found beside photons_per_point");
    expect_refused(R"({"noise.response.jitter_fwhm_ps": [-5]})", "jitter_fwhm_ps", "-5");
    expect_refused(R"({"reconstruct.snr": [-5]})", "reconstruct.snr", "above 0");
    expect_refused(R"({"scene.render.target_error": []})", "scene.render.target_error", "found []");
    expect_refused(R"({"scene.render.target_error": 0.1})", "scene.render.target_error", "a list");
    expect_refused(R"({"scene.camera": [{"resolution": [4, 4], "look_at_m": [0, 0, 1]}]})",
                   "scene.camera",
                   "a wall");
}

TEST_F(SweepPlanTest, AKeyStandsInOnePlace) {
    expect_refused(R"({"noise.seed": [1], "noise.seed, noise.ambient": [[1, 2]]})",
                   "noise.seed",
                   "found twice");
    expect_refused(R"({"noise.response": [{}], "noise.response.tail_ps": [1]})",
                   "noise.response.tail_ps",
                   "found twice");
    expect_refused(R"({"noise.ambient": [1]})", "noise.ambient", "among fixed as well");
    expect_refused(R"({"noise": {"seed": [1]}, "noise.seed": [2]})", "noise.seed", "found twice");
    expect_refused(R"({"noise.seed, noise.ambient": [[1]]})",
                   "noise.seed, noise.ambient",
                   "a list of 2 values");
}

TEST_F(SweepPlanTest, OtherKeysAreCheckedToo) {
    const auto refused = [&](const Json& changes, const std::string& part) {
        EXPECT_ERROR_WITH(make_plan(changes), part);
    };
    refused({{"repeats", 0}}, "repeats: found 0");
    refused({{"reptile", 0}}, "reptile: found an unknown key; known keys are scene, fixed, grid");
    refused({{"scene", "other.json"}}, "other.json");
    refused({{"scene", ""}}, "scene: found nothing");
    refused({{"fixed", {{"reconstruct.snr", "x"}}}}, "reconstruct.snr");
    refused({{"fixed", {{"noise.seed, noise.ambient", 1}}}}, "must be one key");
    refused({{"fixed", {{"scene.objects", {{"nobody", Json::object()}}}}}}, "nobody");
    refused({{"repeats", 1000000}}, "8e+06 runs");
    const auto plots = [](const char* metric, const char* against) {
        return Json{{"plots", Json::array({{{"metric", metric}, {"against", against}}})}};
    };
    refused(plots("depth", "noise.photons_per_point"), "plots.metric: found depth");
    refused(plots("fscore", "reconstruct.method"), "plots.against: found reconstruct.method");
    refused(plots("fscore", "noise.photons_per_point"), "at least two different numbers");
    make_plan(plots("fscore", "scene.scan.sensing_points"));
}

TEST_F(SweepPlanTest, TheFingerprintIsOfAllThatChangesResults) {
    const std::string first = make_plan().fingerprint();
    EXPECT_EQ(make_plan().fingerprint(), first);
    EXPECT_EQ(make_plan({{"plots", Json::array()}}).fingerprint(), first);
    EXPECT_NE(make_plan({{"repeats", 2}}).fingerprint(), first);
    EXPECT_NE(make_plan({{"fixed", Json::object()}}).fingerprint(), first);
    make_sweep();
    make_scene("scene.json", {{"relay_wall", {{"albedo", 0.5}}}});
    EXPECT_NE(SweepPlan(file("sweep.json"), {}).fingerprint(), first);
    make_sweep();
    std::filesystem::copy_file(NLOS_SOURCE_DIR "/scenes/animal/scene.glb",
                               file("scene.glb"),
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_NE(SweepPlan(file("sweep.json"), {}).fingerprint(), first);
}

}  // namespace
