// SPDX-License-Identifier: MIT
#include "apps/batch/work_share.h"

#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>

namespace apps {
namespace {

/// Sets variables of Slurm's array tasks while it lives.
class ArrayTask {
 public:
    explicit ArrayTask(const std::map<std::string, std::string>& values) {
        for (const char* name : kNames) ::unsetenv(name);
        for (const auto& [name, value] : values) {
            ::setenv(("SLURM_ARRAY_TASK_" + name).c_str(), value.c_str(), 1);
        }
    }
    ~ArrayTask() {
        for (const char* name : kNames) ::unsetenv(name);
    }
    ArrayTask(const ArrayTask&) = delete;
    ArrayTask& operator=(const ArrayTask&) = delete;

 private:
    static constexpr const char* kNames[] = {"SLURM_ARRAY_TASK_ID",
                                             "SLURM_ARRAY_TASK_MIN",
                                             "SLURM_ARRAY_TASK_MAX",
                                             "SLURM_ARRAY_TASK_STEP"};
};

void expect_share(const WorkShare& share, std::size_t index, std::size_t count) {
    EXPECT_EQ(share.index, index);
    EXPECT_EQ(share.count, count);
}

TEST(WorkShare, EveryPieceIsInExactlyOneShare) {
    for (const std::size_t count : {1U, 2U, 3U, 7U, 100U}) {
        for (std::size_t piece = 0; piece < 50; ++piece) {
            int num_takers = 0;
            for (std::size_t index = 0; index < count; ++index) {
                num_takers += WorkShare{index, count}.takes(piece) ? 1 : 0;
            }
            EXPECT_EQ(num_takers, 1) << piece << " of " << count;
        }
    }
}

TEST(WorkShare, IsWhatTheTextSays) {
    const ArrayTask task({{"ID", "1"}, {"MIN", "0"}, {"MAX", "8"}});
    expect_share(read_work_share("2/5"), 2, 5);
    expect_share(read_work_share("0/2"), 0, 2);
    expect_share(read_work_share("0/1"), 0, 1);
}

TEST(WorkShare, OtherTextsAreNamed) {
    for (const std::string text :
         {"5/5", "1", "/", "1/", "/2", "-1/2", "1/0", "a/b", "1/2/3", " 1/2", "1/2 ", "0x1/2"}) {
        EXPECT_ERROR_WITH(read_work_share(text), "--shard: found " + text + "; must be I/N");
    }
}

TEST(WorkShare, IsEverythingOutsideOfAnArray) {
    const ArrayTask task({});
    expect_share(read_work_share(""), 0, 1);
}

TEST(WorkShare, TasksOfAnArrayCountFromTheFirstInItsSteps) {
    {
        const ArrayTask task({{"ID", "3"}, {"MIN", "0"}, {"MAX", "9"}});
        expect_share(read_work_share(""), 3, 10);
    }
    {
        const ArrayTask task({{"ID", "7"}, {"MIN", "5"}, {"MAX", "11"}, {"STEP", "2"}});
        expect_share(read_work_share(""), 1, 4);
    }
}

TEST(WorkShare, AnArrayWithoutItsRangeIsRefused) {
    for (const std::map<std::string, std::string>& values :
         {std::map<std::string, std::string>{{"ID", "3"}},
          {{"ID", "3"}, {"MIN", "0"}},
          {{"ID", "3"}, {"MIN", "4"}, {"MAX", "9"}},
          {{"ID", "10"}, {"MIN", "4"}, {"MAX", "9"}}}) {
        const ArrayTask task(values);
        EXPECT_ERROR_WITH(read_work_share(""), "SLURM_ARRAY_TASK_ID");
    }
}

TEST(SlurmScript, AsksForTheTasksAndGivesEachItsShare) {
    const std::string script = slurm_script({"sweep", "/s.json", "/out", {}, 12, 4});
    EXPECT_TRUE(script.starts_with("#!/bin/bash\n"));
    for (const std::string line :
         {"#SBATCH --job-name=nlos-sweep\n",
          "#SBATCH --array=0-11\n",
          "--cpus-per-task=4\n",
          "--requeue",
          "#SBATCH --signal=TERM@60\n",
          "#SBATCH --output=nlos-sweep-%A_%a.log\n",
          " sweep /s.json -o /out --threads 4 --shard \"$SLURM_ARRAY_TASK_ID/12\"\n"}) {
        EXPECT_NE(script.find(line), std::string::npos) << line << script;
    }
}

// The script run by bash, with an srun that prints its words.
TEST(SlurmScript, RunsTheCommandOfItsTask) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("srun"), "#!/bin/sh\nprintf '<%s>' \"$@\"\n");
    const std::string file = folder.file("a b's.json");
    const std::string results = folder.file("results");
    test_support::write_file_bytes(folder.file("script"),
                                   slurm_script({"sweep", file, results, {"repeats=2"}, 3, 1}));
    const std::string command =
        "chmod +x " + folder.file("srun") + "; PATH=" + folder.path().string() +
        ":$PATH SLURM_ARRAY_TASK_ID=2 bash " + folder.file("script") + " > " + folder.file("out");
    ASSERT_EQ(std::system(command.c_str()), 0);
    EXPECT_TRUE(test_support::file_bytes(folder.file("out"))
                    .ends_with("><sweep><" + file + "><-o><" + results +
                               "><--set><repeats=2><--threads><1><--shard><2/3>"));
}

TEST(ShellWord, SurvivesTheShell) {
    const test_support::TemporaryFolder folder;
    for (const std::string text : {"plain/path-1.json",
                                   "",
                                   "two words",
                                   "it's",
                                   "$HOME `id` $(id) \"quoted\"",
                                   "grid.noise.photons=[1,2]",
                                   "a;b&c|d>e<f*g?h[i]~!#{j}\\",
                                   "line\nbreak",
                                   "\xc3\xa4"}) {
        const std::string script = "printf %s " + shell_word(text) + " > " + folder.file("out");
        test_support::write_file_bytes(folder.file("script"), script);
        ASSERT_EQ(std::system(("sh " + folder.file("script")).c_str()), 0) << text;
        EXPECT_EQ(test_support::file_bytes(folder.file("out")), text);
    }
    EXPECT_EQ(shell_word("plain/path-1.json"), "plain/path-1.json");
}

}  // namespace
}  // namespace apps
