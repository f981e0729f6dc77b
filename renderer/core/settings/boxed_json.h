// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"

#include <memory>

namespace core {

/// A JSON value, an empty object by default, behind a pointer: headers that hold one need not
/// include the library. Copies are deep, as of the value itself.
class BoxedJson {
 public:
    BoxedJson();
    BoxedJson(Json value);  // NOLINT(google-explicit-constructor): stands for the value
    BoxedJson(const BoxedJson& other);
    BoxedJson(BoxedJson&& other) noexcept;
    BoxedJson& operator=(BoxedJson other) noexcept;
    ~BoxedJson();

    Json& operator*() { return *value_; }
    const Json& operator*() const { return *value_; }
    Json* operator->() { return value_.get(); }
    const Json* operator->() const { return value_.get(); }
    Json& operator[](const char* key);

 private:
    std::unique_ptr<Json> value_;
};

}  // namespace core
