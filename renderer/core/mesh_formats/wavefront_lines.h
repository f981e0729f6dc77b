// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace core {

/// A line of a Wavefront file: a keyword and what belongs to it.
struct WavefrontLine {
    std::string_view keyword;
    std::string_view rest;
    std::size_t number = 0;  ///< in the file, from 1

    std::string where() const { return "line " + std::to_string(number); }

    /// The rest as a name, which may hold spaces; a comment begins with a # that stands alone.
    std::string_view name() const;
};

/// Hands out the lines of a Wavefront file but for empty ones and comments. A \ at the end of a
/// line goes on in the next.
class WavefrontLines {
 public:
    explicit WavefrontLines(std::string_view text) : rest_(text) {}

    /// The next line, valid until the one after it is asked for; nothing at the end.
    std::optional<WavefrontLine> next();

 private:
    std::string_view rest_;
    std::string joined_;
    std::size_t number_ = 0;
};

}  // namespace core
