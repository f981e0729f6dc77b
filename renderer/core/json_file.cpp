// SPDX-License-Identifier: MIT
#include "renderer/core/settings.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <unordered_set>

namespace core {
namespace {

constexpr int kDeepestNesting = 100;
constexpr std::size_t kMostKeys = 10'000;  // of one object: looking a key up takes as many steps

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

/// The library's message without its number; what it read last is cut to its end.
std::string shorten(const std::string& message) {
    constexpr std::string_view kRead = "last read: '";
    constexpr std::size_t kLongestRead = 40;
    const std::size_t start = message.find("] ");
    std::string text =
        with_escapes(start == std::string::npos ? message : message.substr(start + 2));
    const std::size_t read = text.find(kRead);
    if (read == std::string::npos || text.size() < read + kRead.size() + kLongestRead) return text;
    return text.substr(0, read + kRead.size()) + "..." + text.substr(text.size() - kLongestRead);
}

/// What parsing may not find: nesting without end, and keys that come twice.
class Limits {
 public:
    explicit Limits(const std::string& where) : where_(where) {}

    bool operator()(int depth, Json::parse_event_t event, const Json& value) {
        if (depth > kDeepestNesting) {
            throw Error(where_,
                        "its JSON is nested deeper than " + std::to_string(kDeepestNesting),
                        "must be nested less");
        }
        if (event == Json::parse_event_t::object_start) keys_.emplace_back();
        if (event == Json::parse_event_t::object_end) keys_.pop_back();
        if (event == Json::parse_event_t::key) take_key(value.get_ref<const std::string&>());
        return true;
    }

 private:
    void take_key(const std::string& key) {
        if (!keys_.back().insert(key).second) {
            throw Error(where_, "its JSON has the key '" + key + "' twice", "must have it once");
        }
        if (keys_.back().size() > kMostKeys) {
            throw Error(
                where_,
                "its JSON has more than " + std::to_string(kMostKeys) + " keys in an object",
                "must have fewer");
        }
    }

    const std::string& where_;
    std::vector<std::unordered_set<std::string>> keys_;  ///< of the objects that are open
};

}  // namespace

Json parse_json(std::string_view text, const std::string& where) {
    try {
        return Json::parse(text, Limits(where));
    } catch (const Json::exception& error) {
        throw Error(where, "is not valid JSON (" + shorten(error.what()) + ")", "must be JSON");
    }
}

std::optional<Json> json_if_valid(std::string_view text) {
    try {
        return parse_json(text, "");
    } catch (const Error&) {
        return std::nullopt;
    }
}

Json read_json_file(const std::string& path) {
    constexpr const char* kAllowed = "must be a readable JSON file";
    if (std::filesystem::is_directory(path)) throw Error(path, "is a folder", kAllowed);
    if (std::filesystem::exists(path) && !std::filesystem::is_regular_file(path)) {
        throw Error(path, "is no regular file", kAllowed);
    }
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error(path, "cannot be opened", kAllowed);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    return parse_json(text, path);
}

}  // namespace core
