// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <concepts>
#include <string>
#include <string_view>
#include <utility>

namespace apps {

/// What may be shown of a part of a message: of texts, which may come from anywhere, what is
/// printable.
template <class T>
decltype(auto) shown(const T& part) {
    if constexpr (std::convertible_to<const T&, std::string_view>) {
        return core::printable(part);
    } else {
        return part;
    }
}

/// A message of printable parts.
template <class... Parts>
std::string message(fmt::format_string<Parts...> format, Parts&&... parts) {
    return [&](const auto&... texts) {
        return fmt::vformat(format, fmt::make_format_args(texts...));
    }(shown(parts)...);
}

/// Writes to standard output as it is. Throws core::Failure when that is closed or full.
void write_output(std::string_view text);

/// The same, of what --quiet leaves out.
void write_message(std::string_view text);

/// Throws core::Failure unless all that was written has reached standard output.
void flush_output();

/// Prints a message to standard output, unless --quiet leaves it out. Throws core::Failure when
/// that is closed or full.
template <class... Parts>
void print(fmt::format_string<Parts...> format, Parts&&... parts) {
    write_message(message(format, std::forward<Parts>(parts)...));
}

/// Prints a message to standard error, where there is one.
void write_error(std::string_view text) noexcept;
template <class... Parts>
void print_error(fmt::format_string<Parts...> format, Parts&&... parts) {
    write_error(message(format, std::forward<Parts>(parts)...));
}

/// What is printed beside results, as --quiet and --json ask for it.
struct OutputSettings {
    bool quiet = false;  ///< warnings and errors alone
    bool json = false;   ///< the last line of standard output is an object, see apps/outcome.h
};
OutputSettings& output_settings();

/// Whether standard error is a terminal that lines may be drawn on again and again: not where
/// NO_COLOR is set or TERM is dumb.
bool can_redraw_lines();

/// Ends a line that is drawn again and again, so that a message can follow.
void clear_drawn_line() noexcept;
/// Draws such a line in place of the one before.
void draw_line(std::string_view text) noexcept;

/// Work that can stop early. While it lives, the first Ctrl-C or SIGTERM asks it to, and answers at
/// once; see handle_signals().
class StoppableWork {
 public:
    /// answer   one sentence: what happens now, and what a second Ctrl-C does
    explicit StoppableWork(const std::string& answer);
    ~StoppableWork();
    StoppableWork(const StoppableWork&) = delete;
    StoppableWork& operator=(const StoppableWork&) = delete;

 private:
    std::string line_;
    const char* outer_;  ///< the answer of the work around this
};

/// Decides what signals do from now on. Ctrl-C and SIGTERM ask a StoppableWork to stop; the second
/// of them, or without such work the first, ends the program with one line and status 1 and leaves
/// no partial file. Writing to a closed pipe or beyond a limit of file sizes fails like any other
/// writing.
void handle_signals();
bool interrupt_requested();

}  // namespace apps
