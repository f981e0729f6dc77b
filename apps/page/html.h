// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace apps {

/// The text with the characters that mean something in HTML replaced, for content and attributes.
std::string escape_html(std::string_view text);

/// Bytes as base64 text with padding (RFC 4648).
std::string encode_base64(std::string_view bytes);

/// An <img> that carries its own bytes; a PNG is shown at half its pixels, sharp on dense screens.
///
/// bytes       the picture file
/// mime_type   such as image/png
/// alternative what the picture shows, in words
std::string embedded_image(std::string_view bytes,
                           std::string_view mime_type,
                           std::string_view alternative);

/// A picture with words under it; both are HTML.
std::string figure_html(const std::string& image, const std::string& caption);

/// Names and what they stand for, as a list.
std::string facts_html(const std::vector<std::pair<std::string, std::string>>& facts);

}  // namespace apps
