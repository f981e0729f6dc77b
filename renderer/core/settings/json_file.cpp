// SPDX-License-Identifier: MIT
#include "renderer/core/settings/json_file.h"

#include "renderer/core/mapped_file.h"
#include "renderer/core/nearest_name.h"
#include "renderer/core/settings/settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <unordered_set>
#include <utility>

namespace core {
namespace {

constexpr std::size_t kLongestShown = 40;
constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";

bool continues_character(char byte) {
    return (static_cast<unsigned char>(byte) & 0xc0U) == 0x80U;
}

// The characters of UTF-8 between two places.
std::size_t count_characters(std::string_view text) {
    return static_cast<std::size_t>(
        std::ranges::count_if(text, [](char byte) { return !continues_character(byte); }));
}

// Where the character that holds a byte begins, and where it ends.
std::pair<std::size_t, std::size_t> character_at(std::string_view text, std::size_t byte) {
    std::size_t begin = byte;
    while (begin > 0 && byte - begin < 3 && continues_character(text[begin])) --begin;
    if (static_cast<unsigned char>(text[begin]) < 0xc0U) begin = byte;  // no UTF-8
    std::size_t end = begin + 1;
    while (end < text.size() && end - begin < 4 && continues_character(text[end])) ++end;
    return {begin, end};
}

std::string position_text(std::string_view text, std::size_t byte) {
    const std::string_view before = text.substr(0, byte);
    const std::size_t line_start = before.rfind('\n') + 1;  // 0 when there is none
    return fmt::format("line {}, column {}",
                       1 + std::ranges::count(before, '\n'),
                       1 + count_characters(before.substr(line_start)) -
                           (line_start == 0 && text.starts_with(kByteOrderMark) ? 1 : 0));
}

/// Control characters as people write them in strings, where the library says <U+000A>.
std::string with_escapes(std::string text) {
    constexpr std::string_view kMark = "<U+";
    constexpr std::size_t kMarkBytes = 8;  // <U+000A>
    for (std::size_t at = text.find(kMark); at != std::string::npos; at = text.find(kMark, at)) {
        if (text.size() < at + kMarkBytes || text[at + kMarkBytes - 1] != '>') break;
        const std::string code = text.substr(at + kMark.size(), 4);
        std::string escape = "\\u" + code;
        if (code == "000A") escape = "\\n";
        if (code == "000D") escape = "\\r";
        if (code == "0009") escape = "\\t";
        text.replace(at, kMarkBytes, escape);
        at += escape.size();
    }
    return text;
}

// The end of a text, in quotes.
std::string last_read(const std::string& text) {
    if (text.size() <= kLongestShown) return "'" + with_escapes(text) + "'";
    std::size_t start = text.size() - kLongestShown;
    while (start < text.size() && continues_character(text[start])) ++start;
    return "'..." + with_escapes(text.substr(start)) + "'";
}

/// The library's reason without its number and place, and what it read.
std::string library_reason(const std::string& message) {
    std::string text = message;
    if (const auto number = text.find("] "); number != std::string::npos) {
        text = text.substr(number + 2);
    }
    for (const char* before : {": ", " - "}) {
        if (!text.starts_with("parse error") && !text.starts_with("syntax error")) break;
        if (const auto at = text.find(before); at != std::string::npos) {
            text = text.substr(at + std::strlen(before));
        }
    }
    return with_escapes(text.substr(0, text.find("; last read: ")));
}

// "expected ',' or ']'", from the end of the library's message.
std::string expectation(const std::string& message) {
    if (message.find("invalid number") != std::string::npos) return "expected a number";
    const std::size_t at = message.rfind("; expected ");
    if (at == std::string::npos) return "";
    const std::string text = message.substr(at + 2);
    if (text == "expected string literal") return "expected a key between double quotes";
    return text == "expected end of input" ? "expected the end of the text" : text;
}

// Where the number, word or string begins that ends at a place.
std::size_t token_start(std::string_view text, std::size_t end) {
    const auto is_part = [&](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '+' || c == '-';
    };
    std::size_t start = end;
    if (text[end] == '"') {
        const auto is_escaped = [&](std::size_t at) {
            std::size_t first = at;
            while (first > 0 && text[first - 1] == '\\') --first;
            return (at - first) % 2 == 1;
        };
        do {
            start = start == 0 ? 0 : text.rfind('"', start - 1);
        } while (start != std::string_view::npos && start > 0 && is_escaped(start));
        return start == std::string_view::npos ? end : start;
    }
    if (is_part(text[end])) {
        while (start > 0 && is_part(text[start - 1])) --start;
    }
    return start;
}

// The word, or else the character, that begins at a place.
std::string word_at(std::string_view text, std::size_t begin) {
    std::size_t end = begin + (text[begin] == '-' ? 1 : 0);
    while (end < text.size() && end - begin < kLongestShown &&
           (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '_')) {
        ++end;
    }
    if (end == begin) end = character_at(text, begin).second;
    return std::string(text.substr(begin, end - begin));
}

char last_before(std::string_view text, std::size_t byte) {
    const std::size_t at = text.substr(0, byte).find_last_not_of(" \t\r\n");
    return at == std::string_view::npos ? '\0' : text[at];
}

bool is_utf16(std::string_view text) {
    return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
           (text.size() > 1 && (text[0] == '\0') != (text[1] == '\0'));
}

// How JSON writes what was probably meant by what begins at a place outside strings; empty when
// that is not clear.
std::string hint_at(std::string_view text, std::size_t begin) {
    constexpr std::array<std::string_view, 10> kOtherQuotes{
        "'", "`", "“", "”", "„", "‘", "’", "«", "»", "‚"};
    const std::string word = word_at(text, begin);
    if (std::ranges::find(kOtherQuotes, word) != kOtherQuotes.end()) {
        return "texts stand between straight double quotes, \"";
    }
    if (word == "/" || word == "#") return "JSON has no comments";
    if ((word == "]" || word == "}") && last_before(text, begin) == ',') {
        return "the last item has no comma behind it";
    }
    const std::string lower = lower_case(word);
    if (lower == "nan" || lower == "inf" || lower == "infinity" || lower == "-inf" ||
        lower == "-infinity") {
        return "JSON has no numbers but finite ones, and null";
    }
    const bool is_literal = word == "true" || word == "false" || word == "null";
    if (!is_literal &&
        (lower == "true" || lower == "false" || lower == "none" || lower == "null")) {
        return "JSON writes true, false and null";
    }
    if (word == "+" || word == ".") return "numbers begin with a digit or a minus";
    const std::string_view before = text.substr(0, begin);
    const bool begins_item = word == "\"" || word == "{" || word == "[" || is_literal ||
                             std::isdigit(static_cast<unsigned char>(word[0])) != 0;
    const char last = last_before(before, begin);
    if (begins_item && last != ',' && last != ':' && last != '[' && last != '{' && last != '\0') {
        return "a comma or colon is missing before it";
    }
    return "";
}

/// Where in a text and why it is no JSON, for people: the line and column in characters, and for
/// the usual mistakes (a comma too many, curly quotes, comments, NaN, another encoding) what was
/// found and how JSON writes it.
///
/// text       the whole text
/// position   bytes that the parser had read when it gave up
/// token      what it read last, as its message shows it
/// message    of the library
std::string json_error_text(std::string_view text,
                            std::size_t position,
                            const std::string& token,
                            const std::string& message) {
    if (message.find("parse error at") == std::string::npos) return library_reason(message);
    if (is_utf16(text)) return "its text is UTF-16; must be UTF-8";
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) return "it is empty";
    const bool in_string = message.find("invalid string") != std::string::npos;
    if (position > text.size()) {
        return in_string ? "it ends before a quote is closed; last read: " + last_read(token)
                         : "it ends before all brackets are closed";
    }
    const std::size_t last = position == 0 ? 0 : position - 1;
    const auto [begin, end] = character_at(text, last);
    if (in_string) {
        if (text[last] == '\n') {
            return position_text(text, last) + ": a line ends before its quote is closed";
        }
        // The library stops within a character of several bytes.
        return position_text(text, begin) + ": " +
               library_reason(message + std::string(text.substr(last + 1, end - last - 1)));
    }
    // A word that is none of JSON's is over where the library stops: at a bracket or a comma.
    const bool ends_word =
        message.find("invalid literal") != std::string::npos &&
        std::string_view(",]} \t\r\n").find(text[begin]) != std::string_view::npos;
    const std::size_t start = token_start(text, ends_word && begin > 0 ? begin - 1 : begin);
    std::string reason = hint_at(text, start);
    if (reason.empty()) reason = expectation(message);
    return fmt::format("{}: found '{}'{}{}",
                       position_text(text, start),
                       word_at(text, start),
                       reason.empty() ? "" : "; ",
                       reason);
}

constexpr std::size_t kDeepestNesting = 100;

/// Builds the value that a text describes, in time proportional to its length, and throws Error for
/// what it may not hold: nesting without end, and keys that come twice. (The library's own parser
/// looks every key up among those before it, and with a callback every item of a list.)
class JsonBuilder : public nlohmann::json_sax<Json> {
 public:
    JsonBuilder(std::string_view text, const std::string& where) : text_(text), where_(where) {}

