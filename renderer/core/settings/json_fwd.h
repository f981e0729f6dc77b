// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace core {

/// Keeps keys in the order in which they were listed.
using Json = nlohmann::ordered_json;

}  // namespace core
