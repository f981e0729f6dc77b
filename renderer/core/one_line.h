// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace core {

/// A text from a file of others as a part of one line: valid UTF-8, in which control characters are
/// blanks and damaged bytes U+FFFD.
std::string one_line(const std::string& text);

}  // namespace core
