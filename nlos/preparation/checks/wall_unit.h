// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>

namespace nlos {

/// Of wall points so much farther apart than any path is long that they cannot be metres: what unit
/// they look like, and the setting that mends it.
std::optional<std::string> wall_unit_mistake(const core::Capture& capture);

}  // namespace nlos
