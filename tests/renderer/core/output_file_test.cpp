// SPDX-License-Identifier: MIT
#include "renderer/core/output_file.h"

#include "renderer/core/error.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace {

namespace fs = std::filesystem;

TEST(OutputFile, AppearsOnlyWhenCommitted) {
    const test_support::TemporaryFolder folder;
    const std::string target = folder.file("result.txt");
    {
        core::OutputFile output(target);
        std::ofstream(output.temporary()) << "half";
        EXPECT_FALSE(fs::exists(target));
        EXPECT_TRUE(fs::exists(output.temporary()));
    }
    EXPECT_TRUE(fs::is_empty(folder.path()));
    core::write_text_file(target, "whole");
    EXPECT_EQ(test_support::file_bytes(target), "whole");
}

TEST(OutputFile, FailedWorkLeavesTheOlderResult) {
    const test_support::TemporaryFolder folder;
    const std::string target = folder.file("result.txt");
    core::write_text_file(target, "old");
    {
        core::OutputFile output(target);
        std::ofstream(output.temporary()) << "new";
    }
    EXPECT_EQ(test_support::file_bytes(target), "old");
}

TEST(OutputFile, ImpossibleTargetsAreNamed) {
    const test_support::TemporaryFolder folder;
    EXPECT_THROW(core::OutputFile(folder.file("missing/result.txt")), core::Error);
    EXPECT_THROW(core::OutputFile(folder.path().string()), core::Error);
}

TEST(OutputFile, TargetsAreNoInputs) {
    const test_support::TemporaryFolder folder;
    core::write_text_file(folder.file("input.txt"), "old");
    fs::create_symlink(folder.file("input.txt"), folder.file("link.txt"));
    const std::vector<std::string> inputs{folder.file("input.txt"), ""};
    EXPECT_NO_THROW(core::check_targets({folder.file("result.txt"), ""}, inputs));
    EXPECT_THROW(core::check_targets({folder.file("link.txt")}, inputs), core::Error);
    EXPECT_THROW(core::check_targets({"/proc/result.txt"}, {}), core::Error);
    EXPECT_EQ(test_support::file_bytes(folder.file("input.txt")), "old");
    EXPECT_FALSE(fs::exists(folder.file("result.txt")));
}

}  // namespace
