// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace core {

/// Takes the next word off a text, up to white space; empty at its end.
std::string_view take_word(std::string_view& text);

/// Takes the next line off a text, without its end (LF, CR LF or CR).
std::string_view take_line(std::string_view& text);

/// A text without white space at both ends.
std::string_view trimmed(std::string_view text);

/// The number that a word is ("-.5", "+1.", "2e3", "inf", "nan"; beyond the range of doubles it is
/// infinite or 0); nothing when the word is no number or more than one.
std::optional<double> number_of(std::string_view word);

/// A part of a damaged file as messages show it: quoted and not too long.
std::string excerpt(std::string_view text);

}  // namespace core
