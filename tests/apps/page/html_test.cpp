// SPDX-License-Identifier: MIT
#include "apps/page/html.h"

#include "nlos/pictures/picture.h"
#include "tests/apps/page/page_text.h"

#include <gtest/gtest.h>

#include <string>

namespace apps {
namespace {

using page_test::contains;

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

TEST(Html, PicturesCarryTheirBytesAndWidth) {
    const std::string png =
        nlos::encode_panels({nlos::Plot{"curve", "x", "y", {{"", {1.0, 2.0}, {1.0, 2.0}}}}}, 1);
    const std::string image = embedded_image(png, "image/png", "a \"curve\"");
    EXPECT_TRUE(contains(image, "src=\"data:image/png;base64,iVBOR"));
    EXPECT_TRUE(contains(image, " width=\""));
    EXPECT_TRUE(contains(image, "alt=\"a &quot;curve&quot;\""));
    EXPECT_FALSE(contains(embedded_image("<svg/>", "image/svg+xml", "plot"), "width"));
}

}  // namespace
}  // namespace apps
