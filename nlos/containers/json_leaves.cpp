// SPDX-License-Identifier: MIT
#include "nlos/containers/json_leaves.h"

#include <algorithm>
#include <limits>

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

/// The member of an object; null when there is none. It is looked for at `place` first, as objects
/// of one kind have their keys in the same order.
const Json* find(const Json& object, const std::string& key, std::size_t place) {
    const auto& members = object.get_ref<const Json::object_t&>();
    const auto guess =
        members.begin() + static_cast<std::ptrdiff_t>(std::min(place, members.size()));
    if (guess != members.end() && guess->first == key) return &guess->second;
    const auto found = members.find(key);
    return found == members.end() ? nullptr : &found->second;
}

/// All keys of some objects.
std::vector<std::string> keys_of(const std::vector<const Json*>& objects) {
    std::vector<std::string> keys;
    for (const Json* object : objects) {
        std::size_t k = 0;
        for (const auto& [key, value] : object->get_ref<const Json::object_t&>()) {
            const bool is_known =
                (k < keys.size() && keys[k] == key) || std::ranges::find(keys, key) != keys.end();
            if (!is_known) keys.push_back(key);
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
        if (stack.shape.empty()) return add_text(name, first.get<std::string>());
        add_text_list(name, stack.shape);
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
    for (std::size_t k = 0; k < keys.size() && !is_full(); ++k) {
        Stack members{stack.shape, {}};
        for (const Json* value : stack.values) members.values.push_back(find(*value, keys[k], k));
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
