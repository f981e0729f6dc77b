// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace core {

/// Text on one line that any terminal shows: characters of UTF-8 stay, control characters and bytes
/// that are no UTF-8 are escaped (`\n`, `\x1b`).
std::string printable(std::string_view text);

/// Wrong input, file or setting: the caller can mend it. Programs exit with status 2.
///
/// what() is one printable line: `where: what was found; what is allowed`.
class Error : public std::runtime_error {
 public:
    Error(const std::string& where, const std::string& found, const std::string& allowed)
        : std::runtime_error(printable(where + ": " + found + "; " + allowed)),
          where_(printable(where)),
          found_(printable(found)),
          allowed_(printable(allowed)) {}

    const std::string& where() const { return where_; }
    const std::string& found() const { return found_; }
    const std::string& allowed() const { return allowed_; }

 private:
    std::string where_;
    std::string found_;
    std::string allowed_;
};

/// The input is fine and the work still cannot be done (too little memory, disk full, interrupted).
/// Programs exit with status 1. what() is one printable line: `where: reason`.
class Failure : public std::runtime_error {
 public:
    Failure(const std::string& where, const std::string& reason)
        : std::runtime_error(printable(where + ": " + reason)) {}
};

}  // namespace core
