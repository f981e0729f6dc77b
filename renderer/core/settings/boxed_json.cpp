// SPDX-License-Identifier: MIT
#include "renderer/core/settings/boxed_json.h"

#include <nlohmann/json.hpp>

#include <utility>

namespace core {

BoxedJson::BoxedJson() : BoxedJson(Json::object()) {}
BoxedJson::BoxedJson(Json value) : value_(std::make_unique<Json>(std::move(value))) {}
BoxedJson::BoxedJson(const BoxedJson& other) : BoxedJson(*other) {}
BoxedJson::BoxedJson(BoxedJson&& other) noexcept = default;
BoxedJson& BoxedJson::operator=(BoxedJson other) noexcept {
    value_.swap(other.value_);
    return *this;
}
BoxedJson::~BoxedJson() = default;

Json& BoxedJson::operator[](const char* key) {
    return (*value_)[key];
}

}  // namespace core
