// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace core {

/// Where in a text and why it is no JSON, for people: the line and column in characters, and for
/// the usual slips (a comma too many, curly quotes, comments, NaN, another encoding) what was found
/// and how JSON writes it.
///
/// text       the whole text
/// position   bytes that the parser had read when it gave up
/// token      what it read last, as its message shows it
/// message    of the library
std::string json_error_text(std::string_view text,
                            std::size_t position,
                            const std::string& token,
                            const std::string& message);

}  // namespace core
