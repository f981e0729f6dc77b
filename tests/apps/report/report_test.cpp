// SPDX-License-Identifier: MIT
#include "apps/report/report.h"

#include "apps/estimate_text.h"
#include "apps/report/html.h"
#include "apps/report/metrics_table.h"
#include "calib/fit_file.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "nlos/pictures/picture.h"
#include "nlos/pictures/pictures.h"
#include "renderer/core/output_file.h"
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

using test_support::TemporaryFolder;

std::size_t count_of(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
        ++count;
    }
    return count;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

nlos::Metrics scores(double depth_mae_m, double mask_iou) {
    nlos::Metrics metrics;
    metrics.depth_mae_m = depth_mae_m;
    metrics.mask_iou = mask_iou;
    return metrics;
}

/// A folder with one capture, one volume, two scores, pictures and a file that is no HDF5.
void fill(const TemporaryFolder& folder) {
    core::Capture capture = test_support::example_capture(core::ScanPattern::Confocal);
    capture.scene_info["command"] = "nlos render <scene> & more";
    nlos::write_capture(folder.file("capture.h5"), capture);
    const auto volume = test_support::column_volume({1.0F, 0.5F}, {0.7, 0.71});
    nlos::write_volume(folder.file("volume_bp.h5"), volume);
    nlos::write_panels_png(folder.file("volume_bp.png"), nlos::volume_panels(volume), 2);
    core::Json json = core::write_value(scores(0.002, 0.75));
    json["result"] = "somewhere/volume_bp.h5";
    json["reference"] = "scene.json";
    core::write_text_file(folder.file("metrics_bp.json"), json.dump());
    nlos::write_panels_png(folder.file("metrics_bp.png"), nlos::volume_panels(volume), 2);
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
    const std::string html = render_report(results);
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
    const std::string html = render_report(results);
    EXPECT_TRUE(contains(html, "<h2>Fits</h2>"));
    EXPECT_TRUE(contains(html, "400.00 +- 0.50"));
    EXPECT_TRUE(contains(html, "Warning: light &lt;is&gt; cut off"));
    EXPECT_TRUE(contains(html, "Unidentifiable: time_zero against chart.z"));
}

TEST(Report, NeedsNothingButItself) {
    const TemporaryFolder folder;
    fill(folder);
    write_report(folder.path().string(), folder.file("report.html"));
    std::ostringstream text;
    text << std::ifstream(folder.file("report.html"), std::ios::binary).rdbuf();
    const std::string html = text.str();
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
    const std::string html = render_report(results);
    EXPECT_TRUE(contains(html, "capture.h5"));
    EXPECT_TRUE(contains(html, "volume_bp.h5 against scene.json"));
    EXPECT_EQ(count_of(html, "<article>"), 2U);
    EXPECT_TRUE(contains(html, "1 capture, 1 reconstruction, 2 comparisons, 1 unreadable file"));
}

TEST(Report, ShowsBenchmarksWithTheirPlotsAndTable) {
    const TemporaryFolder folder;
    core::write_text_file(folder.file("bench_render.json"),
                          R"({"curves": [], "program": "nlos 1", "machine": "a <processor>"})");
    core::write_text_file(folder.file("bench_all.json"),
                          R"({"render": {"program": "nlos 1", "machine": "a <processor>"}})");
    core::write_text_file(folder.file("bench_render.txt"), "error < time");
    core::write_text_file(folder.file("bench_render.svg"), "<svg/>");
    core::write_text_file(folder.file("bench_render.png"), "the same");
    core::write_text_file(folder.file("bench_render_growth.svg"), "<svg/>");
    const ResultsFolder results = read_results_folder(folder.path().string());
    ASSERT_EQ(results.benches.size(), 1U);
    EXPECT_EQ(results.benches[0].figures.size(), 2U);
    EXPECT_TRUE(results.figures.empty());
    EXPECT_TRUE(results.documents.empty());
    const std::string html = render_report(results);
    EXPECT_TRUE(contains(html, "error &lt; time"));
    EXPECT_TRUE(contains(html, "a &lt;processor&gt;"));
    EXPECT_TRUE(contains(html, "1 benchmark"));
}

TEST(Report, ShowsHardCases) {
    const TemporaryFolder folder;
    core::write_text_file(
        folder.file("hard_cases.json"),
        R"({"hard_cases": [{"name": "sliver", "group": "geometry", "why": "thin & long",
            "must_hold": "area", "worst": 1e-9, "bound": 1e-6, "explanation": ""}]})");
    const std::string html = render_report(read_results_folder(folder.path().string()));
    EXPECT_TRUE(contains(html, "geometry: sliver"));
    EXPECT_TRUE(contains(html, "thin &amp; long"));
    EXPECT_TRUE(contains(html, "1.00e-09"));
}

TEST(Report, EscapesEveryText) {
    const TemporaryFolder folder;
    fill(folder);
    const std::string html = render_report(read_results_folder(folder.path().string()));
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
    const std::string html = render_report(results);
    EXPECT_TRUE(contains(html, "Files that could not be read"));
    EXPECT_TRUE(contains(html, "broken.h5"));
    EXPECT_TRUE(contains(html, "found &quot;much&quot;"));
}

