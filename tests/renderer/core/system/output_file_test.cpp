// SPDX-License-Identifier: MIT
#include "renderer/core/system/output_file.h"

#include "renderer/core/error.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace {

namespace fs = std::filesystem;
using test_support::write_file_bytes;

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
    for (const std::string text : {"whole", "newer"}) {
        core::write_text_file(target, text);
        EXPECT_EQ(test_support::file_bytes(target), text);
        EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
    }
}

TEST(OutputFile, SymbolicLinksStayAndWhatTheyLeadToIsWritten) {
    const test_support::TemporaryFolder folder;
    fs::create_directory(folder.file("data"));
    fs::create_symlink("data/blob", folder.file("first.npz"));
    fs::create_symlink("first.npz", folder.file("second.npz"));
    for (const std::string text : {"whole", "newer"}) {
        {
            const core::OutputFile output(folder.file("second.npz"));
            EXPECT_TRUE(output.temporary().ends_with(".npz")) << output.temporary();
            EXPECT_EQ(fs::path(output.temporary()).parent_path(), folder.file("data"));
        }
        core::write_text_file(folder.file("second.npz"), text);
        EXPECT_TRUE(fs::is_symlink(folder.file("first.npz")));
        EXPECT_TRUE(fs::is_symlink(folder.file("second.npz")));
        EXPECT_EQ(test_support::file_bytes(folder.file("data/blob")), text);
        EXPECT_EQ(std::distance(fs::directory_iterator(folder.file("data")), {}), 1);
    }
    fs::create_symlink("loop", folder.file("loop"));
    EXPECT_THROW(core::write_text_file(folder.file("loop"), "x"), core::Error);
    fs::create_symlink("nowhere/x", folder.file("dangling"));
    EXPECT_THROW(core::write_text_file(folder.file("dangling"), "x"), core::Error);
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

TEST(OutputFile, LeftoversOfKilledRunsOfTheSameNameAreRemoved) {
    const test_support::TemporaryFolder folder;
    const std::string target = folder.file("result.txt");
    const auto partial_of = [&](const std::string& name, const std::string& process) {
        std::string partial = core::partial_file_of(folder.file(name));
        const std::string own = "." + std::to_string(::getpid()) + "-";
        return partial.replace(partial.find(own), own.size(), "." + process + "-");
    };
    const pid_t ended = ::fork();
    if (ended == 0) ::_exit(0);
    ::waitpid(ended, nullptr, 0);
    const std::string stale = partial_of("result.txt", std::to_string(ended));
    const std::string other_machine =
        folder.file(".result." + std::to_string(ended) + "-0.partial.txt");
    const std::vector<std::string> others{partial_of("result.txt", std::to_string(::getppid())),
                                          partial_of("result.png", std::to_string(ended)),
                                          partial_of("result.more.txt", std::to_string(ended)),
                                          partial_of("result.txt", "x"),
                                          partial_of("result.txt", ""),
                                          other_machine,
                                          folder.file("result.partial.txt")};
    for (const std::string& name : others) write_file_bytes(name, "theirs");
    write_file_bytes(stale, "half");
    { const core::OutputFile output(target); }
    EXPECT_FALSE(fs::exists(stale));
    for (const std::string& name : others) EXPECT_TRUE(fs::exists(name)) << name;
}

TEST(OutputFile, SignalHandlersRemoveWhatIsBeingWritten) {
    const test_support::TemporaryFolder folder;
    const core::OutputFile first(folder.file("a.txt"));
    std::string gone;
    {
        const core::OutputFile second(folder.file("b.txt"));
        gone = second.temporary();
    }
    write_file_bytes(gone, "of somebody else by now");
    EXPECT_TRUE(fs::exists(first.temporary()));
    core::remove_partial_files();
    EXPECT_FALSE(fs::exists(first.temporary()));
    EXPECT_TRUE(fs::exists(gone));
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
