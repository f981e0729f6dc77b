// SPDX-License-Identifier: MIT
#include "apps/bench/gnuplot.h"

#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace apps {
namespace {

// Texts that try to end the string that they stand in, and names that gnuplot would take for a
// pipe.
TEST(Gnuplot, TextsAndFileNamesRunNoCommands) {
    const test_support::TemporaryFolder folder;
    const std::string mark = folder.file("mark");
    const std::string touch = "touch " + mark;
    const std::string quote = "q'; system('" + touch + "'); print '";
    Plot plot;
    plot.title = quote;
    plot.x_label = "`" + touch + "`";
    plot.y_label = "a\nsystem('" + touch + "')\nset title '";
    plot.lines = {{quote, {1.0, 2.0}, {1.0, 2.0}}, {"\"`" + touch + "`\"", {1.0}, {2.0}}};
    std::filesystem::create_directories(folder.file("|touch mark; '"));
    for (const std::string name : {"q'; system('touch mark'); print '", "|touch mark; '/`x`"}) {
        if (!draw_plot(plot, folder.file(name))) GTEST_SKIP() << "gnuplot is not installed";
        const std::string svg = test_support::file_bytes(folder.file(name) + ".svg");
        EXPECT_NE(svg.find("system("), std::string::npos) << "the title is drawn as it is";
        EXPECT_EQ(test_support::file_bytes(folder.file(name) + ".png").substr(1, 3), "PNG");
    }
    EXPECT_FALSE(std::filesystem::exists(mark));
    EXPECT_FALSE(std::filesystem::exists("mark"));
}

}  // namespace
}  // namespace apps
