// SPDX-License-Identifier: MIT
#include "apps/report/report.h"

#include "apps/estimate_text.h"
#include "calib/fit_file.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "tests/apps/page/page_text.h"
#include "tests/apps/report/example_scores.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_volume.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

namespace apps {
namespace {

using page_test::contains;
using page_test::count_of;
using report_test::scores;
using test_support::TemporaryFolder;

constexpr double kAllData = 1e9;  // bytes

/// A page without its scripts and data.
std::string without_scripts(std::string html) {
    for (auto begin = html.find("<script"); begin != std::string::npos;
         begin = html.find("<script")) {
        html.erase(begin, html.find("</script>", begin) + 9 - begin);
    }
    return html;
}

/// A folder with one capture, one volume, two scores, pictures and a file that is no HDF5.
void fill(const TemporaryFolder& folder) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    capture.scene_info["command"] = "nlos render <scene> & more";
    nlos::write_capture(folder.file("capture.h5"), capture);
    const auto volume = test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71});
    nlos::write_volume(folder.file("volume_bp.h5"), volume);
    nlos::write_panels(folder.file("volume_bp.png"), nlos::volume_panels(volume), 2);
    core::Json json = core::write_value(scores(0.002, 0.75));
    json["result"] = "somewhere/volume_bp.h5";
    json["reference"] = "scene.json";
    core::write_text_file(folder.file("metrics_bp.json"), json.dump());
    nlos::write_panels(folder.file("metrics_bp.png"), nlos::volume_panels(volume), 2);
    core::write_text_file(folder.file("metrics_<b>&.json"),
                          core::write_value(scores(0.001, 0.5)).dump());
    core::write_text_file(folder.file("broken.h5"), "no <HDF5> at all");
    core::write_text_file(folder.file("plot.svg"), "<svg xmlns='http://www.w3.org/2000/svg'/>");
    core::write_text_file(folder.file("scene.json"), R"({"geometry": "<scene>.glb"})");
}

core::Json small_sweep() {
    return {{"program", "nlos <0>"},
            {"sweep", {{"scene", "<scene>.json"}}},
            {"headline", {"run", "noise.<photons>", "fscore", "failed"}},
            {"plots", {"sweep_plot"}},
            {"runs",
             {{{"run", 0}, {"noise.<photons>", nullptr}, {"fscore", 0.25}, {"failed", nullptr}},
              {{"run", 1}, {"noise.<photons>", "<b>"}, {"failed", "no <light>"}},
              {{"run", 2}, {"failed", "no memory"}},
              {{"run", 3}, {"failed", "no <light>"}}}}};
}

TEST(Report, ShowsSweepsWithTheirPlotsAndFailures) {
    const TemporaryFolder folder;
    core::write_text_file(folder.file("sweep.json"), small_sweep().dump());
    for (const std::string name : {"sweep_plot.svg", "other.svg"}) {
        core::write_text_file(folder.file(name), "<svg xmlns='http://www.w3.org/2000/svg'/>");
    }
    const ResultsFolder results = read_results_folder(folder.path().string());
    ASSERT_EQ(results.sweeps.size(), 1U);
    EXPECT_TRUE(results.documents.empty());
    ASSERT_EQ(results.sweeps[0].figures.size(), 1U);
    EXPECT_EQ(results.figures.size(), 1U) << "other.svg is nobody's";
    const std::string html = render_report(results, kAllData).html;
    EXPECT_TRUE(contains(html, "<th>&lt;photons&gt;<small>noise</small></th>"));
    EXPECT_TRUE(contains(html, "<td>none</td><td>0.25</td>"));
    EXPECT_TRUE(contains(html, "<b>Run 1, 3</b> failed: no &lt;light&gt;"));
    EXPECT_FALSE(contains(html, "<light>"));
    EXPECT_FALSE(contains(html, "<td><b>"));
}