    Json take() { return std::move(root_); }

    bool null() override { return add(nullptr); }
    bool boolean(bool value) override { return add(value); }
    bool number_integer(number_integer_t value) override { return add(value); }
    bool number_unsigned(number_unsigned_t value) override { return add(value); }
    bool number_float(number_float_t value, const string_t&) override { return add(value); }
    bool string(string_t& value) override { return add(std::move(value)); }
    bool binary(binary_t& value) override { return add(std::move(value)); }

    bool start_object(std::size_t) override { return open(Json::object()); }
    bool start_array(std::size_t) override { return open(Json::array()); }
    bool end_object() override { return close(); }
    bool end_array() override { return close(); }

    bool key(string_t& key) override {
        if (!open_.back().keys.insert(key).second) {
            throw Error(where_, "its JSON has the key '" + key + "' twice", "must have it once");
        }
        key_ = std::move(key);
        return true;
    }

    bool parse_error(std::size_t position,
                     const std::string& token,
                     const Json::exception& error) override {
        throw Error(
            where_,
            "is not valid JSON (" + json_error_text(text_, position, token, error.what()) + ")",
            "must be JSON");
    }

 private:
    /// A list or object whose end has not come yet.
    struct Open {
        Json* value = nullptr;
        std::unordered_set<std::string> keys{};
    };

