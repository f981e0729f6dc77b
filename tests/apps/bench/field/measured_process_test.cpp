// SPDX-License-Identifier: MIT
#include "apps/bench/field/measured_process.h"

#include "renderer/core/error.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace apps {
namespace {

MeasuredProcess run_shell(const std::string& script, const ProcessLimits& limits = {}) {
    const test_support::TemporaryFolder folder;
    return run_measured({"sh", "-c", script}, folder.file("log"), limits);
}

TEST(MeasuredProcess, TellsTheLastLineOfWhatItSays) {
    const MeasuredProcess process = run_shell("echo first; echo '{\"a\": 1}'; echo noise >&2");
    EXPECT_EQ(process.failure, "");
    EXPECT_EQ(process.last_line, "{\"a\": 1}");
}

TEST(MeasuredProcess, HoldsLibrariesToOneThread) {
    EXPECT_EQ(run_shell("echo $OMP_NUM_THREADS$OPENBLAS_NUM_THREADS").last_line, "11");
}

TEST(MeasuredProcess, TellsWhyItFailed) {
    EXPECT_EQ(run_shell("echo trace >&2; echo 'Error: no lct' >&2; exit 1").failure,
              "Error: no lct");
    EXPECT_EQ(run_shell("exit 3").failure, "ended with status 3");
    EXPECT_EQ(run_shell("kill -SEGV $$").failure, "ended by signal 11 (Segmentation fault)");
    EXPECT_THROW(run_measured({"/nowhere/python"}, "/dev/null", {}), core::Failure);
}

TEST(MeasuredProcess, IsStoppedWhenItTakesTooLong) {
    const MeasuredProcess process = run_shell("while true; do :; done", {1.0});
    EXPECT_EQ(process.failure, "stopped after 1 s of CPU time");
    EXPECT_TRUE(process.was_stopped);
    EXPECT_GT(process.cpu_seconds, 0.5);
}

TEST(MeasuredProcess, GetsNoMoreMemoryThanItMay) {
    const std::uint64_t few = 64ull << 20;
    EXPECT_NE(run_shell("head -c 500000000 /dev/zero | tail -c 400000000 | wc -c >&2; "
                        "x=$(head -c 200000000 /dev/zero | tr '\\0' x)",
                        {60.0, few})
                  .failure,
              "");
}

}  // namespace
}  // namespace apps
