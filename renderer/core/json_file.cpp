// SPDX-License-Identifier: MIT
#include "renderer/core/json_error.h"
#include "renderer/core/mapped_file.h"
#include "renderer/core/settings.h"

#include <unordered_set>

namespace core {
namespace {

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
