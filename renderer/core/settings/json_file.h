// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace core {

/// Parses JSON text, which may come from anywhere.
///
/// where    names the text in messages
/// throws   Error when it is not JSON, is nested deeper than 100, or has a key twice in an object
Json parse_json(std::string_view text, const std::string& where);

/// The same; nothing when the text is no such JSON.
std::optional<Json> json_if_valid(std::string_view text);

/// JSON as files of ours hold it, indented, with U+FFFD for what is no UTF-8, as names of files may
/// be.
std::string json_text(const Json& json);

/// Reads a whole JSON file. Throws Error when it is missing or parse_json() refuses it.
Json read_json_file(const std::string& path);

}  // namespace core