    bool add(Json value) {
        place(std::move(value));
        return true;
    }

    bool open(Json value) {
        if (open_.size() >= kDeepestNesting) {
            throw Error(where_,
                        "its JSON is nested deeper than " + std::to_string(kDeepestNesting),
                        "must be nested less");
        }
        open_.push_back({&place(std::move(value))});
        return true;
    }

    bool close() {
        open_.pop_back();
        return true;
    }

    /// Puts a value where it belongs; that place lasts until the list or object around it goes on.
    Json& place(Json value) {
        if (open_.empty()) return root_ = std::move(value);
        Json& outer = *open_.back().value;
        if (outer.is_array()) {
            outer.push_back(std::move(value));
            return outer.back();
        }
        auto& members = outer.get_ref<Json::object_t&>();
        members.emplace_back(std::move(key_), std::move(value));
        return members.back().second;
    }

    std::string_view text_;
    const std::string& where_;
    Json root_;
    std::vector<Open> open_;
    std::string key_;
};

}  // namespace

Json parse_json(std::string_view text, const std::string& where) {
    JsonBuilder builder(text, where);
    Json::sax_parse(text, &builder);
    return builder.take();
}

std::optional<Json> json_if_valid(std::string_view text) {
    try {
        return parse_json(text, "");
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json read_json_file(const std::string& path) {
    return parse_json(MappedFile(path, "must be a readable JSON file").bytes(), path);
}

}  // namespace core
