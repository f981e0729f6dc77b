// SPDX-License-Identifier: MIT
#include "renderer/core/one_line.h"

#include "renderer/core/settings.h"

#include <algorithm>

namespace core {

std::string one_line(const std::string& text) {
    const std::string json = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string line = Json::parse(json).get<std::string>();
    constexpr char kDelete = 127;
    std::replace_if(
        line.begin(), line.end(), [](unsigned char c) { return c < ' ' || c == kDelete; }, ' ');
    return line;
}

}  // namespace core
