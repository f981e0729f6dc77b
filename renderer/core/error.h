// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace core {

/// Wrong input, file or setting: the caller can mend it. Programs exit with status 2.
///
/// what() is one line: `where: what was found; what is allowed`.
class Error : public std::runtime_error {
 public:
    Error(const std::string& where, const std::string& found, const std::string& allowed)
        : std::runtime_error(where + ": " + found + "; " + allowed) {}
};

/// The input is fine and the work still cannot be done (too little memory, disk full, interrupted).
/// Programs exit with status 1. what() is one line: `where: reason`.
class Failure : public std::runtime_error {
 public:
    Failure(const std::string& where, const std::string& reason)
        : std::runtime_error(where + ": " + reason) {}
};

}  // namespace core
