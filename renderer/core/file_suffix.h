// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/nearest_name.h"

#include <filesystem>

namespace core {

/// The suffix of a file's name, with its dot and in lower case: .h5 of A.H5.
inline std::string file_suffix(const std::filesystem::path& path) {
    return lower_case(path.extension().string());
}

}  // namespace core
