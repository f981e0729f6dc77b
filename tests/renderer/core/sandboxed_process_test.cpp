// SPDX-License-Identifier: MIT
#include "renderer/core/sandboxed_process.h"

#include "renderer/core/error.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <csignal>
#include <new>

namespace core {
namespace {

TEST(SandboxedProcess, AnswersAndKeepsItsState) {
    int asked = 0;
    SandboxedProcess process("some file", [&](const std::string& request) {
        ++asked;
        return request + " " + std::to_string(asked);
    });
    const std::string large(std::size_t{1} << 22, 'x');
    EXPECT_EQ(process.ask("first"), "first 1");
    EXPECT_EQ(process.ask(large), large + " 2");
    EXPECT_EQ(asked, 0);  // that was the child
}

TEST(SandboxedProcess, ErrorsOfTheChildAreThrownHere) {
    SandboxedProcess process("some file", [](const std::string& request) -> std::string {
        if (request == "error") throw Error("a: H", "holds x: y; z", "must be: w");
        if (request == "failure") throw Failure("a", "needs 3 GiB: too many");
        throw std::bad_alloc();
    });
    EXPECT_EQ(test_support::error_message([&] { process.ask("error"); }),
              "a: H: holds x: y; z; must be: w");
    try {
        process.ask("failure");
        ADD_FAILURE();
    } catch (const Failure& failure) {
        EXPECT_STREQ(failure.what(), "a: needs 3 GiB: too many");
    }
    EXPECT_THROW(process.ask("memory"), Failure);
}

TEST(SandboxedProcess, ACrashIsAnErrorOfTheFile) {
    for (const int signal : {SIGSEGV, SIGABRT, SIGKILL}) {
        SandboxedProcess process("some file", [&](const std::string& request) {
            if (request == "crash") std::raise(signal);
            return request;
        });
        EXPECT_EQ(process.ask("fine"), "fine");
        EXPECT_ERROR_WITH(process.ask("crash"), "some file: is damaged");
        EXPECT_ERROR_WITH(process.ask("again"), "crashes");
    }
    EXPECT_ERROR_WITH(run_sandboxed("some file", []() -> std::string { throw 1; }), "damaged");
}

TEST(SandboxedProcess, WhatDoesNotEndIsEnded) {
    EXPECT_ERROR_WITH(run_sandboxed("no file",
                                    [] {
                                        // As the limit on CPU time does after seconds.
                                        std::raise(SIGXCPU);
                                        return std::string();
                                    }),
                      "does not end");
}

TEST(SandboxedProcess, SeveralLiveSideBySide) {
    const auto echo = [](const std::string& request) {
        if (request == "crash") std::raise(SIGSEGV);
        return request;
    };
    SandboxedProcess first("first", echo);
    SandboxedProcess second("second", echo);
    EXPECT_ERROR_WITH(first.ask("crash"), "first: is damaged");
    EXPECT_EQ(second.ask("fine"), "fine");
}

}  // namespace
}  // namespace core
