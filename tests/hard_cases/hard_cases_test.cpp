// SPDX-License-Identifier: MIT
// Every row of the catalogue, one test each. With `--report FILE.json` the measured table is
// written as well.
#include "apps/version.h"
#include "renderer/core/settings/json_file.h"
#include "tests/hard_cases/hard_case.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <string>

namespace hard_cases {

void PrintTo(const HardCase& row, std::ostream* out) {
    *out << row.name;
}

}  // namespace hard_cases

namespace {

using hard_cases::HardCase;

core::Json& measured_rows() {
    static core::Json rows = core::Json::array();
    return rows;
}

class HardCases : public testing::TestWithParam<HardCase> {};

TEST_P(HardCases, StayWithinTheirBound) {
    const HardCase& row = GetParam();
    const double worst = row.worst();
    EXPECT_TRUE(worst <= row.bound) << worst << " above " << row.bound << ": " << row.must_hold;
    measured_rows().push_back({{"name", row.name},
                               {"group", row.group},
                               {"why", row.why},
                               {"must_hold", row.must_hold},
                               {"worst", worst},
                               {"bound", row.bound},
                               {"explanation", row.explanation}});
}

INSTANTIATE_TEST_SUITE_P(Catalogue,
                         HardCases,
                         testing::ValuesIn(hard_cases::catalogue()),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(Catalogue, NamesAreUniqueAndLossesExplained) {
    std::set<std::string> names;
    for (const HardCase& row : hard_cases::catalogue()) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        if (row.bound > 1e-6) {
            EXPECT_GT(std::string(row.explanation).size(), 20U) << row.name;
        }
    }
}

}  // namespace

int main(int argc, char** argv) {
    testing::InitGoogleTest(&argc, argv);
    const bool has_report = argc == 3 && std::string(argv[1]) == "--report";
    const int status = RUN_ALL_TESTS();
    if (!has_report) return status;
    std::ofstream file(argv[2]);
    const core::Json table{{"hard_cases", measured_rows()}, {"program", apps::version_text()}};
    file << table.dump(1) << '\n';
    return file ? status : 1;
}