TEST(Report, WhatIsNoWholeSweepIsADocument) {
    for (const std::string key : {"sweep", "headline", "plots", "runs"}) {
        const TemporaryFolder folder;
        core::Json json = small_sweep();
        json[key] = 3;
        core::write_text_file(folder.file("sweep.json"), json.dump());
        EXPECT_EQ(read_results_folder(folder.path().string()).documents.size(), 1U) << key;
        json.erase(key);
        core::write_text_file(folder.file("sweep.json"), json.dump());
        EXPECT_EQ(read_results_folder(folder.path().string()).documents.size(), 1U) << key;
    }
}

TEST(Report, ShowsFitsWithTheirErrorsAndDoubts) {
    const TemporaryFolder folder;
    calib::FitResult fit;
    fit.objects.emplace_back();
    fit.objects[0].name = "chart";
    fit.objects[0].position_m = core::Vec3(0.01, 0.02, 0.4);
    fit.objects[0].position_sigma_m = core::Vec3(0.001, 0.001, 0.0005);
    fit.warnings = {"light <is> cut off"};
    fit.unidentifiable = {"time_zero against chart.z"};
    core::write_text_file(folder.file("fit.json"), calib::fit_json(fit).dump());
    const ResultsFolder results = read_results_folder(folder.path().string());
    ASSERT_EQ(results.fits.size(), 1U);
    EXPECT_TRUE(results.documents.empty());
    const std::string html = render_report(results, kAllData).html;
    EXPECT_TRUE(contains(html, "<h2>Fits</h2>"));
    EXPECT_TRUE(contains(html, "400.00 +- 0.50"));
    EXPECT_TRUE(contains(html, "Warning: light &lt;is&gt; cut off"));
    EXPECT_TRUE(contains(html, "Unidentifiable: time_zero against chart.z"));
}

TEST(Report, NeedsNothingButItself) {
    const TemporaryFolder folder;
    fill(folder);
    write_report(folder.file("report.html"), read_results_folder(folder.path().string()), {});
    std::ostringstream text;
    text << std::ifstream(folder.file("report.html"), std::ios::binary).rdbuf();
    const std::string whole = text.str();
    EXPECT_FALSE(contains(whole, "<script src"));
    const std::string html = without_scripts(whole);
    for (const char* foreign : {"http", "<script", "<link", "url(", "@import", "<iframe"}) {
        EXPECT_FALSE(contains(html, foreign)) << foreign;
    }
    EXPECT_GE(count_of(html, "src="), 4U);
    EXPECT_EQ(count_of(html, "src="), count_of(html, "src=\"data:image/"));
    EXPECT_FALSE(contains(html, folder.path().string()));  // no paths of this machine
    EXPECT_TRUE(html.ends_with("</html>\n"));
}

TEST(Report, ShowsEveryResultOnce) {
    const TemporaryFolder folder;
    fill(folder);
    const ResultsFolder results = read_results_folder(folder.path().string());
    ASSERT_EQ(results.captures.size(), 1U);
    ASSERT_EQ(results.volumes.size(), 1U);
    ASSERT_EQ(results.scores.size(), 2U);
    // volume_bp.png and metrics_bp.png are shown with what they belong to.
    ASSERT_EQ(results.figures.size(), 1U);
    EXPECT_EQ(results.figures[0].file, "plot.svg");
    ASSERT_EQ(results.documents.size(), 1U);
    const std::string html = render_report(results, kAllData).html;
    EXPECT_TRUE(contains(html, "capture.h5"));
    EXPECT_TRUE(contains(html, "volume_bp.h5 against scene.json"));
    EXPECT_EQ(count_of(html, "<article>"), 2U);
    EXPECT_TRUE(contains(html, "<h3>bp<small>volume_bp.h5</small></h3>"));
    EXPECT_TRUE(contains(html, "reconstructed by bp"));
    EXPECT_TRUE(contains(html, "1 capture, 1 reconstruction, 2 comparisons, 1 unreadable file"));
}

