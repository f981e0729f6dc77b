// SPDX-License-Identifier: MIT
#include "apps/tables/tables.h"

#include "apps/bench/output.h"
#include "renderer/core/settings/json_file.h"

#include <gtest/gtest.h>

namespace {

using apps::Table;
using core::Json;

Json figures() {
    return {{"scene", "bars"},
            {"empty", Json::array()},
            {"costs", {{{"name", "lct"}, {"seconds", 0.123456}, {"met", true}, {"note", ""}}}},
            {"curves",
             {{{"method", "path"},
               {"name", "outer"},
               {"points", {{{"name", "a"}, {"x", 1}}, {{"name", "b"}, {"x", 2}}}}},
              {{"method", "restir"}, {"name", "none"}, {"points", Json::array()}}}}};
}

TEST(BenchTables, EveryListOfRowsIsATable) {
    const std::vector<Table> tables = apps::tables_of(figures());
    ASSERT_EQ(tables.size(), 3U);
    EXPECT_EQ(tables[0].rows, (std::vector<std::vector<std::string>>{{"scene", "bars"}}));
    EXPECT_EQ(tables[1].name, "costs");
    EXPECT_EQ(tables[1].columns, (std::vector<std::string>{"name", "seconds", "met"}));
    EXPECT_EQ(tables[1].rows[0], (std::vector<std::string>{"lct", "0.1235", "yes"}));
}

TEST(BenchTables, RowsWithinRowsRepeatWhatIsAroundThem) {
    const Table table = apps::tables_of(figures())[2];
    EXPECT_EQ(table.columns,
              (std::vector<std::string>{"method", "name", "points.name", "points.x"}));
    ASSERT_EQ(table.rows.size(), 3U);
    EXPECT_EQ(table.rows[1], (std::vector<std::string>{"path", "outer", "b", "2"}));
    EXPECT_EQ(table.rows[2], (std::vector<std::string>{"restir", "none", "", ""}));
}

TEST(BenchTables, MarkdownEscapesBarsAndLeavesOutLongTables) {
    const Json json{{"rows", {{{"name", "a|b"}}, {{"name", "c"}}}}};
    EXPECT_EQ(apps::markdown(apps::tables_of(json), 2),
              "### rows\n\n| name |\n|---|\n| a\\|b |\n| c |\n\n");
    EXPECT_EQ(apps::markdown(apps::tables_of(json), 1),
              "### rows\n\n2 rows, in the JSON file.\n\n");
}

TEST(BenchResults, ASectionIsReplacedAndOtherTextStays) {
    const std::string first = apps::with_section("# Results\n", "fit", "old\n");
    const std::string both = apps::with_section(first, "render", "rays\n");
    EXPECT_EQ(both,
              "# Results\n\n<!-- nlos bench fit -->\nold\n<!-- end of nlos bench fit -->\n"
              "\n<!-- nlos bench render -->\nrays\n<!-- end of nlos bench render -->\n");
    EXPECT_EQ(apps::with_section(both, "fit", "new\n"),
              "# Results\n\n<!-- nlos bench fit -->\nnew\n<!-- end of nlos bench fit -->\n"
              "\n<!-- nlos bench render -->\nrays\n<!-- end of nlos bench render -->\n");
}

}  // namespace
