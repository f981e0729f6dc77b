// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace apps {

/// Version and git hash, such as `nlos 0.1.0 (1a2b3c4)`.
std::string version_text();

}  // namespace apps