TEST(Report, ShowsBenchmarksWithTheirPlotsAndTables) {
    const TemporaryFolder folder;
    core::Json bench{{"program", "nlos 1"}, {"machine", "a <processor>"}};
    bench["curves"] = {{{"method", "error < time"}, {"seconds", 1.5}}};
    for (int i = 0; i < 100; ++i) bench["runs"].push_back({{"run", i}});
    bench["against"] = {{"changes", {{{"quantity", "rel_l2"}}}}};
    core::write_text_file(folder.file("bench_render.json"), core::json_text(bench));
    core::write_text_file(folder.file("bench_all.json"),
                          R"({"render": {"program": "nlos 1", "machine": "a <processor>"}})");
    core::write_text_file(folder.file("bench_render.svg"), "<svg/>");
    core::write_text_file(folder.file("bench_render.png"), "the same");
    core::write_text_file(folder.file("bench_render_growth.svg"), "<svg/>");
    const ResultsFolder results = read_results_folder(folder.path().string());
    ASSERT_EQ(results.benches.size(), 1U);
    EXPECT_EQ(results.benches[0].figures.size(), 2U);
    EXPECT_TRUE(results.figures.empty());
    EXPECT_TRUE(results.documents.empty());
    const std::string html = render_report(results, kAllData).html;
    EXPECT_TRUE(contains(html, "<td class=\"text\">error &lt; time</td><td>1.5</td>"));
    EXPECT_TRUE(contains(html, "<td class=\"text\">rel_l2</td>"));
    EXPECT_TRUE(contains(html, "<summary>runs, 100 rows</summary>"));
    EXPECT_TRUE(contains(html, "a &lt;processor&gt;"));
    EXPECT_TRUE(contains(html, "1 benchmark"));
}

TEST(Report, ShowsHardCases) {
    const TemporaryFolder folder;
    core::write_text_file(
        folder.file("hard_cases.json"),
        R"({"hard_cases": [{"name": "sliver", "group": "geometry", "why": "thin & long",
            "must_hold": "area", "worst": 1e-9, "bound": 1e-6, "explanation": ""}]})");
    const std::string html =
        render_report(read_results_folder(folder.path().string()), kAllData).html;
    EXPECT_TRUE(contains(html, "geometry: sliver"));
    EXPECT_TRUE(contains(html, "thin &amp; long"));
    EXPECT_TRUE(contains(html, "1.00e-09"));
}

TEST(Report, EscapesEveryText) {
    const TemporaryFolder folder;
    fill(folder);
    const std::string html =
        render_report(read_results_folder(folder.path().string()), kAllData).html;
    EXPECT_FALSE(contains(html, "<b>&"));
    EXPECT_TRUE(contains(html, "&lt;b&gt;&amp;"));
    EXPECT_TRUE(contains(html, "nlos render &lt;scene&gt; &amp; more"));
    EXPECT_TRUE(contains(html, "&lt;scene&gt;.glb"));
}

TEST(Report, ListsFilesThatCannotBeRead) {
    const TemporaryFolder folder;
    fill(folder);
    core::write_text_file(folder.file("half.json"), "{\"depth_mae_m\": ");
    core::write_text_file(folder.file("metrics_odd.json"),
                          R"({"depth_mae_m": "much", "mask_iou": 1, "rel_l2": null})");
    const ResultsFolder results = read_results_folder(folder.path().string());
    std::string files;
    for (const auto& [file, error] : results.unreadable) {
        files += file + " ";
        EXPECT_FALSE(error.empty());
    }
    EXPECT_EQ(files, "broken.h5 half.json metrics_odd.json ");
    const std::string html = render_report(results, kAllData).html;
    EXPECT_TRUE(contains(html, "Files that could not be read"));
    EXPECT_TRUE(contains(html, "broken.h5"));
    EXPECT_TRUE(contains(html, "found &quot;much&quot;"));
}

