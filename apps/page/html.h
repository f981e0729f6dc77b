// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace apps {

/// The text with the characters that mean something in HTML replaced, for content and attributes.
/// Control characters and what is no UTF-8, as file names may have them, become `\x1b`, `\xff`.
std::string escape_html(std::string_view text);

/// Bytes as base64 text with padding (RFC 4648).
std::string encode_base64(std::string_view bytes);

/// A picture with words under it; both are HTML.
std::string figure_html(const std::string& image, const std::string& caption);

/// Names and what they stand for, as a list.
std::string facts_html(const std::vector<std::pair<std::string, std::string>>& facts);

}  // namespace apps
