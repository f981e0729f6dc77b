// SPDX-License-Identifier: MIT
#include "renderer/core/settings/json_file.h"

#include "renderer/core/settings/settings.h"
#include "tests/support/error_message.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace core {
namespace {

TEST(JsonText, NestingIsBounded) {
    const auto nested = [](std::size_t depth) {
        return std::string(depth, '[') + std::string(depth, ']');
    };
    EXPECT_NO_THROW(parse_json(nested(100), "text"));
    EXPECT_ERROR_WITH(parse_json(nested(102), "text"), "text: its JSON is nested deeper than 100");
    EXPECT_ERROR_WITH(parse_json(nested(200'000), "text"), "must be nested less");
    EXPECT_ERROR_WITH(parse_json(std::string(200'000, '['), "text"), "must be nested less");
    EXPECT_EQ(json_if_valid(nested(200'000)), std::nullopt);
    EXPECT_EQ(json_if_valid("[1]"), Json::array({1}));
}

TEST(JsonText, KeysThatComeTwiceAreNamed) {
    EXPECT_ERROR_WITH(parse_json(R"({"a": {"b": 1}, "c": [{"b": 2, "b": 3}]})", "text"),
                      "text: its JSON has the key 'b' twice; must have it once");
    EXPECT_NO_THROW(parse_json(R"({"a": {"b": 1}, "b": [{"b": 2}, {"b": 3}]})", "text"));
}

TEST(JsonText, ObjectsMayHaveAnyNumberOfKeys) {
    std::string text = "{";
    for (int i = 0; i < 100'000; ++i) text += "\"" + std::to_string(i) + "\": {},";
    const Json json =
        parse_json(text + "\"list\": [{}, [], null, -1, 2, 0.5, true, \"a\"]}", "text");
    EXPECT_EQ(json.size(), 100'001U);
    EXPECT_EQ(json.begin().key(), "0") << "in the order of the text";
    EXPECT_EQ(json["list"].dump(), R"([{},[],null,-1,2,0.5,true,"a"])");
    EXPECT_EQ(parse_json("5", "text"), 5);
}

TEST(JsonText, MessagesShowCharactersAsPeopleWriteThem) {
    EXPECT_ERROR_WITH(parse_json("{\"größe\": [1\n, é]}", "text"), "line 2, column 3: found 'é'");
    EXPECT_ERROR_WITH(parse_json("[\"größe", "text"), "last read: '\"größe'");
    EXPECT_ERROR_WITH(parse_json("[\"größe\tb\"]", "text"), "line 1, column 8: invalid string");
    EXPECT_ERROR_WITH(parse_json("[\"a\xff\"]", "text"), "line 1, column 4: invalid string");
    EXPECT_ERROR_WITH(parse_json("[\"a\nb\"]", "text"), "a line ends before its quote is closed");
    const std::string message =
        test_support::error_message([] { parse_json("[\"" + std::string(10'000, 'a'), "text"); });
    EXPECT_LT(message.size(), 250U) << message;
}

TEST(JsonText, UsualMistakesAreCalledByTheirName) {
    const std::vector<std::array<std::string, 2>> mistakes{
        {"[1, 2,]", "column 7: found ']'; the last item has no comma behind it"},
        {"{\"a\": 1,\n}", "line 2, column 1: found '}'; the last item has no comma"},
        {"{\"größe\": “x”}", "column 11: found '“'; texts stand between straight double quotes"},
        {"{'a': 1}", "column 2: found '''; texts stand between straight double quotes"},
        {"{\"a\": 1 // one\n}", "column 9: found '/'; JSON has no comments"},
        {"# a\n{}", "column 1: found '#'; JSON has no comments"},
        {"\xef\xbb\xbf[1,]", "column 4: found ']'; the last item"},
        {"{\"a\": NaN}", "found 'NaN'; JSON has no numbers but finite ones"},
        {"{\"a\": -Infinity}", "found '-Infinity'; JSON has no numbers but finite ones"},
        {"[True]", "column 2: found 'True'; JSON writes true, false and null"},
        {"[1 true]", "column 4: found 'true'; a comma or colon is missing before it"},
        {"[tru]", "column 2: found 'tru'"},
        {"{a: 1}", "column 2: found 'a'; expected a key between double quotes"},
        {"{\"a\": 1 \"b\": 2}", "column 9: found '\"'; a comma or colon is missing before it"},
        {"[.5]", "found '.'; numbers begin with a digit"},
        {"[1, 2", "it ends before all brackets are closed"},
        {"", "it is empty"},
        {"\xff\xfe{", "its text is UTF-16; must be UTF-8"}};
    for (const auto& [text, reason] : mistakes) {
        EXPECT_ERROR_WITH(parse_json(text, "text"), reason) << text;
    }
    EXPECT_EQ(parse_json("\xef\xbb\xbf[1]", "text"), Json::array({1})) << "a mark of UTF-8 is none";
}

TEST(JsonText, NumbersBeyondDoubleAreReported) {
    EXPECT_ERROR_WITH(parse_json("[1e999]", "text"), "text: is not valid JSON (number overflow");
}

TEST(JsonText, OnlyRegularFilesAreRead) {
    const test_support::TemporaryFolder folder;
    ASSERT_EQ(::mkfifo(folder.file("pipe.json").c_str(), 0600), 0);
    EXPECT_ERROR_WITH(read_json_file(folder.file("pipe.json")), "pipe.json: is no regular file");
    EXPECT_ERROR_WITH(read_json_file(folder.path().string()), "is a folder");
    EXPECT_ERROR_WITH(read_json_file(std::string(300, 'n')),
                      "cannot be opened (File name too long)");
    EXPECT_ERROR_WITH(read_json_file(folder.file("none.json")), "none.json: cannot be opened");
}

TEST(Error, WhatIsOnePrintableLine) {
    EXPECT_EQ(printable("a\nb\r\t\x1b[2J\x7f"), "a\\nb\\r\\t\\x1b[2J\\x7f");
    EXPECT_EQ(printable("a\u0085\u202eb\u2066"), "a\\u0085\\u202eb\\u2066");
    EXPECT_EQ(printable("größer €😀"), "größer €😀");
    EXPECT_EQ(printable("\xc3(\xc2\x85\xe2\x82\xed\xa0\x80\xf8"),
              "\\xc3(\\u0085\\xe2\\x82\\xed\\xa0\\x80\\xf8");
    EXPECT_STREQ(Error("a", "b\nc", "d").what(), "a: b\\nc; d");
    EXPECT_STREQ(Failure("a\r", "b").what(), "a\\r: b");
}

}  // namespace
}  // namespace core
