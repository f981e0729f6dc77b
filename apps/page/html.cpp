// SPDX-License-Identifier: MIT
#include "apps/page/html.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace apps {
namespace {

// Pictures of results have two pixels for each one on an ordinary screen.
constexpr int kPixelDensity = 2;
constexpr int kNarrowest = 560;  // smaller pictures of others are shown as large as they are

/// The width that a PNG file gives: bytes 16 to 19, the highest first; nothing for other files.
std::optional<int> png_width(std::string_view bytes) {
    if (bytes.size() < 24 || !bytes.starts_with("\x89PNG\r\n\x1a\n")) return std::nullopt;
    int width = 0;
    for (std::size_t i = 16; i < 20; ++i)
        width = width * 256 + static_cast<unsigned char>(bytes[i]);
    return width;
}

}  // namespace

std::string escape_html(std::string_view text) {
    constexpr std::array<std::pair<char, const char*>, 5> kEntities{
        {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}}};
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : text) {
        const auto* special =
            std::ranges::find(kEntities, c, &decltype(kEntities)::value_type::first);
        escaped += special == kEntities.end() ? std::string_view(&c, 1) : special->second;
    }
    return escaped;
}

std::string encode_base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t triple = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            triple <<= 8;
            if (i + k < bytes.size()) triple |= static_cast<unsigned char>(bytes[i + k]);
        }
        const std::size_t present = std::min<std::size_t>(3, bytes.size() - i);
        for (std::size_t k = 0; k < 4; ++k) {
            text += k <= present ? kDigits[(triple >> (18 - 6 * k)) & 63U] : '=';
        }
    }
    return text;
}

std::string embedded_image(std::string_view bytes,
                           std::string_view mime_type,
                           std::string_view alternative) {
    std::string width;
    if (const std::optional<int> pixels = png_width(bytes)) {
        const int shown = std::max(*pixels / kPixelDensity, std::min(*pixels, kNarrowest));
        width = fmt::format(" width=\"{}\"", shown);
    }
    return fmt::format("<img src=\"data:{};base64,{}\"{} alt=\"{}\">",
                       mime_type,
                       encode_base64(bytes),
                       width,
                       escape_html(alternative));
}

std::string figure_html(const std::string& image, const std::string& caption) {
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", image, caption);
}

std::string facts_html(const std::vector<std::pair<std::string, std::string>>& facts) {
    std::string html = "<dl>";
    for (const auto& [name, value] : facts) {
        html +=
            fmt::format("<div><dt>{}</dt><dd>{}</dd></div>", escape_html(name), escape_html(value));
    }
    return html + "</dl>\n";
}

}  // namespace apps