TEST(Report, MarksTheBestValueOfEachRow) {
    ScoredResult a;
    a.name = "first";
    a.metrics = scores(0.003, 0.75);
    a.metrics.chamfer_m = 0.002;
    ScoredResult b;
    b.name = "second";
    b.metrics = scores(0.0015, 0.5);
    b.metrics.chamfer_m = 0.001;
    const std::string table = metrics_table({a, b});
    EXPECT_TRUE(contains(table, "<td>2.00</td><td class=\"best\">1.00</td>"));  // mm, lower
    EXPECT_TRUE(contains(table, "<td>3.00</td><td>1.50</td>"));  // of other shares of the surface
    EXPECT_TRUE(contains(table, "<td class=\"best\">75.0</td><td>50.0</td>"));  // %, higher
    EXPECT_EQ(count_of(table, "<tr>"), 4U);  // metrics nobody has are left out
    EXPECT_FALSE(contains(metrics_table({a}), "best\""));
    EXPECT_FALSE(contains(metrics_table({a, a}), "best\""));
    ScoredResult same = a;
    same.metrics.chamfer_m = 0.002 + 1e-12;  // reads the same
    EXPECT_FALSE(contains(metrics_table({a, same}), "best\""));
}

TEST(Report, HeadlinesAreOfTheResultWithTheHighestFScore) {
    // The first has the smaller depth error, of next to nothing.
    ScoredResult few;
    few.name = "few";
    few.metrics = scores(0.0001, 0.1);
    few.metrics.depth_coverage = 0.02;
    few.metrics.fscore = 0.04;
    few.metrics.fscore_threshold_m = 0.01;
    ScoredResult most = few;
    most.name = "most";
    most.metrics = scores(0.002, 0.9);
    most.metrics.depth_coverage = 0.95;
    most.metrics.fscore = 0.9;
    const std::string tiles = metrics_tiles({few, most});
    EXPECT_TRUE(contains(tiles, "<b>90.0<i>%</i></b><small>most</small>")) << tiles;
    EXPECT_TRUE(contains(tiles, "<b>2.00<i>mm</i></b><small>over 95.0 % of the true surface"));
    EXPECT_FALSE(contains(tiles, "0.100"));
    EXPECT_EQ(metrics_tiles({}), "");
}

TEST(Report, TablesHaveOneThreshold) {
    ScoredResult a;
    a.metrics.fscore_threshold_m = 0.02;
    ScoredResult b;
    b.metrics.fscore_threshold_m = 0.01;
    const ScoredResult none;
    const auto groups = groups_by_threshold({a, b, none, a});
    ASSERT_EQ(groups.size(), 2U);
    EXPECT_EQ(groups[0].size(), 3U);
    EXPECT_EQ(groups[1][0].metrics.fscore_threshold_m, 0.01);
    EXPECT_EQ(groups_by_threshold({none, a, a}).size(), 1U);
}

TEST(Report, EstimatesReadWithTheirErrors) {
    EXPECT_EQ(estimate_text(0.7000213, 0.000128), "0.70002 +- 0.00013");
    EXPECT_EQ(estimate_text(12.3456, 3.21), "12.3 +- 3.2");
    EXPECT_EQ(estimate_text(1234.6, 321.0), "1235 +- 321");
    EXPECT_EQ(estimate_text(0.5, 0.0), "0.5");
    EXPECT_EQ(estimate_text(0.5, INFINITY), "0.5 (unknown)");
}

TEST(Report, EveryMetricHasALabelOfItsOwn) {
    ScoredResult all;
    std::vector<std::string> keys;
    for_each_field(all.metrics, [&](const char* name, auto& field, const char*) {
        field.emplace(1);
        keys.emplace_back(name);
    });
    const std::string table = metrics_table({all});
    EXPECT_EQ(count_of(table, "<td"), keys.size());
    for (const std::string& key : keys) EXPECT_FALSE(contains(table, ">" + key + "<")) << key;
}

TEST(Report, FoldersWithoutResultsAreRefused) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(read_results_folder(folder.path().string()), "holds no result");
    EXPECT_ERROR_WITH(read_results_folder(folder.file("missing")), "is not a folder");
}

TEST(Html, Base64MatchesTheStandard) {
    // RFC 4648, section 10.
    EXPECT_EQ(encode_base64(""), "");
    EXPECT_EQ(encode_base64("f"), "Zg==");
    EXPECT_EQ(encode_base64("fo"), "Zm8=");
    EXPECT_EQ(encode_base64("foo"), "Zm9v");
    EXPECT_EQ(encode_base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(encode_base64("\xff\xfe\xfd"), "//79");
}

TEST(Html, EscapesWhatHasAMeaning) {
    EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>"),
              "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

TEST(Html, PicturesCarryTheirBytesAndWidth) {
    const std::string png =
        nlos::encode_panels_png({nlos::CurvePanel{"curve", {0.0, 1.0}, {1.0, 2.0}, "x", "y"}}, 1);
    const std::string image = embedded_image(png, "image/png", "a \"curve\"");
    EXPECT_TRUE(contains(image, "src=\"data:image/png;base64,iVBOR"));
    EXPECT_TRUE(contains(image, " width=\""));
    EXPECT_TRUE(contains(image, "alt=\"a &quot;curve&quot;\""));
    EXPECT_FALSE(contains(embedded_image("<svg/>", "image/svg+xml", "plot"), "width"));
}

}  // namespace
}  // namespace apps
