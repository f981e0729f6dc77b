// SPDX-License-Identifier: MIT
#include "apps/report/metrics_table.h"

#include "tests/apps/page/page_text.h"
#include "tests/apps/report/example_scores.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace apps {
namespace {

using page_test::contains;
using page_test::count_of;
using report_test::scores;

TEST(Report, MarksTheBestValueOfEachMetric) {
    ScoredResult a;
    a.name = "first";
    a.metrics = scores(0.003, 0.75);
    a.metrics.chamfer_m = 0.002;
    ScoredResult b;
    b.name = "second";
    b.metrics = scores(0.0015, 0.5);
    b.metrics.chamfer_m = 0.001;
    const std::string table = metrics_table({a, b});
    EXPECT_TRUE(contains(table, "<td data-value=\"0.002\">2.00</td>"));
    EXPECT_TRUE(contains(table, "<td class=\"best\" data-value=\"0.001\">1.00</td>"));  // mm, lower
    EXPECT_TRUE(contains(table, "<td class=\"best\" data-value=\"0.75\">75.0</td>"));   // %, higher
    EXPECT_TRUE(contains(table, "<td data-value=\"0.5\">50.0</td>"));
    EXPECT_TRUE(contains(table, ">1.50</td>"));  // of another fraction of the surface: not the best
    EXPECT_EQ(count_of(table, "class=\"best\""), 2U);
    EXPECT_EQ(count_of(table, "<tr>"), 3U);
    EXPECT_EQ(count_of(table, "<span class=\"unit\">"), 3U);  // metrics nobody has are left out
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
    few.metrics.fscore_10mm = 0.04;
    few.metrics.fscore_threshold_m = 0.01;
    ScoredResult most = few;
    most.name = "most";
    most.metrics = scores(0.002, 0.9);
    most.metrics.depth_coverage = 0.95;
    most.metrics.fscore_10mm = 0.9;
    const std::string tiles = metrics_tiles({few, most});
    EXPECT_TRUE(contains(tiles, "<b>90.0<i>%</i></b><small>most</small>")) << tiles;
    EXPECT_TRUE(
        contains(tiles, "<b>2.00<i>mm</i></b><small>over 95.0 % of the true surface; most"));
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

TEST(Report, EveryMetricHasALabelOfItsOwn) {
    ScoredResult all;
    std::vector<std::string> keys;
    for_each_field(all.metrics, [&](const char* name, auto& field, const char*) {
        field.emplace(1);
        if (!nlos::looks_at_truth(name)) keys.emplace_back(name);
    });
    const std::string table = metrics_table({all});
    EXPECT_EQ(count_of(table, "<td"), keys.size());
    for (const std::string& key : keys) EXPECT_FALSE(contains(table, ">" + key + "<")) << key;
}

}  // namespace
}  // namespace apps
