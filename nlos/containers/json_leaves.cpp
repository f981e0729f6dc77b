// SPDX-License-Identifier: MIT
#include "nlos/containers/json_leaves.h"

#include "renderer/core/settings/json_file.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace nlos {
namespace {

using core::Json;

constexpr const char* kNameOfRoot = "array";

bool is_number_or_missing(const Json* value) {
    return value->is_number() || value->is_boolean() || value->is_null();
}

double to_double(const Json* value) {
    if (value->is_null()) return std::numeric_limits<double>::quiet_NaN();
    return value->is_boolean() ? (value->get<bool>() ? 1.0 : 0.0) : value->get<double>();
}

std::string join_path(const std::string& path, const std::string& key) {
    return path.empty() ? key : path + "." + key;
}

/// "path.1.0" for the fourth of a stack of shape (2, 3).
std::string indexed_path(const std::string& path, const Shape& shape, std::size_t index) {
    std::string indices;
    for (std::size_t axis = shape.size(); axis-- > 0; index /= shape[axis]) {
        indices = std::to_string(index % shape[axis]) + (indices.empty() ? "" : "." + indices);
    }
    return join_path(path, indices);
}

/// Finds members of an object. They are looked for at their place first, as objects of one kind
/// have their keys in the same order; where that fails, an index is made of larger objects.
class Members {
 public:
    explicit Members(const Json& object) : members_(object.get_ref<const Json::object_t&>()) {}

    /// The member `key`, or null when there is none; `hint` is where it may be.
    const Json* find(const std::string& key, std::size_t hint) {
        const auto guess =
            members_.begin() + static_cast<std::ptrdiff_t>(std::min(hint, members_.size()));
        if (guess != members_.end() && guess->first == key) return &guess->second;
        constexpr std::size_t kFew = 16;
        if (members_.size() <= kFew) {
            const auto found = members_.find(key);
            return found == members_.end() ? nullptr : &found->second;
        }
        if (!index_) {
            index_ = std::make_unique<Index>();
            for (const auto& [name, value] : members_) index_->emplace(name, &value);
        }
        const auto found = index_->find(key);
        return found == index_->end() ? nullptr : found->second;
    }

 private:
    using Index = std::unordered_map<std::string_view, const Json*>;

    const Json::object_t& members_;
    std::unique_ptr<Index> index_;
};

/// All keys of some objects.
std::vector<std::string> keys_of(const std::vector<const Json*>& objects) {
    std::vector<std::string> keys;
    std::unordered_set<std::string_view> known;
    for (const Json* object : objects) {
        std::size_t k = 0;
        for (const auto& [key, value] : object->get_ref<const Json::object_t&>()) {
            const bool is_known = k < keys.size() && keys[k] == key;
            if (!is_known && known.insert(key).second) keys.push_back(key);
            ++k;
        }
    }
    return keys;
}

}  // namespace

void JsonLeaves::add_leaves(const std::string& path, const Json& value) {
    add_stack(path, {{}, {&value}});
}

void JsonLeaves::add_stack(const std::string& path, const Stack& stack) {
    if (is_full() || stack.values.empty()) return;
    const auto all = [&](auto is) { return std::ranges::all_of(stack.values, is); };
    const Json& first = *stack.values.front();
    if (all(is_number_or_missing)) {
        if (!all([](const Json* value) { return value->is_null(); })) add_numbers(path, stack);
    } else if (all([](const Json* value) { return value->is_string(); })) {
        const std::string name = path.empty() ? kNameOfRoot : path;
        const bool is_one = stack.shape.empty();
        add_text(
            name, stack.shape, is_one ? std::optional(first.get<std::string>()) : std::nullopt);
    } else if (all([](const Json* value) { return value->is_object(); })) {
        add_members(path, stack);
    } else if (all([&](const Json* value) {
                   return value->is_array() && value->size() == first.size();
               })) {
        Stack inner{stack.shape, {}};
        inner.shape.push_back(first.size());
        for (const Json* value : stack.values) {
            for (const Json& item : *value) inner.values.push_back(&item);
        }
        add_stack(path, inner);
    } else {
        add_by_index(path, stack);
    }
}

/// Each key that all objects have is a stack of its own; others are named by index.
void JsonLeaves::add_members(const std::string& path, const Stack& stack) {
    const std::vector<std::string> keys = keys_of(stack.values);
    std::vector<Members> objects;
    for (const Json* value : stack.values) objects.emplace_back(*value);
    for (std::size_t k = 0; k < keys.size() && !is_full(); ++k) {
        Stack members{stack.shape, {}};
        for (Members& object : objects) members.values.push_back(object.find(keys[k], k));
        if (std::ranges::find(members.values, nullptr) == members.values.end()) {
            add_stack(join_path(path, keys[k]), members);
            continue;
        }
        for (std::size_t i = 0; i < stack.values.size() && !is_full(); ++i) {
            if (members.values[i] == nullptr) continue;
            add_leaves(join_path(indexed_path(path, stack.shape, i), keys[k]), *members.values[i]);
        }
    }
}

void JsonLeaves::add_numbers(const std::string& path, const Stack& stack) {
    const auto all = [&](auto is) { return std::ranges::all_of(stack.values, is); };
    std::vector<double> values(stack.values.size());
    std::ranges::transform(stack.values, values.begin(), to_double);
    const bool are_bool = all([](const Json* value) { return value->is_boolean(); });
    const bool are_whole =
        are_bool || all([](const Json* value) { return value->is_number_integer(); });
    add_values(path.empty() ? kNameOfRoot : path,
               stack.shape,
               std::move(values),
               are_whole ? ElementKind::Integer : ElementKind::Real,
               are_bool    ? "bool"
               : are_whole ? "integer"
                           : "number");
}

void JsonLeaves::add_by_index(const std::string& path, const Stack& stack) {
    for (std::size_t i = 0; i < stack.values.size() && !is_full(); ++i) {
        add_leaves(indexed_path(path, stack.shape, i), *stack.values[i]);
    }
}

}  // namespace nlos
