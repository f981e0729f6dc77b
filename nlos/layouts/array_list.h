// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_files.h"
#include "renderer/core/error.h"

#include <string>
#include <vector>

namespace nlos {

/// A line for each array of a file: name, type, shape and range, or why it cannot be read; of cells
/// one stands for all.
std::vector<std::string> list_arrays(const LayoutFiles& files);

/// Why an array cannot be read, without its name.
std::string reason_of(const core::Error& error, const std::string& name);

}  // namespace nlos
