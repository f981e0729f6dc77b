// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/formats/capture_file.h"

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

/// overrides   `key.path=value` texts
/// throws      core::Error for unknown keys and wrong values
inline CaptureOptions capture_options(const std::vector<std::string>& overrides) {
    CaptureOptions options;
    for (const std::string& text : overrides) core::apply_override(options, text);
    return options;
}

}  // namespace apps