TEST(Report, ResultsAreNamedByMethodAndByTheSettingsInWhichTheyDiffer) {
    ResultsFolder results;
    const auto add = [&](const char* file, const char* method, core::Json settings) {
        results.volumes.emplace_back();
        results.volumes.back().file = file;
        results.volumes.back().settings = std::move(settings);
        results.views.results.emplace_back();
        results.views.results.back().name = method;
    };
    add("a.h5", "lct", {{"snr", 0.1}, {"voxels", {8, 8}}});
    add("b.h5", "lct", {{"snr", 0.2}, {"voxels", {8, 8}}});
    add("c.h5", "bp", {{"snr", 0.1}});
    add("d.h5", "fk", {{"snr", 0.1}});
    add("e.h5", "fk", {{"snr", 0.1}});
    add("f.h5", "", nullptr);
    ScoredResult scored;
    scored.name = "first";
    scored.result = "a.h5";
    results.scores.push_back(scored);
    label_by_method(results);
    std::vector<std::string> labels;
    for (const ResultPanel& panel : results.volumes) labels.push_back(panel.label);
    EXPECT_EQ(
        labels,
        (std::vector<std::string>{"lct, snr 0.1", "lct, snr 0.2", "bp", "fk, d", "fk, e", ""}));
    EXPECT_EQ(results.views.results[5].name, "f.h5");
    EXPECT_EQ(results.scores[0].name, "lct, snr 0.1");
}

TEST(Report, TheTruthIsDrawnWhereItsSceneIsAtHand) {
    const TemporaryFolder folder;
    const core::Json scene{{"objects", {{{"mesh", "card.obj"}}}},
                           {"relay_wall", {{"size_m", {0.4, 0.2}}}}};
    core::write_text_file(folder.file("scene.json"), scene.dump());
    core::write_text_file(folder.file("card.obj"), "v -1 -1 0.7\nv 1 -1 0.7\nv 0 1 0.7\nf 1 3 2\n");
    const auto volume = test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71});
    nlos::write_volume(folder.file("v.h5"), volume);
    EXPECT_FALSE(read_results_folder(folder.path().string()).views.truth) << "nobody names it";
    const ResultsFolder given =
        read_results_folder(folder.path().string(), folder.file("scene.json"));
    ASSERT_TRUE(given.views.truth);
    EXPECT_EQ(given.views.truth->mesh.triangles.size(), 1U);
    ASSERT_TRUE(given.views.results[0].truth);
    EXPECT_NEAR(given.views.results[0].truth->depth_m[0], 0.7, 1e-6);
    core::Json metrics = core::write_value(scores(0.002, 0.75));
    metrics["reference"] = "scene.json";  // of the folder, not of where the program runs
    core::write_text_file(folder.file("m.json"), metrics.dump());
    EXPECT_TRUE(read_results_folder(folder.path().string()).views.truth);
    metrics["reference"] = "gone/scene.json";
    core::write_text_file(folder.file("m.json"), metrics.dump());
    EXPECT_FALSE(read_results_folder(folder.path().string()).views.truth);
    EXPECT_ERROR_WITH(read_results_folder(folder.path().string(), "gone.json"), "gone.json");
}

TEST(Report, FilesAreShownWithoutTheirFolder) {
    const TemporaryFolder folder;
    fill(folder);
    const ResultsFolder results =
        read_result_files({folder.file("capture.h5"), folder.file("volume_bp.h5")});
    EXPECT_EQ(results.name, "capture.h5, volume_bp.h5");
    EXPECT_EQ(results.views.animations.size(), 1U);
    EXPECT_EQ(results.views.results.size(), 1U);
    EXPECT_TRUE(results.scores.empty());
    for (const std::string name : {"broken.h5", "plot.svg", "none.h5"}) {
        EXPECT_ERROR_WITH(read_result_files({folder.file(name)}), name);
    }
}

TEST(Report, EstimatesReadWithTheirErrors) {
    EXPECT_EQ(estimate_text(0.7000213, 0.000128), "0.70002 +- 0.00013");
    EXPECT_EQ(estimate_text(12.3456, 3.21), "12.3 +- 3.2");
    EXPECT_EQ(estimate_text(1234.6, 321.0), "1235 +- 321");
    EXPECT_EQ(estimate_text(0.5, 0.0), "0.5");
    EXPECT_EQ(estimate_text(0.5, INFINITY), "0.5 (unknown)");
}

TEST(Report, FoldersWithoutResultsAreRefused) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(read_results_folder(folder.path().string()), "holds no result");
    EXPECT_ERROR_WITH(read_results_folder(folder.file("missing")), "is not a folder");
}

}  // namespace
}  // namespace apps
