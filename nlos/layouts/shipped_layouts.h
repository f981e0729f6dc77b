// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace nlos {

/// Name and text of data/layouts/*.json, which are compiled into the program.
const std::vector<std::pair<std::string_view, std::string_view>>& shipped_layout_texts();

}  // namespace nlos
