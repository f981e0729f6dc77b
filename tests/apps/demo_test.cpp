// SPDX-License-Identifier: MIT
// The demo, whole.
#include "tests/support/command_line.h"

#include <gtest/gtest.h>

namespace {

using test_support::file_bytes;
using test_support::Outcome;

class Demo : public test_support::CommandLine {};

TEST_F(Demo, MakesASelfContainedReport) {
    const Outcome outcome = run("demo -o " + file("demo"));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const std::string page = file_bytes(file("demo/report.html"));
    EXPECT_NE(page.find("data:image/png;base64,"), std::string::npos);
    EXPECT_EQ(page.find("src=\"http"), std::string::npos);
    EXPECT_NE(outcome.out.find("wrote " + file("demo/report.html")), std::string::npos);
}

}  // namespace
