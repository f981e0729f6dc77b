// SPDX-License-Identifier: MIT
// What `nlos manual` writes is read by the programs that it is for: man, bash and zsh.
#include "apps/commands.h"
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using test_support::CommandLine;
using test_support::file_bytes;
using test_support::write_file_bytes;

bool has_program(const std::string& name) {
    return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

class Manual : public CommandLine {
 protected:
    void SetUp() override { ASSERT_EQ(run("manual -o " + file("manual")).status, 0); }

    std::string page(const std::string& name) const {
        return file_bytes(file("manual/man1/" + name + ".1"));
    }

    // What bash offers for the last word of a line that it takes apart as it does for people.
    std::multiset<std::string> offered(const std::vector<std::string>& words,
                                       const std::string& folder = NLOS_SOURCE_DIR) const {
        std::string line;
        for (const std::string& word : words) line += " '" + word + "'";
        write_file_bytes(
            file("ask.sh"),
            "cd '" + folder + "'\nsource '" + file("manual/bash/nlos") + "'\nCOMP_WORDS=(" + line +
                ")\nCOMP_CWORD=" + std::to_string(words.size() - 1) +
                "\n_nlos\nprintf '%s\\n' \"${COMPREPLY[@]}\" >'" + file("answer") + "'\n");
        EXPECT_EQ(std::system(("bash --norc '" + file("ask.sh") + "'").c_str()), 0);
        std::istringstream lines(file_bytes(file("answer")));
        std::multiset<std::string> answer;
        for (std::string text; std::getline(lines, text);) {
            if (!text.empty()) answer.insert(text);
        }
        return answer;
    }
};

using Names = std::multiset<std::string>;

TEST_F(Manual, HasAPageForEveryCommand) {
    for (const std::string name : {"nlos",
                                   "nlos-render",
                                   "nlos-simulate-noise",
                                   "nlos-bench",
                                   "nlos-bench-render",
                                   "nlos-manual"}) {
        EXPECT_NE(page(name).find(".SH NAME\n"), std::string::npos) << name;
    }
    const std::string render = page("nlos-render");
    EXPECT_NE(render.find("nlos\\-render \\- simulate the transients"), std::string::npos);
    EXPECT_NE(render.find("\\fBrender.samples\\fR = 256\n"), std::string::npos);
    EXPECT_NE(render.find("(at least 1"), std::string::npos) << "ranges";
    EXPECT_NE(render.find("(auto|\\:path|\\:third_bounce"), std::string::npos) << "closed sets";
    EXPECT_NE(render.find("\\fB\\-\\-target\\-error\\fR"), std::string::npos);
    EXPECT_NE(page("nlos-bench").find("\\fBnlos\\-bench\\-fit\\fR(1)"), std::string::npos);
}

TEST_F(Manual, EveryCommandOfTheListHasAPageAndIsCompleted) {
    const Names known = offered({"nlos", ""});
    for (const apps::CommandRow* row : apps::all_commands()) {
        EXPECT_FALSE(page(std::string("nlos-") + row->name).empty()) << row->name;
        EXPECT_EQ(known.count(row->name), 1U) << row->name;
    }
    EXPECT_EQ(known.size(), apps::all_commands().size());
}

TEST_F(Manual, PagesAreCleanRoff) {
    if (!has_program("groff")) GTEST_SKIP() << "groff is not there";
    const std::string check = "cd '" + file("manual/man1") +
                              "' && for page in *.1; do groff -man -ww -Tutf8 -K utf8 $page "
                              "2>&1 >/dev/null; done >'" +
                              file("warnings") + "'";
    ASSERT_EQ(std::system(check.c_str()), 0);
    EXPECT_EQ(file_bytes(file("warnings")), "");
}

TEST_F(Manual, BashOffersCommandsAndOptions) {
    EXPECT_EQ(offered({"nlos", "rec"}), Names{"reconstruct"});
    EXPECT_EQ(offered({"nlos", "re"}), (Names{"render", "reconstruct", "report"}));
    EXPECT_EQ(offered({"nlos", "bench", "re"}), (Names{"render", "regret", "reconstruct"}));
    EXPECT_EQ(offered({"nlos", "render", "--ta"}), Names{"--target-error"});
    EXPECT_EQ(offered({"nlos", "--quiet", "bench", "render", "--rep"}), Names{"--repeats"});
    EXPECT_EQ(offered({"nlos", "fit", "a.h5", "m.json", "--q"}), Names{"--quiet"});
}

TEST_F(Manual, BashOffersValues) {
    EXPECT_EQ(offered({"nlos", "reconstruct", "--method", "f"}), (Names{"fk", "fbp"}));
    EXPECT_EQ(offered({"nlos", "reconstruct", "--method", "=", "f"}), (Names{"fk", "fbp"}));
    EXPECT_EQ(offered({"nlos", "bench", "render", "--part", "ac"}), Names{"accuracy"});
    EXPECT_EQ(offered({"nlos", "render", "--samples", ""}), Names{});
}

TEST_F(Manual, BashOffersSettings) {
    EXPECT_EQ(offered({"nlos", "render", "x.json", "--set", "time_axis.num"}),
              Names{"time_axis.num_bins="});
    EXPECT_EQ(offered({"nlos", "render", "--set", "a", "=", "1", "render.met"}),
              Names{"render.method="});
    EXPECT_EQ(offered({"nlos", "render", "--set", "render.method", "=", "pa"}), Names{"path"});
    EXPECT_EQ(offered({"nlos", "render", "--set", "render.method=pa"}), Names{"path"});
    EXPECT_EQ(offered({"nlos", "render", "--set", "render.variance", "="}),
              (Names{"true", "false"}));
    EXPECT_EQ(offered({"nlos", "render", "--set", "camera.resol"}), Names{"camera.resolution="});
}

TEST_F(Manual, BashOffersFilesBySuffix) {
    fs::create_directory(file("some"));
    fs::create_directory(file("some/folder of scenes"));
    for (const std::string name : {"some/a scene.json", "some/capture.h5", "some/notes.txt"}) {
        write_file_bytes(file(name), "");
    }
    const std::string folder = file("some");
    EXPECT_EQ(offered({"nlos", "render", ""}, folder), (Names{"a scene.json", "folder of scenes"}));
    EXPECT_EQ(offered({"nlos", "reconstruct", "c"}, folder), Names{"capture.h5"});
    EXPECT_EQ(offered({"nlos", "render", "x.json", "-o", ""}, folder),
              (Names{"capture.h5", "folder of scenes"}));
    EXPECT_EQ(offered({"nlos", "report", ""}, folder), Names{"folder of scenes"});
}

TEST_F(Manual, ZshReadsItsCompletion) {
    const std::string script = file_bytes(file("manual/zsh/_nlos"));
    EXPECT_TRUE(script.starts_with("#compdef nlos\n"));
    EXPECT_NE(script.find("_nlos_bench_render() {"), std::string::npos);
    if (!has_program("zsh")) GTEST_SKIP() << "zsh is not there";
    EXPECT_EQ(std::system(("zsh -n '" + file("manual/zsh/_nlos") + "'").c_str()), 0);
}

// Units stand in names, and in the help as well.
TEST_F(Manual, SettingsGiveTheUnitsOfTheirNames) {
    const std::vector<std::array<std::string, 2>> units{{"_m_per_s", "[m/s"},
                                                        {"per_s", "[1/s"},
                                                        {"_carrier_hz", "[Hz"},
                                                        {"_hz", "[1/s"},
                                                        {"_deg", "[deg"},
                                                        {"_ps", "[ps"},
                                                        {"_ns", "[ns"},
                                                        {"_mm", "[mm"},
                                                        {"_m2", "[m^2"},
                                                        {"_gb", "[GB"},
                                                        {"_m", "[m"},
                                                        {"_s", "[s"}};
    std::istringstream lines(file_bytes(file("manual/reference.md")));
    std::size_t checked = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("| `") || line.starts_with("| `-")) continue;
        std::string key = line.substr(3, line.find('`', 3) - 3);
        if (key.ends_with("carrier_hz")) key = "_carrier_hz";
        std::erase(line, '\\');
        const auto unit = std::ranges::find_if(
            units, [&](const auto& candidate) { return key.ends_with(candidate[0]); });
        if (unit == units.end()) continue;
        ++checked;
        EXPECT_NE(line.find((*unit)[1]), std::string::npos) << line;
    }
    EXPECT_GT(checked, 100U);
}

TEST_F(Manual, ReferenceGivesDefaultsRangesAndMeanings) {
    const std::string reference = file_bytes(file("manual/reference.md"));
    EXPECT_NE(reference.find("| `render.samples` | `256` | at least 1 |"), std::string::npos);
    EXPECT_NE(reference.find("| `--method NAME` | `auto` | auto, path, third"), std::string::npos);
    EXPECT_NE(reference.find("\n## nlos bench reconstruct\n"), std::string::npos);
    std::istringstream lines(reference);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("| `")) continue;
        std::size_t cells = 0;
        for (std::size_t i = 1; i < line.size(); ++i)
            cells += line[i] == '|' && line[i - 1] != '\\';
        EXPECT_EQ(cells, 4U) << line;
    }
}

}  // namespace
