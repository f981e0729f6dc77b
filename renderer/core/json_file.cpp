// SPDX-License-Identifier: MIT
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings.h"

#include <unordered_set>

namespace core {
namespace {

constexpr std::size_t kDeepestNesting = 100;

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

/// Builds the value that a text describes, in time proportional to its length, and throws Error for
/// what it may not hold: nesting without end, and keys that come twice. (The library's own parser
/// looks every key up among those before it, and with a callback every item of a list.)
class JsonBuilder : public nlohmann::json_sax<Json> {
 public:
    explicit JsonBuilder(const std::string& where) : where_(where) {}

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

    bool parse_error(std::size_t, const std::string&, const Json::exception& error) override {
        throw Error(where_, "is not valid JSON (" + shorten(error.what()) + ")", "must be JSON");
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

    const std::string& where_;
    Json root_;
    std::vector<Open> open_;
    std::string key_;
};

}  // namespace

Json parse_json(std::string_view text, const std::string& where) {
    JsonBuilder builder(where);
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
