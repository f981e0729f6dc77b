// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/error.h"
#include "renderer/core/progress.h"

#include <fmt/core.h>

#include <chrono>
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

/// Throws core::Failure unless all that was written has reached standard output.
void flush_output();

/// Prints a message to standard output. Throws core::Failure when that is closed or full.
template <class... Parts>
void print(fmt::format_string<Parts...> format, Parts&&... parts) {
    write_output(message(format, std::forward<Parts>(parts)...));
}

/// Prints a message to standard error, where there is one.
void write_error(std::string_view text) noexcept;
template <class... Parts>
void print_error(fmt::format_string<Parts...> format, Parts&&... parts) {
    write_error(message(format, std::forward<Parts>(parts)...));
}

/// Shows the progress of one job on standard error: a bar with rate and time left on a terminal,
/// one line per 10 % otherwise. Jobs under a second stay silent. While it lives, Ctrl-C and SIGTERM
/// ask the job to stop, see handle_signals().
class ProgressBar {
 public:
    explicit ProgressBar(std::string title);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Reports here; stops when Ctrl-C was pressed or SIGTERM came.
    core::Progress progress();

 private:
    void show(double share, const std::string& detail);

    std::string title_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point last_shown_;
    bool is_terminal_;
    int last_tenth_ = 0;
};

/// Decides what signals do from now on. Ctrl-C and SIGTERM ask the job of a ProgressBar to stop;
/// the second of them, or without such a job the first, ends the program with one line and status 1
/// and leaves no partial file. Writing to a closed pipe or beyond a limit of file sizes fails
/// like any other writing.
void handle_signals();
bool interrupt_requested();

}  // namespace apps
