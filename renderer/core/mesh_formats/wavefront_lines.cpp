// SPDX-License-Identifier: MIT
#include "renderer/core/mesh_formats/wavefront_lines.h"

#include "renderer/core/mesh_formats/file_words.h"

#include <algorithm>

namespace core {

std::string_view WavefrontLine::name() const {
    std::string_view text = rest;
    while (true) {
        const std::string_view word = take_word(text);
        if (word == "#") return trimmed({rest.data(), word.data()});
        if (word.empty()) return trimmed(rest);
    }
}

std::optional<WavefrontLine> WavefrontLines::next() {
    while (!rest_.empty()) {
        std::string_view line = take_line(rest_);
        ++number_;
        if (line.ends_with('\\')) {
            joined_.clear();
            for (; line.ends_with('\\'); line = take_line(rest_), ++number_) {
                joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
            }
            line = joined_.append(line);
        }
        const std::string_view keyword = take_word(line);
        if (keyword.empty() || keyword.starts_with('#')) continue;
        return WavefrontLine{keyword, line, number_};
    }
    return std::nullopt;
}

}  // namespace core
