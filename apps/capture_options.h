// SPDX-License-Identifier: MIT
#pragma once

#include "apps/arguments.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace apps {

/// What `--set` reaches of commands that do no more with a capture than read it.
struct CaptureOptions {
    nlos::CaptureReadSettings capture;
};

template <class Visitor>
void for_each_field(CaptureOptions& options, Visitor&& visit) {
    visit("capture", options.capture, "what the capture file leaves open");
}

/// What `--set` reaches of commands that have settings of their own beside these.
template <core::SettingsStruct S>
struct WithCapture {
    S settings;
    nlos::CaptureReadSettings capture;
};
template <class S, class Visitor>
void for_each_field(WithCapture<S>& options, Visitor&& visit) {
    for_each_field(options.settings, visit);
    visit("capture", options.capture, "what the capture file leaves open");
}

/// `--layout`, for every command that reads a capture.
inline constexpr std::array kCaptureShorthands{
    Shorthand{"--layout",
              "capture.layout",
              "NAME|FILE",
              "Layout of the capture: a name or a JSON file (default: by its content)"}};

/// Declares `--layout` and `--set`; both go to `overrides`.
inline void add_capture_options(Command& command, std::vector<std::string>& overrides) {
    add_set_option(command, overrides);
    add_shorthands(command, kCaptureShorthands, overrides);
}

/// Moves the texts that begin with `capture.` out of `overrides`, for commands whose own settings
/// are read elsewhere.
inline std::vector<std::string> take_capture_overrides(std::vector<std::string>& overrides) {
    const auto others =
        std::stable_partition(overrides.begin(), overrides.end(), [](const auto& t) {
            return !t.starts_with("capture.");
        });
    std::vector<std::string> taken(others, overrides.end());
    overrides.erase(others, overrides.end());
    return taken;
}

/// overrides   `key.path=value` texts
/// throws      core::Error for unknown keys and wrong values
inline CaptureOptions capture_options(const std::vector<std::string>& overrides) {
    CaptureOptions options;
    for (const std::string& text : overrides) core::apply_override(options, text);
    return options;
}

}  // namespace apps
