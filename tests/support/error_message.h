// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"

#include <gtest/gtest.h>

#include <string>

namespace test_support {

/// The message of the core::Error that `action` throws; fails the test when it throws none.
template <class Action>
std::string error_message(Action&& action) {
    try {
        action();
    } catch (const core::Error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return message;
    }
    ADD_FAILURE() << "no core::Error was thrown";
    return "";
}

}  // namespace test_support

/// Expects that `statement` throws a core::Error whose one-line message contains `part`.
#define EXPECT_ERROR_WITH(statement, part)                                  \
    EXPECT_PRED2(                                                           \
        [](const std::string& message, const std::string& wanted) {         \
            return message.find(wanted) != std::string::npos;               \
        },                                                                  \
        test_support::error_message([&] { static_cast<void>(statement); }), \
        std::string(part))
