// SPDX-License-Identifier: MIT
#include "apps/page/html.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace apps {
namespace {

/// Text as core::printable() has it, on as many lines as before.
std::string printable_lines(std::string_view text) {
    std::string lines;
    for (std::size_t end = text.find('\n'); end != std::string_view::npos; end = text.find('\n')) {
        lines += core::printable(text.substr(0, end)) + '\n';
        text.remove_prefix(end + 1);
    }
    return lines + core::printable(text);
}

}  // namespace

std::string escape_html(std::string_view text) {
    constexpr std::array<std::pair<char, const char*>, 5> kEntities{
        {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}}};
    std::string escaped;
    escaped.reserve(text.size());
    for (const char c : printable_lines(text)) {
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
