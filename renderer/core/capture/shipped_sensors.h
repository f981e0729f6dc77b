// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace core {

/// Name and text of data/sensors/*.json, which are compiled into the program.
const std::vector<std::pair<std::string_view, std::string_view>>& shipped_sensor_texts();

}  // namespace core
