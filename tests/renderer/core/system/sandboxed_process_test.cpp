// SPDX-License-Identifier: MIT
#include "renderer/core/system/sandboxed_process.h"

#include "renderer/core/error.h"
#include "renderer/core/settings/json_file.h"
#include "tests/support/error_message.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <ctime>
#include <latch>
#include <mutex>
#include <new>
#include <thread>

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
    EXPECT_ERROR_WITH(run_sandboxed("some file", []() -> Json { throw 1; }), "damaged");
}

TEST(SandboxedProcess, WhatDoesNotEndIsEnded) {
    EXPECT_ERROR_WITH(run_sandboxed("no file",
                                    [] {
                                        // As the limit on CPU time does after seconds.
                                        std::raise(SIGXCPU);
                                        return Json();
                                    }),
                      "does not end");
}

// The child's copy of a lock that another thread held when it was started is never released.
TEST(SandboxedProcess, AChildThatWaitsForAnotherThreadsLockIsReplaced) {
    std::mutex mutex;
    std::latch is_held(1);
    std::latch is_started(1);
    std::thread other([&] {
        const std::lock_guard lock(mutex);
        is_held.count_down();
        is_started.wait();
    });
    is_held.wait();
    SandboxedProcess process("some file", [&](const std::string& request) {
        const std::lock_guard lock(mutex);
        return request;
    });
    is_started.count_down();
    other.join();
    EXPECT_EQ(process.ask("first"), "first");
    EXPECT_EQ(process.ask("second"), "second");
}

TEST(SandboxedProcess, AChildThatWorksLongIsNotReplaced) {
    const auto begin = std::chrono::steady_clock::now();
    int asked = 0;
    SandboxedProcess process("some file", [&](const std::string&) {
        ++asked;
        // Work with naps, longer than one that waits for a lock is left alone.
        for (int i = 0; asked == 2 && i < 150; ++i) {
            const auto start = std::clock();
            while (std::clock() - start < CLOCKS_PER_SEC / 100) {
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return std::to_string(asked);
    });
    EXPECT_EQ(process.ask(""), "1");
    EXPECT_EQ(process.ask(""), "2");
    EXPECT_GT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
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
