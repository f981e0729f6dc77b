// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/file_words.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace core {
namespace {

constexpr auto is_space = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };

}  // namespace

std::string_view take_word(std::string_view& text) {
    const char* const end = text.data() + text.size();
    const char* const begin = std::find_if_not(text.data(), end, is_space);
    const char* const after = std::find_if(begin, end, is_space);
    text = {after, end};
    return {begin, after};
}

std::string_view take_line(std::string_view& text) {
    const char* const end = text.data() + text.size();
    const auto is_end = [](char c) { return c == '\n' || c == '\r'; };
    const char* const after = std::find_if(text.data(), end, is_end);
    const std::string_view line(text.data(), after);
    text = {after, end};
    text.remove_prefix(text.starts_with("\r\n") ? 2 : std::min<std::size_t>(1, text.size()));
    return line;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

std::optional<double> number_of(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument) return {};
    if (error == std::errc::result_out_of_range) {
        const bool is_tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
        return is_tiny ? 0.0 : std::numeric_limits<double>::infinity();
    }
    return value;
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t kLongest = 40;
    return "'" + std::string(text.substr(0, kLongest)) + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace core
