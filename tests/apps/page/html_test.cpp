// SPDX-License-Identifier: MIT
#include "apps/page/html.h"

#include <gtest/gtest.h>

#include <string>

namespace apps {
namespace {

TEST(Html, Base64MatchesTheStandard) {
    // RFC 4648, section 10.
    EXPECT_EQ(encode_base64(""), "");
    EXPECT_EQ(encode_base64("f"), "Zg==");
    EXPECT_EQ(encode_base64("fo"), "Zm8=");
    EXPECT_EQ(encode_base64("foo"), "Zm9v");
    EXPECT_EQ(encode_base64("foobar"), "Zm9vYmFy");
    EXPECT_EQ(encode_base64("\xff\xfe\xfd"), "//79");
}

TEST(Html, EscapesWhatHasAMeaning) {
    EXPECT_EQ(escape_html("<a href=\"x\">'&'</a>"),
              "&lt;a href=&quot;x&quot;&gt;&#39;&amp;&#39;&lt;/a&gt;");
}

TEST(Html, WhatIsNoUtf8IsEscapedAndLinesStay) {
    EXPECT_EQ(escape_html("a\xff<\n  \"\xc3\xbc\x1b"), "a\\xff&lt;\n  &quot;\xc3\xbc\\x1b");
}

}  // namespace
}  // namespace apps
