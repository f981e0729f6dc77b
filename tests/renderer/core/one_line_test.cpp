// SPDX-License-Identifier: MIT
#include "renderer/core/one_line.h"

#include <gtest/gtest.h>

namespace {

TEST(OneLine, TextsOfOneLineStayAsTheyAre) {
    EXPECT_EQ(core::one_line(""), "");
    EXPECT_EQ(core::one_line("St\xc3\xbchle \"7\" \\"), "St\xc3\xbchle \"7\" \\");
}

TEST(OneLine, ControlCharactersAndDamagedBytesAreReplaced) {
    EXPECT_EQ(core::one_line("a\nb\tc\x1b[0m\x7f"), "a b c [0m ");
    EXPECT_EQ(core::one_line("a\xff z"), "a\xef\xbf\xbd z");
}

}  // namespace
