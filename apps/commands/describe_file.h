// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"

#include <string>
#include <vector>

namespace apps {

/// What a file is and what it holds, in lines for people.
///
/// paths      one file, or the frames of a sequence
/// settings   what is told of a capture beside its file
/// throws     core::Error when there is no such file, or it is damaged
std::string describe_files(const std::vector<std::string>& paths,
                           const nlos::CaptureReadSettings& settings = {});

}  // namespace apps
