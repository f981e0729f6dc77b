// SPDX-License-Identifier: MIT
#include "renderer/core/settings/settings_help.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

enum class Colour { Red, Green };

struct Inner {
    double width_m = 0.5;
    std::array<int, 2> shape{1, 2};
};

struct Outer {
    Inner inner;
    int count = 3;
    bool on = false;
    Colour colour = Colour::Red;
    std::optional<double> limit;
    std::optional<Inner> extra;
};

template <class Visitor>
void for_each_field(Inner& s, Visitor&& visit) {
    visit("width_m", s.width_m, core::above(0, "width [m]"));
    visit("shape", s.shape, core::at_least(1, "shape"));
}

template <class Visitor>
void for_each_field(Outer& s, Visitor&& visit) {
    visit("inner", s.inner, "nested");
    visit("count", s.count, "count");
    visit("on", s.on, "switch");
    visit("colour", s.colour, "colour");
    visit("limit", s.limit, core::Ranged{"limit", {0, true, 1, false}});
    visit("extra", s.extra, "extra");
}

std::string message_of(const std::string& json) {
    try {
        Outer outer;
        core::read_value(core::Json::parse(json), "file.json: ", outer);
    } catch (const core::Error& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

template <>
struct core::EnumNames<Colour> {
    static constexpr std::array<std::pair<Colour, std::string_view>, 2> value{
        {{Colour::Red, "red"}, {Colour::Green, "green"}}};
};

namespace {

TEST(Settings, ReadingChangesOnlyWhatIsPresent) {
    Outer outer;
    core::read_value(core::Json::parse(R"({"inner": {"shape": [7, 8]}, "colour": "green"})"),
                     "file.json: ",
                     outer);
    EXPECT_EQ(outer.inner.shape, (std::array<int, 2>{7, 8}));
    EXPECT_EQ(outer.inner.width_m, 0.5);
    EXPECT_EQ(outer.colour, Colour::Green);
    EXPECT_EQ(outer.count, 3);
}

TEST(Settings, EchoReadsBackToTheSameEcho) {
    Outer outer;
    outer.limit = 2.5;
    outer.extra = Inner{0.25, {4, 5}};
    const core::Json echo = core::write_value(outer);
    Outer copy;
    core::read_value(echo, "echo: ", copy);
    EXPECT_EQ(core::write_value(copy), echo);
    EXPECT_TRUE(core::write_value(Outer{})["limit"].is_null());
}

TEST(Settings, UnknownKeyListsKnownKeys) {
    EXPECT_EQ(
        message_of(R"({"inner": {"widht_m": 1}})"),
        "file.json: inner.widht_m: found an unknown key; did you mean 'width_m'? known keys are "
        "width_m, shape");
    EXPECT_EQ(message_of(R"({"inner": {"depth": 1}})"),
              "file.json: inner.depth: found an unknown key; known keys are width_m, shape");
}

TEST(Settings, WrongTypesNameKeyValueAndWhatIsAllowed) {
    EXPECT_EQ(message_of(R"({"count": "many"})"),
              "file.json: count: found \"many\"; must be a whole number");
    EXPECT_EQ(message_of(R"({"count": 1.5})"),
              "file.json: count: found 1.5; must be a whole number");
    EXPECT_EQ(message_of(R"({"count": 2147483648})"),
              "file.json: count: found 2147483648; must be between -2147483647 and 2147483647");
    EXPECT_EQ(message_of("[1]"), "file.json: found [1]; must be an object with named fields");
    EXPECT_EQ(message_of(R"({"on": 1})"), "file.json: on: found 1; must be true or false");
    EXPECT_EQ(message_of(R"({"colour": "blue"})"),
              "file.json: colour: found \"blue\"; must be one of red|green");
    EXPECT_EQ(message_of(R"({"colour": "gren"})"),
              "file.json: colour: found \"gren\"; did you mean 'green'? must be one of red|green");
    EXPECT_EQ(message_of(R"({"inner": 5})"),
              "file.json: inner: found 5; must be an object with named fields");
    EXPECT_EQ(message_of(R"({"inner": {"shape": [1]}})"),
              "file.json: inner.shape: found [1]; must be a list of 2 numbers");
    EXPECT_EQ(message_of(R"({"inner": {"width_m": null}})"),
              "file.json: inner.width_m: found null; must be a finite number");
}

TEST(Settings, RangesNameKeyValueAndWhatIsAllowed) {
    const auto check = [](double width_m, int height, std::optional<double> limit) {
        core::check_ranges(Inner{width_m, {1, height}}, "file.json: inner");
        Outer outer;
        outer.limit = limit;
        core::check_ranges(outer, "");
    };
    check(0.1, 1, std::nullopt);
    check(0.1, 1, 0.0);
    EXPECT_ERROR_WITH(check(0.0, 1, 0.5), "file.json: inner.width_m: found 0; must be above 0");
    EXPECT_ERROR_WITH(check(HUGE_VAL, 1, 0.5), "inner.width_m: found inf; must be finite");
    EXPECT_ERROR_WITH(check(0.1, 0, 0.5), "inner.shape: found 0; must be at least 1");
    EXPECT_ERROR_WITH(check(0.1, 1, 1.0), "limit: found 1; must be at least 0 and below 1");
}

TEST(Settings, FilesThatAreNoTextAreNamedInPrintableLines) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("image.json"), "\x89HDF\n");
    const std::string found =
        test_support::error_message([&] { core::read_json_file(folder.file("image.json")); });
    EXPECT_TRUE(std::all_of(found.begin(), found.end(), [](char c) {
        return c >= ' ' && c <= '~';
    })) << found;
    EXPECT_ERROR_WITH(core::read_json_file(folder.path().string()), "is a folder");
}

TEST(Settings, OverridesReachNestedFields) {
    Outer outer;
    core::apply_override(outer, "inner.shape=[3,4]");
    core::apply_override(outer, "colour=green");
    core::apply_override(outer, "extra.width_m=2");
    core::apply_override(outer, "limit=null");
    EXPECT_EQ(outer.inner.shape, (std::array<int, 2>{3, 4}));
    EXPECT_EQ(outer.colour, Colour::Green);
    ASSERT_TRUE(outer.extra);
    EXPECT_EQ(outer.extra->width_m, 2.0);
}

TEST(Settings, MalformedOverridesAreRejected) {
    Outer outer;
    for (const char* text : {"count", "=3", "inner..shape=[1,2]", "inner.width_m=nan", "none=1"}) {
        EXPECT_THROW(core::apply_override(outer, text), core::Error) << text;
    }
}

TEST(Settings, HelpListsEveryLeafWithItsDefault) {
    const auto lines = core::settings_help(Outer{});
    ASSERT_EQ(lines.size(), 9U);
    EXPECT_EQ(lines[0].key, "inner.width_m");
    EXPECT_EQ(lines[0].default_value, "0.5");
    EXPECT_EQ(lines[0].text(), "width [m] (above 0)");
    EXPECT_EQ(lines[4].choices, (std::vector<std::string>{"red", "green"}));
    EXPECT_EQ(lines[4].text(), "colour (red|green)");
    EXPECT_EQ(lines[5].text(), "limit (at least 0 and below 1)");
    EXPECT_EQ(lines[6].key, "extra");
    EXPECT_EQ(lines[6].default_value, "null");
    EXPECT_EQ(lines[8].key, "extra.shape") << "what is null has fields once it is set";
}

}  // namespace
