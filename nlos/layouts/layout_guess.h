// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_file.h"

#include <string>
#include <vector>

namespace nlos {

/// What a file of named arrays holds, and what a layout for it could be.
struct LayoutGuess {
    std::vector<std::string> arrays;    ///< a line each: name, type, shape, range
    std::vector<std::string> findings;  ///< what could be what, and what is still open
    std::vector<std::string> nearest;   ///< layouts that come closest, and what the file lacks
    core::Json layout;                  ///< a layout to be completed; null without histograms
};

/// Looks at every array of a file. The largest one against which nothing speaks is taken for the
/// histograms, and the axis along which its light varies most for time; see histogram_evidence.h.
///
/// throws   core::Error when the file is none of named arrays, or damaged
LayoutGuess guess_layout(const std::string& path);

/// The shipped layouts that come closest to a file of named arrays and what it lacks of each, a
/// line each.
std::vector<std::string> nearest_layouts(const std::string& path);

}  // namespace nlos
